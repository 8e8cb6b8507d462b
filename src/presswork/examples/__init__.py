# SPDX-License-Identifier: Apache-2.0
"""The example cases that ship with presswork."""

from __future__ import annotations

import os
import tomllib
from pathlib import Path

from presswork.case import CaseError, Problem
from presswork.case.errors import suggest
from presswork.results import OutputError
from presswork.results.whole_file import write_whole

_FOLDER = Path(__file__).parent


def list_examples() -> dict[str, str]:
    """Return the titles of the example cases by name."""
    return {path.stem: str(tomllib.loads(path.read_text("utf-8"))["title"]) for path in sorted(_FOLDER.glob("*.toml"))}


def copy_example(name: str, target_dir: str | Path) -> Path:
    """Copy an example's case file, and the files it names, into a folder, made if need be; return where the case lies.

    Raises CaseError for a name that is not known, and rather than write over a file that is there.
    """
    names = list_examples()
    if name not in names:
        raise CaseError([Problem("", f"unknown example `{name}`", suggest(name, names, "examples"))], "examples")
    folder = Path(target_dir)
    case = tomllib.loads((_FOLDER / f"{name}.toml").read_text("utf-8"))
    tools, mesh = case.get("tools", {}), case.get("workpiece", {}).get("mesh", {})
    files: list[str] = [f"{name}.toml", *(tool["profile_file"] for tool in tools.values() if "profile_file" in tool)]
    files += [part["path"] for part in (mesh, *tools.values()) if "path" in part]
    there = [folder / file for file in files if os.path.lexists(folder / file)]
    if there:
        raise CaseError(
            [Problem("", f"{path} is there already", "remove it, or copy elsewhere") for path in there], "examples"
        )
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for file in files:
            write_whole(folder / file, (_FOLDER / file).read_bytes())
    except (OSError, OutputError) as error:
        text = str(error)
        if isinstance(error, OSError):
            text = f"{error.filename or folder} cannot be written: {error.strerror or error}"
        raise CaseError([Problem("", text, "copy elsewhere, by --to")], "examples") from error
    return folder / files[0]
