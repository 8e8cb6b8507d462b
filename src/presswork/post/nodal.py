# SPDX-License-Identifier: Apache-2.0
"""Nodal averages of cell values, for contours."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from presswork.model import FloatArray, find_cell, take_corners


def average_to_nodes(
    points: FloatArray, connectivity: Sequence[NDArray[np.integer]], cell_values: FloatArray
) -> FloatArray:
    """Return the mean of the values of the cells around each node, weighted by their areas.

    `points` (n_points, 2) [mm]; `connectivity` one array (n_cells, n_nodes) per block; `cell_values` (n_cells,) or
    (n_cells, k) in the order of the blocks. Returns (n_points,) or (n_points, k); NaN at a node without a cell. A
    mid-side or centre node takes the mean of the corners around it, which is smoother than that of its own cells.
    A smoothing for the eye: extremes of the cell values are flattened, and materials are averaged across.
    """
    areas = np.concatenate([cell_areas(points, cells) for cells in connectivity])
    values = np.asarray(cell_values, dtype=np.float64).reshape(len(areas), -1)
    corners = [take_corners(cells) for cells in connectivity]
    nodes = np.concatenate([cells.ravel() for cells in corners])
    cells_of_nodes = np.repeat(np.arange(len(areas)), np.concatenate([np.full(len(c), c.shape[1]) for c in corners]))
    weights = areas[cells_of_nodes]
    total = np.bincount(nodes, weights, minlength=len(points))
    inside = total > 0
    mean = np.full((len(points), values.shape[1]), np.nan)
    for k in range(values.shape[1]):
        mean[inside, k] = np.bincount(nodes, weights * values[cells_of_nodes, k], minlength=len(points))[inside]
        mean[inside, k] /= total[inside]
    for cells, ends in zip(connectivity, corners, strict=True):
        _fill_between_corners(mean, cells, ends)
    return mean[:, 0] if np.ndim(cell_values) == 1 else mean


def _fill_between_corners(values: FloatArray, cells: NDArray[np.integer], corners: NDArray[np.integer]) -> None:
    """Set mid-side nodes to the mean of their edge's ends and centre nodes to that of the corners."""
    cell = find_cell(2, cells)
    if cell.is_quadratic:
        first, last, middle = cells[:, cell.edges].transpose(2, 0, 1)
        values[middle] = 0.5 * (values[first] + values[last])
    for inner in cell.inner:
        values[cells[:, inner]] = values[corners].mean(axis=1)


def cell_areas(points: FloatArray, cells: NDArray[np.integer]) -> FloatArray:
    """Return the area of each cell's polygon of corners [mm^2], shape (n_cells,); mid-sides are passed over."""
    x, y = np.moveaxis(points[take_corners(cells)], 2, 0)
    crossed = x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y
    return np.asarray(np.abs(crossed.sum(axis=1)) / 2)
