# SPDX-License-Identifier: Apache-2.0
"""The flange of a part, by its triangles: flat, or smoothly curved as that of a curved binder."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

import numpy as np

from presswork.mesh.make.surface_offset import unit_normals
from presswork.mesh.triangles import find_rims, pair_triangles
from presswork.model import BoolArray, FloatArray, IntArray

FLAT = 0.996
"""z of the normals of a flange: within 5 degrees of level."""
GENTLE, SMOOTH, CHORD = np.cos(np.radians(20.0)), 100.0, np.radians(0.5)
"""Limits of a curved flange: its least normal along the press [1], its least radius over the thickness, and the angle
between facets that may be chords of any radius [rad]."""
MOST = 0.9
"""Part of a flange's outline that is level if the flange is flat."""


def find_flange(
    points: FloatArray, triangles: IntArray, up: FloatArray, thickness: float, neighbours: list[list[int]]
) -> BoolArray:
    """Return the triangles of the flange (n,): those about level that are connected with the highest of the outline.

    A level flange is flat. One of a curved binder bends smoothly and stays below a slope of GENTLE; it is taken where
    the level part of it is less than MOST of its outline.
    """
    owner = find_outline(points, triangles)[2]
    is_owner = np.isin(np.arange(len(up)), owner)
    ends = triangles[owner[up[owner] > FLAT]]
    high = float(points[ends, 2].max(initial=-np.inf))
    level = (up > FLAT) & (np.abs(points[triangles, 2] - high) < 0.5 * thickness).all(axis=1)
    flat = spread_over(level & is_owner, neighbours, lambda _, there: bool(level[there]))
    normals, middle = unit_normals(points, triangles), points[triangles].mean(axis=1)

    def is_smooth(here: int, there: int) -> bool:
        turn = float(np.linalg.norm(normals[here] - normals[there]))
        distance = float(np.linalg.norm(middle[here] - middle[there]))
        return bool(up[there] > GENTLE) and (turn < CHORD or turn * SMOOTH * thickness < distance)

    curved = spread_over(flat & is_owner, neighbours, is_smooth)
    return flat if flat[owner].sum() >= MOST * curved[owner].sum() else curved


def list_neighbours(triangles: IntArray) -> list[list[int]]:
    """Return the triangles across the edges of each."""
    neighbours: list[list[int]] = [[] for _ in range(len(triangles))]
    for a, b in pair_triangles(triangles).triangles.tolist():
        neighbours[a].append(b)
        neighbours[b].append(a)
    return neighbours


def find_outline(points: FloatArray, triangles: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """Return the ends of the edges of the part's outline, the part on their left, and the triangle of each."""
    rim = max(find_rims(points, triangles), key=lambda loop: measure_width(points, loop))
    after = np.roll(rim, -1)
    ends = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    key = ends[:, 0] * len(points) + ends[:, 1]
    order = np.argsort(key)
    at = np.searchsorted(key[order], rim.astype(np.int64) * len(points) + after)
    return rim, after, np.asarray(order[at] % len(triangles))


def measure_width(points: FloatArray, loop: IntArray) -> float:
    return float(np.ptp(points[loop, :2], axis=0).sum())


def spread_over(start: BoolArray, neighbours: list[list[int]], goes_on: Callable[[int, int], bool]) -> BoolArray:
    """Return the triangles that can be reached from some, from neighbour to neighbour (n,)."""
    reached = start.copy()
    queue = deque(np.flatnonzero(start).tolist())
    while queue:
        here = queue.popleft()
        for there in neighbours[here]:
            if not reached[there] and goes_on(here, there):
                reached[there] = True
                queue.append(there)
    return reached
