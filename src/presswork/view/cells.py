# SPDX-License-Identifier: Apache-2.0
"""Cells as polygons and triangles to draw."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from presswork.model import FloatArray, find_cell
from presswork.results import ResultMesh

_POINTS_PER_CURVED_EDGE = 6


def outline_cells(mesh: ResultMesh, points: FloatArray) -> list[FloatArray]:
    """Return every cell's outline, shape (n_outline, 2 or 3) each, as outline_blocks does."""
    return [outline for block in outline_blocks(mesh, points) for outline in block]


def outline_blocks(mesh: ResultMesh, points: FloatArray) -> list[FloatArray]:
    """Return the cells' outlines, (n_cells, n_outline, 2 or 3) a block; edges with a mid-side node as its parabola."""
    outlines: list[FloatArray] = []
    for block in mesh.blocks:
        cell = find_cell(2, block.connectivity)
        start = points[block.connectivity[:, : cell.corners]]
        if not cell.is_quadratic:
            outlines.append(start)
            continue
        end, middle = np.roll(start, -1, axis=1), points[block.connectivity[:, cell.edges[:, 2]]]
        s = np.linspace(0.0, 1.0, _POINTS_PER_CURVED_EDGE, endpoint=False)[:, None]
        first, mid, last = (1 - s) * (1 - 2 * s), 4 * s * (1 - s), s * (2 * s - 1)
        curves = start[:, :, None] * first + middle[:, :, None] * mid + end[:, :, None] * last
        outlines.append(curves.reshape(len(curves), -1, points.shape[1]))
    return outlines


def triangulate(mesh: ResultMesh) -> NDArray[np.int64]:
    """Return triangles that cover all cells, shape (n_triangles, 3)."""
    parts = [
        block.connectivity[:, find_cell(2, block.connectivity).pieces].reshape(-1, 3).astype(np.int64)
        for block in mesh.blocks
    ]
    return np.concatenate(parts)
