# SPDX-License-Identifier: Apache-2.0
"""The table of formats that a formed sheet is written in, by the ending of the file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from presswork.mesh.checks import MeshError
from presswork.mesh.files.dynain import is_dynain, write_dynain
from presswork.mesh.files.formed.abaqus import write_abaqus
from presswork.mesh.files.formed.nastran import write_nastran
from presswork.mesh.files.formed.radioss import write_radioss
from presswork.model import FormedSheet


@dataclass(frozen=True)
class Format:
    """A format of files."""

    name: str
    endings: tuple[str, ...]
    write: Callable[[FormedSheet, str], str]
    """Returns the text of a sheet with a title."""


FORMATS = (
    Format("LS-DYNA", (".dynain", ".k", ".key"), write_dynain),
    Format("Abaqus", (".inp",), write_abaqus),
    Format("OpenRadioss", (".rad",), write_radioss),
    Format("Nastran", (".bdf", ".nas", ".dat"), write_nastran),
)


def find_format(path: Path) -> Format:
    """Return the format of a file's name. Raises MeshError."""
    for each in FORMATS:
        if path.suffix.lower() in each.endings or (each.name == "LS-DYNA" and is_dynain(path)):
            return each
    known = "; ".join(f"{each.name}: {', '.join(each.endings)}" for each in FORMATS)
    raise MeshError(f"`{path.suffix or path.name}` is no ending that a part is exported by", known)
