# SPDX-License-Identifier: Apache-2.0
"""The gallery: every packaged example under its process, with its picture, its command and its case file."""

from __future__ import annotations

import re
from fnmatch import fnmatch
from pathlib import Path

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "src/presswork/examples"
PROCESSES = ROOT / "docs/howto/which_example.md"
ROW = re.compile(r"^\| (?!process|---)(.+?) \| (.+) \|$", re.MULTILINE)
PICTURES = {
    "strip_rolling": "rolling",
    "extrusion_curved": "extrusion",
    "can_extrusion": "can_extrusion_flow",
    "combined_extrusion": "combined_extrusion_flow",
}
"""Of examples whose picture has another name."""
HEAD = """# Gallery

The examples that come with presswork, by process; `presswork examples` lists them. [Which one is nearest to my
process?](howto/which_example.md)
"""


def list_processes() -> dict[str, list[str]]:
    """Return the names of the examples by process, in the order of the page that asks which one is nearest."""
    names = sorted(path.stem for path in EXAMPLES.glob("*.toml"))
    table = {}
    for process, cell in ROW.findall(PROCESSES.read_text("utf-8")):
        patterns = re.findall(r"`([a-z0-9_*]+)`", cell)
        found = [name for pattern in patterns for name in names if fnmatch(name, pattern)]
        table[process] = list(dict.fromkeys(found))
    return table


def find_picture(name: str) -> str:
    """Return the picture of an example, relative to docs/; empty where there is none."""
    picture = f"img/{PICTURES.get(name, name)}.png"
    return picture if (ROOT / "docs" / picture).is_file() else ""


def write_example(name: str) -> str:
    """Return the section of an example."""
    text = (EXAMPLES / f"{name}.toml").read_text("utf-8")
    title = re.search(r'^title = "(.*)"', text, re.MULTILINE)
    assert title is not None, f"{name}.toml has no title"
    picture = find_picture(name)
    image = f"![{title[1]}]({picture}){{ loading=lazy }}\n\n" if picture else ""
    run = f"```sh\npresswork examples {name} && presswork run {name}.toml\n```"
    return f'### {title[1]} {{ #{name} }}\n\n{image}{run}\n\n??? note "{name}.toml"\n\n' + indent(f"```toml\n{text}```")


def anchor(process: str) -> str:
    """Return the name that links of the page have for a process."""
    return process.replace(" ", "-").replace(",", "")


def indent(text: str) -> str:
    """Return lines moved to the right, as what is folded away stands."""
    return "".join(f"    {line}".rstrip() + "\n" for line in text.splitlines())


def make_gallery() -> str:
    """Return the page: processes with links and pictures, then a section for every process."""
    processes = list_processes()
    rows = []
    for process, names in processes.items():
        shown = next((find_picture(name) for name in names if find_picture(name)), "")
        image = f"![{process}]({shown}){{ width=160 loading=lazy }}" if shown else ""
        rows.append(
            f"| {image} | [{process}](#{anchor(process)}) | {', '.join(f'[{name}](#{name})' for name in names)} |"
        )
    index = "| | process | examples |\n|---|---|---|\n" + "\n".join(rows) + "\n"
    sections = [
        f"## {process.capitalize()} {{ #{anchor(process)} }}\n\n" + "\n".join(write_example(name) for name in names)
        for process, names in processes.items()
    ]
    return "\n".join([HEAD, index, *sections])
