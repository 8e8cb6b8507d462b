# SPDX-License-Identifier: Apache-2.0
"""Evens out a flat mesh round lines onto which its nodes were moved."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from presswork.mesh.topology import edge_keys, find_boundary_edges, list_cell_edges
from presswork.model import BoolArray, FloatArray, IntArray

RINGS, SWEEPS = 3, 30
"""How many cells away from the lines nodes move, and how often."""
POOR = 0.5
"""Sine of a corner below which no move may make it sharper."""


def relax_mesh(points: FloatArray, kinds: Sequence[IntArray], on_line: BoolArray, along: FloatArray) -> FloatArray:
    """Return the points (n, 2), those near the lines moved to the middle of their neighbours, time after time.

    on_line: nodes that lie on lines (n,), which move along a line alone; along: unit vectors of these lines (n, 2), 0
    where a node stays. Nodes of the outline stay. A node stays where a cell round it would become sharper.
    """
    edges = np.concatenate([list_cell_edges(cells) for cells in kinds])
    edges = edges[np.unique(edge_keys(edges), return_index=True)[1]]
    both = np.concatenate([edges, edges[:, ::-1]])
    count = np.bincount(both[:, 0], minlength=len(points))
    near = on_line.copy()
    for _ in range(RINGS):
        near[both[near[both[:, 0]], 1]] = True
    outline = np.zeros(len(points), dtype=bool)
    outline[find_boundary_edges(list(kinds))[:, :2]] = True
    slides = on_line & (along != 0.0).any(axis=1)
    moves = near & ~outline & (~on_line | slides)
    points = points.copy()
    for _ in range(SWEEPS):
        total = np.zeros_like(points)
        np.add.at(total, both[:, 0], points[both[:, 1]])
        step = np.where(moves[:, None], 0.5 * (total / count[:, None] - points), 0.0)
        step[slides] = ((step * along).sum(axis=1)[:, None] * along)[slides]
        moved = points + step
        before, after = ([find_sines(x, cells) for cells in kinds] for x in (points, moved))
        stays = np.zeros(len(points), dtype=bool)
        for cells, old, new in zip(kinds, before, after, strict=True):
            stays[cells[new < np.minimum(old - 1e-12, POOR)]] = True
        points = np.where(stays[:, None], points, moved)
    return points


def find_sines(points: FloatArray, cells: IntArray) -> FloatArray:
    """Return the least sine of the corners of cells (n_cells,), negative where one is turned inside out."""
    side = np.roll(points[cells], -1, axis=1) - points[cells]
    side /= np.linalg.norm(side, axis=2, keepdims=True)
    last = np.roll(side, 1, axis=1)
    return np.asarray((last[..., 0] * side[..., 1] - last[..., 1] * side[..., 0]).min(axis=1))
