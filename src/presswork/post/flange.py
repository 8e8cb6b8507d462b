# SPDX-License-Identifier: Apache-2.0
"""Compare a drawn flange with a target outline, and correct the edge of the blank.

A point of the edge that must come to rest elsewhere along its path, by dx, has to start elsewhere by F^-1 dx, F the
deformation of the sheet beside it. For a flange that keeps its thickness this is exact to first order: the area between
edge and target is the same in blank and flange.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.model import BoolArray, FloatArray, find_cell
from presswork.post.outline import find_outline
from presswork.results import Result, ResultMesh

_SHORT = 0.05
"""Travel of an edge point over the largest one below which its direction is unreliable."""
_STEEPEST = 0.5
"""Least area of a cell seen from above, over that in the blank, by whose deformation a deviation is pulled back."""
_FARTHEST = 2.0
"""Longest distance to the target, and longest correction, over the distance."""


@dataclass(frozen=True)
class FlangeFit:
    """The edge of a blank, where it came to lie, and what that lacks."""

    blank: FloatArray
    """Edge of the whole blank, counter-clockwise (n, 2) [mm]."""
    drawn: FloatArray
    """The same points as drawn, from above (n, 2) [mm]."""
    deviation: FloatArray
    """Distance from the target, above zero outside of it (n,) [mm]."""
    correction: FloatArray
    """Displacement of each point of the blank's edge that corrects the flange (n, 2) [mm]."""

    @property
    def worst(self) -> float:
        """Largest distance from the target [mm]."""
        return float(np.abs(self.deviation).max())


def fit_flange(result: Result, target: FloatArray) -> FlangeFit:
    """Compare the outer edge of a drawn sheet with a closed outline (n, 2) [mm] around it, from above.

    Raises ResultError for a body that is no sheet.
    """
    mesh, now = result.mesh_at(-1), result.points(-1)
    start = mesh.points
    loop = max(find_outline(result), key=lambda each: float(np.ptp(each.place(start), axis=0).sum()))
    blank, drawn = loop.place(start)[:, :2], loop.place(now)[:, :2]
    nearest = _find_nearest(drawn, target)
    apart = np.linalg.norm(drawn - nearest, axis=1)
    deviation = np.where(_is_inside(drawn, target), -apart, apart)
    travel = drawn - blank
    length = np.linalg.norm(travel, axis=1)
    along_edge = np.roll(drawn, -1, axis=0) - np.roll(drawn, 1, axis=0)
    inwards = np.stack([-along_edge[:, 1], along_edge[:, 0]], axis=1)
    direction = np.where((length > _SHORT * length.max())[:, None], travel, inwards)
    wanted = _go_along(drawn, direction, target, nearest) - drawn
    back = loop.signs[:, :, None] * _pull_back(mesh, now)[loop.nodes] * loop.signs[:, None, :]
    correction = np.einsum("nij,nj->ni", back, wanted)
    size = np.maximum(np.linalg.norm(correction, axis=1), 1e-300)
    longest = _FARTHEST * np.linalg.norm(wanted, axis=1)
    return FlangeFit(blank, drawn, deviation, correction * np.minimum(1.0, longest / size)[:, None])


def _find_nearest(points: FloatArray, polygon: FloatArray) -> FloatArray:
    """Return the places on a polygon that are nearest to points (n, 2)."""
    found, best = np.zeros_like(points), np.full(len(points), np.inf)
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        part = np.clip((points - a) @ (b - a) / max(float((b - a) @ (b - a)), 1e-300), 0.0, 1.0)
        place = a + part[:, None] * (b - a)
        distance = np.linalg.norm(points - place, axis=1)
        found[distance < best], best = place[distance < best], np.minimum(distance, best)
    return found


def _is_inside(points: FloatArray, polygon: FloatArray) -> BoolArray:
    """Return which points lie within a polygon."""
    inside = np.zeros(len(points), dtype=bool)
    x, y = points.T
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        if a[1] != b[1]:
            crosses = (a[1] > y) != (b[1] > y)
            inside ^= crosses & (x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
    return inside


def _go_along(points: FloatArray, direction: FloatArray, polygon: FloatArray, nearest: FloatArray) -> FloatArray:
    """Return where lines through points meet a polygon first, to either side; its nearest place where that is far."""
    farthest = _FARTHEST * np.linalg.norm(points - nearest, axis=1)
    found, best = nearest.copy(), farthest.copy()
    unit = direction / np.maximum(np.linalg.norm(direction, axis=1, keepdims=True), 1e-300)
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        side, out = b - a, a - points
        cross = unit[:, 0] * side[1] - unit[:, 1] * side[0]
        parallel = np.abs(cross) < 1e-12 * np.linalg.norm(side)
        cross = np.where(parallel, 1.0, cross)
        distance = (out[:, 0] * side[1] - out[:, 1] * side[0]) / cross
        part = (out[:, 0] * unit[:, 1] - out[:, 1] * unit[:, 0]) / cross
        meets = ~parallel & (part >= 0.0) & (part <= 1.0) & (np.abs(distance) < best)
        found[meets], best[meets] = (points + distance[:, None] * unit)[meets], np.abs(distance)[meets]
    return found


def _pull_back(mesh: ResultMesh, now: FloatArray) -> FloatArray:
    """Return F^-1 of the sheet from above at each node, of its cells (n_points, 2, 2); I where they stand upright."""
    start = mesh.points
    total, count = np.zeros((len(start), 2, 2)), np.zeros(len(start))
    for block in mesh.blocks:
        cells = block.connectivity
        first, last = find_cell(2, cells).spans.T
        before, after = (
            np.swapaxes(points[cells[:, last], :2] - points[cells[:, first], :2], 1, 2) for points in (start, now)
        )
        deformation = after @ np.linalg.inv(before)
        flat = np.linalg.det(deformation) > _STEEPEST
        inverse = np.linalg.inv(np.where(flat[:, None, None], deformation, np.eye(2)))
        for corner in cells.T:
            np.add.at(total, corner, inverse)
            np.add.at(count, corner, 1.0)
    return np.asarray(total / np.maximum(count, 1.0)[:, None, None])
