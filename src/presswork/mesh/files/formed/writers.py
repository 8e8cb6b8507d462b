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
from presswork.mesh.files.formed.solids import write_abaqus_solid, write_dyna_solid, write_stl_solid
from presswork.mesh.files.formed.surfaces import Side, write_step, write_stl
from presswork.model import FormedSheet, FormedSolid


@dataclass(frozen=True)
class Format:
    """A format of files."""

    name: str
    endings: tuple[str, ...]
    write: Callable[[FormedSheet, str, Side], bytes]
    """Returns the content of a sheet's file; Side: which surface, where the format holds one."""
    write_solid: Callable[[FormedSolid, str], bytes] | None = None
    """Returns that of a solid's; None: sheets alone."""


def _as_text(write: Callable[[FormedSheet, str], str]) -> Callable[[FormedSheet, str, Side], bytes]:
    return lambda sheet, title, _: write(sheet, title).encode("ascii", "replace")


FORMATS = (
    Format("LS-DYNA", (".dynain", ".k", ".key"), _as_text(write_dynain), write_dyna_solid),
    Format("Abaqus", (".inp",), _as_text(write_abaqus), write_abaqus_solid),
    Format("OpenRadioss", (".rad",), _as_text(write_radioss)),
    Format("Nastran", (".bdf", ".nas", ".dat"), _as_text(write_nastran)),
    Format("STL", (".stl",), write_stl, write_stl_solid),
    Format("STEP", (".step", ".stp"), write_step),
)


def find_format(path: Path) -> Format:
    """Return the format of a file's name. Raises MeshError."""
    for each in FORMATS:
        if path.suffix.lower() in each.endings or (each.name == "LS-DYNA" and is_dynain(path)):
            return each
    known = "; ".join(f"{each.name}: {', '.join(each.endings)}" for each in FORMATS)
    raise MeshError(f"`{path.suffix or path.name}` is no ending that a part is exported by", known)
