# SPDX-License-Identifier: Apache-2.0
"""The surface of a formed sheet as STL and STEP: its middle, one of its faces, or the closed skin round the metal."""

from __future__ import annotations

import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import Literal

import numpy as np

from presswork.mesh.checks import MeshError
from presswork.mesh.files.stl_file import pack_stl
from presswork.mesh.topology import find_boundary_edges
from presswork.mesh.triangles import split_quads
from presswork.model import FloatArray, FormedSheet, IntArray, Triangulation
from presswork.own_process import DiedError, call_apart

Side = Literal["middle", "bottom", "top", "skin"]
MOST_FACES = 20_000
"""Most faces of a STEP file: each triangle is a plane face of some 2 kB."""
_SECONDS = 600


def take_surface(sheet: FormedSheet, side: Side) -> Triangulation:
    """Return triangles of the middle, of a face, or of both faces and the rim between them, which is closed.

    The faces lie half a thickness off the middle along the mean normals of the nodes; those of the bottom are turned
    over in a skin, so that all normals point out of the metal.
    """
    is_triangle = sheet.cells[:, 2] == sheet.cells[:, 3]
    quads = split_quads(sheet.points, sheet.cells[~is_triangle])
    triangles = np.concatenate([quads, sheet.cells[is_triangle, :3]]).astype(np.int32)
    if side == "middle":
        return Triangulation(sheet.points, triangles, is_closed=False)
    faces = [sheet.points + sign * _half(sheet, triangles) for sign in (-1.0, 1.0)]
    if side != "skin":
        return Triangulation(faces[side == "top"], triangles, is_closed=False)
    n = len(sheet.points)
    rim = find_boundary_edges([triangles])[:, :2]
    first, last = rim.T
    wall = np.concatenate([
        np.column_stack([first, last, last + n]), np.column_stack([first, last + n, first + n])
    ])  # fmt: skip
    skin = np.concatenate([triangles[:, ::-1], triangles + n, wall]).astype(np.int32)
    return Triangulation(np.concatenate(faces), skin, is_closed=True)


def _half(sheet: FormedSheet, triangles: IntArray) -> FloatArray:
    """Return half a thickness along the normal at each node (n_points, 3) [mm]."""
    corners = sheet.points[triangles]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal, thick, count = np.zeros_like(sheet.points), np.zeros(len(sheet.points)), np.zeros(len(sheet.points))
    for column in triangles.T:
        np.add.at(normal, column, area)
    for column in sheet.cells.T:
        np.add.at(thick, column, sheet.thickness)
        np.add.at(count, column, 1.0)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    return np.asarray(0.5 * (thick / np.maximum(count, 1.0))[:, None] * normal)


def write_stl(sheet: FormedSheet, title: str, side: Side) -> bytes:
    """Return a binary STL file [mm]."""
    return pack_stl(title or "part", take_surface(sheet, side))


def write_step(sheet: FormedSheet, title: str, side: Side) -> bytes:
    """Return a STEP file of plane faces [mm], a solid where the surface is closed. Raises MeshError."""
    del title
    if find_spec("netgen") is None:
        raise MeshError("STEP files are written by netgen, which is not installed", 'pip install "presswork[cad]"')
    surface = take_surface(sheet, side)
    if len(surface.triangles) > MOST_FACES:
        fault = f"{len(surface.triangles)} triangles are more than the {MOST_FACES} faces that a STEP file should have"
        raise MeshError(fault, "write STL, which CAD programs read, too")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "part.step"
        try:
            call_apart("presswork.mesh.files.formed.surfaces:save_step", surface, path, seconds=_SECONDS)
        except DiedError as error:
            raise MeshError(f"the STEP file cannot be written (Open CASCADE {error})", "write STL") from None
        return path.read_bytes()


def save_step(surface: Triangulation, path: Path) -> None:
    """Write the faces of a surface to a STEP file, in this process, which Open CASCADE may end."""
    from netgen import occ

    faces = []
    for corners in surface.points[surface.triangles]:
        points = [occ.gp_Pnt(*(float(v) for v in x)) for x in corners]
        edges = [occ.Segment(points[i], points[(i + 1) % 3]) for i in range(3)]
        faces.append(occ.Face(occ.Wire(edges)))
    shape = occ.Sew(faces, 1e-6 * float(np.ptp(surface.points)))
    (occ.Solid(shape) if surface.is_closed else shape).WriteStep(str(path))
