# SPDX-License-Identifier: Apache-2.0
"""Skin and inside meshed anew to a field of sizes, by MMG (Dapogny, Dobrzynski & Frey 2014, J. Comput. Phys. 262).

The deformed tetrahedra are cut, joined and moved until their edges have the size asked for. Ridges of more than RIDGE
and the borders between faces of different numbers stay rows of edges, flat faces stay flat.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from presswork.mesh.checks import MeshError
from presswork.model import FloatArray, IndexArray
from presswork.remesh.space.tetrahedra import measure_volumes

RIDGE = 30.0
"""[degrees]"""
GRADATION = 1.3
LARGER = 1.001
"""Times the smallest edge: MMG takes no bounds that are equal."""
CELLS_PER_CUBE = 14.0
"""Tetrahedra in a cube whose edge is the size: measured on boxes and barrels, 11 to 14."""
_MEMORY, _MEMORY_PER_CELL = 64.0, 0.01
"""That MMG may take [MB], at least and for each cell of the old mesh and of the new one: some thirty times its need. It
sets up what it may take for a million points at once otherwise, which takes longer than a mesh of some thousand
cells."""
REMEDY = "pip install mmgpy, where it has a wheel"


@dataclass(frozen=True)
class FilledBody:
    """Tetrahedra and their numbered skin."""

    points: FloatArray
    """(n, 3) [mm]."""
    cells: IndexArray
    """(m, 4)."""
    faces: IndexArray
    """(k, 3), counter-clockwise seen from outside."""
    number: IndexArray
    """Of each face (k,)."""


def mesh_to_size(
    body: FilledBody, size: FloatArray, *, smallest: float, largest: float, away: float, keeps_skin: bool = False
) -> FilledBody:
    """Return a body meshed anew with edges of a size at its points (n,) [mm].

    smallest, largest: bounds of edges [mm]; away: largest distance of the new skin from the old one, smoothed [mm];
    keeps_skin: the faces stay as they are. Raises MeshError.
    """
    try:
        from mmgpy import MmgMesh3D
    except ImportError as error:
        raise MeshError("new meshes in space need mmgpy, which is not installed", REMEDY) from error
    mesh = MmgMesh3D()
    with suppress(RuntimeError, ValueError):  # takes note of the memory, and says that there is no mesh yet
        mesh.remesh(verbose=-1, mem=_find_memory(body, size))
    mesh.set_mesh_size(len(body.points), len(body.cells), 0, len(body.faces), 0, 0)
    mesh.set_vertices(np.ascontiguousarray(body.points))
    mesh.set_tetrahedra(np.ascontiguousarray(body.cells, dtype=np.int32))
    mesh.set_triangles(np.ascontiguousarray(body.faces, dtype=np.int32), body.number.astype(np.int64) + 1)
    largest = max(largest, LARGER * smallest)
    mesh["metric"] = np.ascontiguousarray(size[:, None])
    try:
        mesh.remesh(
            verbose=-1, hmin=smallest, hmax=largest, hausd=away, hgrad=GRADATION, ar=RIDGE, nosurf=int(keeps_skin)
        )
    except (RuntimeError, ValueError) as error:
        raise MeshError(f"MMG cannot mesh the body anew ({error})", "smaller cells") from error
    triangles, reference = mesh.get_triangles_with_refs()
    points = np.array(mesh.get_vertices())
    cells = np.asarray(mesh.get_tetrahedra(), dtype=np.intp)
    if not len(cells) or cells.max() >= len(points):
        raise MeshError("MMG has left no whole mesh", "smaller cells")
    used, number = np.unique(cells, return_inverse=True)  # MMG leaves nodes behind that no cell has
    place = np.zeros(len(points), dtype=np.intp)
    place[used] = np.arange(len(used))
    faces = place[np.asarray(triangles, dtype=np.intp)]
    return FilledBody(points[used], number.reshape(cells.shape), faces, np.asarray(reference, dtype=np.intp) - 1)


def expect_cells(points: FloatArray, cells: IndexArray, size: FloatArray) -> float:
    """Return about how many cells a body needs with edges of a size at its points (n,) [mm]."""
    return float((CELLS_PER_CUBE * measure_volumes(points, cells) / size[cells].mean(axis=1) ** 3).sum())


def _find_memory(body: FilledBody, size: FloatArray) -> int:
    """Return what MMG may take for a new mesh [MB]."""
    return int(_MEMORY + _MEMORY_PER_CELL * (len(body.cells) + expect_cells(body.points, body.cells, size)))
