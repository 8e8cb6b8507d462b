# SPDX-License-Identifier: Apache-2.0
"""Smallest radius of a tool made of triangles, for comparison with the size of the elements that bend around it.

Over an edge, with u along it and v across it, the surface is z = (A u^2 + 2 B u v + C v^2) / 2. A and B come from the
normals at the ends of the edge. C comes from the turn between the two facets, less the part of the turn that A and B
cause: where the surface is curved along an edge, the edge is a chord below it, and the facets turn although nothing is
bent across. The radius is that of the larger principal curvature.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.model import FloatArray, IntArray

SHARP = float(np.radians(35.0))
"""Turn from facet to facet above which an edge has no radius: a quarter turn has three facets at least."""
FLAT = float(np.radians(1.0))
"""Turn below which two facets are one."""
_CHORD = 0.3
"""Part of the turn by the chord over that by C, above which the C of an edge is too uncertain to count."""


@dataclass(frozen=True)
class _Edges:
    """Edges between two facets, with the quadratic surface over each."""

    turn: FloatArray
    """Turn between the facets (n,) [rad], positive in a valley."""
    across: FloatArray
    """Part of it that bending across the edge causes (n,) [rad]."""
    curvature: FloatArray
    """Larger principal curvature (n,) [1/mm]."""
    along: FloatArray
    """Length of the edge along the axis of that curvature (n,) [mm]."""


def find_least_radius(points: FloatArray, triangles: IntArray, length: float, *, sharp_counts: bool = True) -> float:
    """Return the radius below which a tool is bent along `length` [mm] of its edges; infinite where it is flat.

    points: (n_points, 3) [mm]; triangles: (n, 3); sharp_counts: whether edges without a radius count. The corners lie
    on the surface. Exact within fillets, whatever the spacing of their corners, and never too small where they end.
    """
    found = _measure_edges(points, triangles)
    bent = (np.abs(found.turn) > FLAT) & (np.abs(found.turn - found.across) <= _CHORD * np.abs(found.across))
    is_sharp = np.abs(found.across) > SHARP
    bent &= sharp_counts | ~is_sharp
    radius = np.where(is_sharp, 0.0, 1.0 / np.maximum(found.curvature, 1e-12))[bent]
    sharpest = np.argsort(radius)
    reached = np.flatnonzero(np.cumsum(found.along[bent][sharpest]) >= length)
    return float(radius[sharpest[reached[0]]]) if len(reached) else float("inf")


def _measure_edges(points: FloatArray, triangles: IntArray) -> _Edges:
    """Return the edges that two triangles share."""
    corners = points[triangles]
    facet = _unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    ends, tips, owners = _pair(triangles)
    start, vector = points[ends[:, 0]], points[ends[:, 1]] - points[ends[:, 0]]
    length = np.maximum(np.linalg.norm(vector, axis=1), 1e-300)
    u, middle = vector / length[:, None], _unit(facet[owners[:, 0]] + facet[owners[:, 1]])
    beside = [points[tip] - start for tip in tips.T]
    at = [_dot(each, u) for each in beside]
    outwards = [each - s[:, None] * u for each, s in zip(beside, at, strict=True)]
    width = [np.maximum(np.linalg.norm(each, axis=1), 1e-300) for each in outwards]
    across = np.cross(middle, u)
    across *= np.where(_dot(across, outwards[0]) < 0.0, -1.0, 1.0)[:, None]
    rises = _dot(outwards[0] / width[0][:, None] + outwards[1] / width[1][:, None], middle)
    turn = np.arccos(np.clip(_dot(facet[owners[:, 0]], facet[owners[:, 1]]), -1.0, 1.0)) * np.where(rises > 0, 1, -1)
    normal = _normals_at_corners(points, triangles)
    change = normal[ends[:, 1]] - normal[ends[:, 0]]
    a, b = -_dot(change, u) / length, -_dot(change, across) / length
    chord = 0.5 * a * sum(s * (s - length) / w for s, w in zip(at, width, strict=True)) + b * (at[0] - at[1])
    own = turn - chord
    # the circle through the edge and the corners opposite to it, as they would lie without the chord
    apart = np.sqrt(width[0] ** 2 + width[1] ** 2 + 2.0 * width[0] * width[1] * np.cos(own))
    c = 2.0 * np.sin(np.clip(own, -0.5 * np.pi, 0.5 * np.pi)) / np.maximum(apart, 1e-300)
    return _Edges(turn, own, *_largest(a, b, c, length))


def _largest(a: FloatArray, b: FloatArray, c: FloatArray, length: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the larger principal curvature of [[a, b], [b, c]], and the lengths of edges along its axis (n,)."""
    mean, apart = 0.5 * (a + c), np.hypot(0.5 * (a - c), b)
    angle = 0.5 * np.arctan2(2.0 * b, a - c)  # of the curvature mean + apart against the edge
    share = np.where(mean >= 0.0, np.abs(np.sin(angle)), np.abs(np.cos(angle)))
    return np.abs(mean) + apart, share * length


def _pair(triangles: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """Return ends, opposite corners and triangles of the edges that two triangles share (n, 2) each."""
    ends = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    tip = np.concatenate([triangles[:, 2], triangles[:, 0], triangles[:, 1]])
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    ends, tip, owner = ends[order], tip[order], np.tile(np.arange(len(triangles)), 3)[order]
    one = np.flatnonzero((ends[1:] == ends[:-1]).all(axis=1))
    return ends[one], np.stack([tip[one], tip[one + 1]], axis=1), np.stack([owner[one], owner[one + 1]], axis=1)


def _normals_at_corners(points: FloatArray, triangles: IntArray) -> FloatArray:
    """Return unit normals (n_points, 3), exact for corners on a sphere (Max 1999, J. Graphics Tools 4(2), 1)."""
    found = np.zeros_like(points)
    for k in range(3):
        one, other = (points[triangles[:, (k + j) % 3]] - points[triangles[:, k]] for j in (1, 2))
        weight = np.maximum(_dot(one, one) * _dot(other, other), 1e-300)
        np.add.at(found, triangles[:, k], np.cross(one, other) / weight[:, None])
    return _unit(found)


def _dot(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray((a * b).sum(axis=1))


def _unit(vectors: FloatArray) -> FloatArray:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-300))
