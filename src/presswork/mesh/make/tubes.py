# SPDX-License-Identifier: Apache-2.0
"""Meshes of tubes about the axis x: the middle surface, whole or cut by the planes x = 0 and y = 0.

Sets: all; edge, the ends without what lies in x = 0; symmetry_x and symmetry_y, the nodes in these planes where they
cut the tube; left and right, the ends; top and bottom, the lines of largest and least z; sides, those in z = 0.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from presswork.mesh.make.blanks import ELEMENTS_OF_BLANKS
from presswork.mesh.topology import find_boundary_edges, select_edges
from presswork.model import BoolArray, CellBlock, FloatArray, IntArray, Mesh, find_cell


def mesh_tube(
    radius: float, length: float, element_size: float, symmetry: Sequence[bool], *, triangles: bool = False
) -> Mesh:
    """Mesh a tube of a radius of its middle surface and a whole length [mm]; its cells run so that normals point out.

    symmetry: whether the planes x = 0 and y = 0 cut it. element_size: largest side of a cell [mm]. Round a quarter of
    the tube lies a whole number of cells. Triangles are made as in blanks.
    """
    along = max(1, int(np.ceil((0.5 if symmetry[0] else 1.0) * length / element_size - 1e-9)))
    along += 0 if symmetry[0] else along % 2
    around = 2 * max(1, int(np.ceil(0.5 * np.pi * radius / element_size - 1e-9)))  # of a half
    x = np.linspace(0.0 if symmetry[0] else -0.5 * length, 0.5 * length, along + 1)
    if symmetry[1]:
        angle, row = np.linspace(-0.5 * np.pi, 0.5 * np.pi, around + 1), np.arange(around + 1)
    else:
        angle = np.linspace(-0.5 * np.pi, 1.5 * np.pi, 2 * around, endpoint=False)
        row = np.append(np.arange(2 * around), 0)
    first = (row[None, :-1] + len(angle) * np.arange(along)[:, None]).ravel()
    after = (row[None, 1:] + len(angle) * np.arange(along)[:, None]).ravel()
    cells = np.stack([first, first + len(angle), after + len(angle), after], axis=1)[:, ::-1]
    places = np.column_stack([np.repeat(x, len(angle)), np.tile(angle, along + 1)])
    if triangles:
        places, cells = _cut(places, cells, 0.5 * (angle[1] - angle[0]))
    points = np.column_stack([places[:, 0], radius * np.cos(places[:, 1]), radius * np.sin(places[:, 1])])
    points[np.abs(points) < 1e-12 * radius] = 0.0
    return _name_sets(points, cells.astype(np.int32), symmetry)


def _cut(places: FloatArray, cells: IntArray, half: float) -> tuple[FloatArray, IntArray]:
    """Return places (n, 2) and triangles of quadrilaterals that both diagonals cut; half: the angle of half a cell."""
    centre = np.tile(len(places) + np.arange(len(cells)), (4, 1)).T
    middle = np.column_stack([places[cells, 0].mean(axis=1), places[cells[:, 3], 1] + half])
    parts = np.stack([cells, np.roll(cells, -1, axis=1), centre], axis=2).reshape(-1, 3)
    return np.concatenate([places, middle]), parts


def _name_sets(points: FloatArray, cells: IntArray, symmetry: Sequence[bool]) -> Mesh:
    """Return the mesh with its sets; its elements and section are filled in by assign_section."""
    block = CellBlock(ELEMENTS_OF_BLANKS[find_cell(2, cells).name], cells, 0)
    boundary = find_boundary_edges([cells])
    tolerance = 1e-9 * float(np.abs(points).max())

    def near(axis: int, value: float) -> BoolArray:
        return np.asarray(np.abs(points[:, axis] - value) <= tolerance)

    low, high = points.min(axis=0), points.max(axis=0)
    masks = {
        "left": near(0, low[0]),
        "right": near(0, high[0]),
        "top": near(2, high[2]),
        "bottom": near(2, low[2]),
        "sides": near(2, 0.0),
        "all": np.ones(len(points), dtype=bool),
        **({"symmetry_x": near(0, 0.0)} if symmetry[0] else {}),
        **({"symmetry_y": near(1, 0.0)} if symmetry[1] else {}),
    }
    node_sets = {name: np.flatnonzero(mask).astype(np.int32) for name, mask in masks.items()}
    ends = [node_sets["right"]] if symmetry[0] else [node_sets["left"], node_sets["right"]]
    outline = np.concatenate([select_edges(boundary, end) for end in ends])
    node_sets["edge"] = np.unique(outline).astype(np.int32)
    return Mesh(points, (block,), node_sets, {"edge": outline, "boundary": boundary}, boundary)
