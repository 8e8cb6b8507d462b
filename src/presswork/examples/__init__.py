# SPDX-License-Identifier: Apache-2.0
"""The example cases that ship with presswork."""

from __future__ import annotations

import tomllib
from pathlib import Path

from presswork.case import CaseError, Problem
from presswork.case.errors import suggest

_FOLDER = Path(__file__).parent


def list_examples() -> dict[str, str]:
    """Return the titles of the example cases by name."""
    return {path.stem: str(tomllib.loads(path.read_text("utf-8"))["title"]) for path in sorted(_FOLDER.glob("*.toml"))}


def copy_example(name: str, target_dir: str | Path) -> Path:
    """Copy an example's case file into a folder, made if need be; return where it lies.

    Raises CaseError for a name that is not known, and rather than write over a file that is there.
    """
    names = list_examples()
    if name not in names:
        raise CaseError([Problem("", f"`{name}` is no example", suggest(name, names, "examples"))], "examples")
    target = Path(target_dir) / f"{name}.toml"
    target.parent.mkdir(parents=True, exist_ok=True)
    try:
        with target.open("x", encoding="utf-8") as file:
            file.write((_FOLDER / target.name).read_text("utf-8"))
    except FileExistsError:
        raise CaseError(
            [Problem("", f"{target} is there already", "remove it, or copy elsewhere")], "examples"
        ) from None
    return target
