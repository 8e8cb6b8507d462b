# SPDX-License-Identifier: Apache-2.0
"""A formed solid for other programs: Abaqus in the plane and in space, LS-DYNA and STL in space.

Abaqus: stresses are 11, 22, 33, 12, in space 13 and 23, in the global axes; of an axisymmetric element 1 is the radius,
2 the axis, 3 the hoop (Analysis User's Guide, Axisymmetric solid elements). LS-DYNA: *INITIAL_STRESS_SOLID with one
point of a cell and LARGE = 1, xx yy zz xy yz zx in the global axes, then the plastic strain (Keyword Manual I).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from presswork.mesh.checks import MeshError
from presswork.mesh.faces import find_boundary_faces, split_faces
from presswork.mesh.files.stl_file import pack_stl
from presswork.model import FloatArray, FormedSolid, IntArray, Triangulation, find_cell

_PLANE = {"axisymmetric": "CAX", "plane_strain": "CPE"}
_REDUCED = {"quad4": "4R", "quad8": "8R", "quad9": "8R", "hex8": "8R"}
"""Nodes and integration of Abaqus elements whose stress is one value a cell."""


def write_abaqus_solid(solid: FormedSolid, title: str) -> bytes:
    """Return an input file without material, steps and supports."""
    lines = ["*HEADING", title[:80] or "presswork", "** mm, t, s, N, MPa; give *MATERIAL, NAME=BODY and the steps"]
    lines += ["*NODE, NSET=BODY", *(f"{i}, {_row(x)}" for i, x in enumerate(solid.points, 1))]
    number = 0
    for block in solid.blocks:
        name, nodes = _name_element(solid, block)
        lines.append(f"*ELEMENT, TYPE={name}, ELSET=BODY")
        for cell in block[:, :nodes]:
            number += 1
            lines.append(", ".join(str(label) for label in (number, *(cell + 1))))
    lines += ["*SOLID SECTION, ELSET=BODY, MATERIAL=BODY", ""]
    order = [0, 1, 2, 3, 5, 4] if solid.frame == "solid" else [0, 1, 2, 3]
    lines.append("*INITIAL CONDITIONS, TYPE=STRESS")
    lines += [f"{i}, {_row(stress)}" for i, stress in enumerate(solid.stress[:, order], 1)]
    lines.append("*INITIAL CONDITIONS, TYPE=HARDENING")
    lines += [f"{i}, {plastic:.9g}" for i, plastic in enumerate(solid.plastic_strain, 1)]
    return "\n".join([*lines, ""]).encode("ascii", "replace")


def _name_element(solid: FormedSolid, block: IntArray) -> tuple[str, int]:
    """Return the type of a block's elements in Abaqus, and how many of its nodes they have."""
    cell = find_cell(3 if solid.frame == "solid" else 2, block)
    kind = _REDUCED.get(cell.name, str(cell.nodes))
    return f"{_PLANE.get(solid.frame, 'C3D')}{kind}", min(cell.nodes, 8) if cell.name == "quad9" else cell.nodes


def write_dyna_solid(solid: FormedSolid, title: str) -> bytes:
    """Return a keyword file of a body in space, part 1. Raises MeshError for one in the plane."""
    _need_space(solid, "LS-DYNA")
    lines = ["*KEYWORD", "$ presswork; mm, t, s, N, MPa", "*TITLE", title[:80], "*NODE"]
    lines += [f"{i:8d}" + "".join(f"{v:16.9e}" for v in x) for i, x in enumerate(solid.points, 1)]
    lines.append("*ELEMENT_SOLID")
    number = 0
    for block in solid.blocks:
        for cell in block:
            number += 1
            nodes = [*cell, *([cell[-1]] * (8 - len(cell)))]  # a tetrahedron has its last node five times
            lines.append(f"{number:8d}{1:8d}")
            lines.append("".join(f"{node + 1:8d}" for node in nodes))
    lines += ["*INITIAL_STRESS_SOLID", *_stress_rows(solid), "*END", ""]
    return "\n".join(lines).encode("ascii", "replace")


def _stress_rows(solid: FormedSolid) -> Iterator[str]:
    for i, (stress, plastic) in enumerate(zip(solid.stress, solid.plastic_strain, strict=True), 1):
        yield f"{i:10d}{1:10d}{0:10d}{1:10d}"
        yield "".join(f"{v:16.9e}" for v in stress[:5])
        yield "".join(f"{v:16.9e}" for v in (stress[5], plastic))


def write_stl_solid(solid: FormedSolid, title: str) -> bytes:
    """Return the skin of a body in space as binary STL [mm]. Raises MeshError for one in the plane."""
    _need_space(solid, "STL")
    faces = [split_faces(find_boundary_faces([block])[0]) for block in solid.blocks]
    triangles = np.concatenate(faces).astype(np.int32)
    return pack_stl(title or "body", Triangulation(solid.points, triangles, is_closed=True))


def _need_space(solid: FormedSolid, name: str) -> None:
    if solid.frame != "solid":
        raise MeshError(f"{name} files are written of bodies in space, not in the plane", "write .inp for Abaqus")


def _row(values: FloatArray) -> str:
    return ", ".join(f"{value:.9g}" for value in values)
