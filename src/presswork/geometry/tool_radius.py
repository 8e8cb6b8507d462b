# SPDX-License-Identifier: Apache-2.0
"""Smallest radius of a tool made of triangles, for comparison with the size of the elements that bend around it."""

from __future__ import annotations

import numpy as np

from presswork.model import FloatArray, IntArray

SHARP = float(np.radians(35.0))
"""Turn from facet to facet above which an edge has no radius: a quarter turn has three facets at least."""
FLAT = float(np.radians(1.0))
"""Turn below which two facets are one."""


def find_least_radius(points: FloatArray, triangles: IntArray, length: float, *, sharp_counts: bool = True) -> float:
    """Return the radius below which a tool is bent along `length` [mm] of its edges; infinite where it is flat.

    points: (n_points, 3) [mm]; triangles: (n, 3); sharp_counts: whether edges without a radius count. Between facets
    that turn by theta the radius is that of the circle through their common edge and the two corners opposite to it:
    exact within a fillet whose corners lie on it, whatever their spacing, and never too small where the fillet ends.
    """
    corners = points[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    doubled = np.linalg.norm(normal, axis=1)
    normal = normal / np.maximum(doubled, 1e-300)[:, None]
    ends = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    owner = np.tile(np.arange(len(triangles)), 3)
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    ends, owner = ends[order], owner[order]
    same = np.flatnonzero((ends[1:] == ends[:-1]).all(axis=1))
    one, other = owner[same], owner[same + 1]
    edge = np.linalg.norm(points[ends[same, 1]] - points[ends[same, 0]], axis=1)
    turn = np.arccos(np.clip((normal[one] * normal[other]).sum(axis=1), -1.0, 1.0))
    width, its = (doubled[each] / np.maximum(edge, 1e-300) for each in (one, other))
    chord = np.sqrt(width**2 + its**2 + 2.0 * width * its * np.cos(turn))
    bent = (turn > FLAT) & (sharp_counts | (turn <= SHARP))
    radius = np.where(turn > SHARP, 0.0, 0.5 * chord / np.sin(np.maximum(turn, FLAT)))[bent]
    sharpest = np.argsort(radius)
    reached = np.flatnonzero(np.cumsum(edge[bent][sharpest]) >= length)
    return float(radius[sharpest[reached[0]]]) if len(reached) else float("inf")
