# SPDX-License-Identifier: Apache-2.0
"""Skin and inside meshed anew to a field of sizes, by MMG (Dapogny, Dobrzynski & Frey 2014, J. Comput. Phys. 262).

The deformed tetrahedra are cut, joined and moved until their edges have the size asked for. Ridges of more than RIDGE
and the borders between faces of different numbers stay rows of edges, flat faces stay flat.
"""

from __future__ import annotations

import importlib.util
from dataclasses import dataclass

import numpy as np

from presswork.mesh.checks import MeshError
from presswork.model import FloatArray, IndexArray
from presswork.remesh.space.mmg_process import MMG
from presswork.remesh.space.tetrahedra import measure_volumes

RIDGE = 30.0
"""[degrees]"""
GRADATION = 1.3
LARGER = 1.001
"""Largest edge over the smallest one: MMG accepts no equal bounds."""
CELLS_PER_CUBE = 14.0
"""Tetrahedra in a cube whose edge is the size: measured on boxes and barrels, 11 to 14."""
MEMORY, MEMORY_PER_CELL = 40.0, 0.001
"""Memory that MMG may take [MB], at least (it needs 38) and for each cell of the old mesh and of the new one: five
times what it was seen to need, for 2,000 to 700,000 cells. It sets up as much at once, which takes time."""
SECONDS, SECONDS_PER_CELL = 60.0, 2e-3
"""Processor time that MMG may take, at least and for each of these cells: some twenty times its need."""
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
    """Number of each face (k,)."""


def mesh_to_size(
    body: FilledBody, size: FloatArray, *, smallest: float, largest: float, away: float, keeps_skin: bool = False
) -> FilledBody:
    """Return a body meshed anew with edges of a size at its points (n,) [mm].

    smallest, largest: bounds of edges [mm]; away: largest distance of the new skin from the old one, smoothed [mm];
    keeps_skin: the faces stay as they are. Raises MeshError.
    """
    if importlib.util.find_spec("mmgpy") is None:
        raise MeshError("new meshes in space need mmgpy, which is not installed", REMEDY)
    expected = len(body.cells) + expect_cells(body.points, body.cells, size)
    made = MMG.ask(
        {"points": body.points, "cells": body.cells, "faces": body.faces, "number": body.number + 1, "size": size},
        {"hmin": smallest, "hmax": max(largest, LARGER * smallest), "hausd": away, "hgrad": GRADATION, "ar": RIDGE,
         "nosurf": int(keeps_skin)},
        memory=int(MEMORY + MEMORY_PER_CELL * expected), seconds=SECONDS + SECONDS_PER_CELL * expected,
    )  # fmt: skip
    points, cells = made["points"], np.asarray(made["cells"], dtype=np.intp)
    if not len(cells) or cells.max() >= len(points):
        raise MeshError("MMG returned an incomplete mesh", "smaller cells")
    used, number = np.unique(cells, return_inverse=True)  # MMG leaves nodes behind that no cell has
    place = np.zeros(len(points), dtype=np.intp)
    place[used] = np.arange(len(used))
    faces = place[np.asarray(made["faces"], dtype=np.intp)]
    return FilledBody(points[used], number.reshape(cells.shape), faces, np.asarray(made["number"], dtype=np.intp) - 1)


def expect_cells(points: FloatArray, cells: IndexArray, size: FloatArray) -> float:
    """Return about how many cells a body needs with edges of a size at its points (n,) [mm]."""
    return float((CELLS_PER_CUBE * measure_volumes(points, cells) / size[cells].mean(axis=1) ** 3).sum())
