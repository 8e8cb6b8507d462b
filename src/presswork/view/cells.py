# SPDX-License-Identifier: Apache-2.0
"""Cells as polygons and triangles to draw."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from presswork.model import FloatArray
from presswork.post import count_corners
from presswork.results import ResultMesh

_POINTS_PER_CURVED_EDGE = 6

# Triangles of each cell by its number of nodes; those of a quad8 leave its middle as two triangles.
_TRIANGLES = {
    3: [(0, 1, 2)],
    6: [(0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)],
    4: [(0, 1, 2), (0, 2, 3)],
    8: [(0, 4, 7), (4, 1, 5), (5, 2, 6), (6, 3, 7), (4, 5, 6), (4, 6, 7)],
    9: [(0, 4, 8), (4, 1, 8), (1, 5, 8), (5, 2, 8), (2, 6, 8), (6, 3, 8), (3, 7, 8), (7, 0, 8)],
}


def outline_cells(mesh: ResultMesh, points: FloatArray) -> list[FloatArray]:
    """Return every cell's outline, shape (n_outline, 2 or 3) each, as outline_blocks does."""
    return [outline for block in outline_blocks(mesh, points) for outline in block]


def outline_blocks(mesh: ResultMesh, points: FloatArray) -> list[FloatArray]:
    """Return the cells' outlines, (n_cells, n_outline, 2 or 3) a block; edges with a mid-side node as its parabola."""
    outlines: list[FloatArray] = []
    for block in mesh.blocks:
        corners = count_corners(block.connectivity)
        start = points[block.connectivity[:, :corners]]
        if block.connectivity.shape[1] == corners:
            outlines.append(start)
            continue
        end, middle = np.roll(start, -1, axis=1), points[block.connectivity[:, corners : 2 * corners]]
        s = np.linspace(0.0, 1.0, _POINTS_PER_CURVED_EDGE, endpoint=False)[:, None]
        first, mid, last = (1 - s) * (1 - 2 * s), 4 * s * (1 - s), s * (2 * s - 1)
        curves = start[:, :, None] * first + middle[:, :, None] * mid + end[:, :, None] * last
        outlines.append(curves.reshape(len(curves), -1, points.shape[1]))
    return outlines


def triangulate(mesh: ResultMesh) -> NDArray[np.int64]:
    """Return triangles that cover all cells, shape (n_triangles, 3)."""
    parts = [
        block.connectivity[:, _TRIANGLES[block.connectivity.shape[1]]].reshape(-1, 3).astype(np.int64)
        for block in mesh.blocks
    ]
    return np.concatenate(parts)
