# SPDX-License-Identifier: Apache-2.0
"""The nearest places of a surface of triangles, with the triangle and its weights there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from presswork.model import BoolArray, FloatArray, IntArray

_CANDIDATES = 32
"""Triangles with the nearest middles among which the nearest one is sought."""


@dataclass(frozen=True)
class Feet:
    """Nearest places to n points."""

    triangle: IntArray
    """Which triangle (n,)."""
    weight: FloatArray
    """Weight of its corners (n, 3); they sum to 1."""

    def interpolate(self, values: FloatArray, triangles: IntArray) -> FloatArray:
        """Return nodal values (n_points, k) at the places (n, k)."""
        return np.asarray(np.einsum("na,nak->nk", self.weight, values[triangles[self.triangle]]))


def find_feet(x: FloatArray, points: FloatArray, triangles: IntArray) -> Feet:
    """Return the nearest places to x (n, 3) on triangles (m, 3) of points (n_points, 3).

    Among the triangles with the nearest middles: these must not be much longer than they are far apart (split_long
    first). The place in a triangle is that of Ericson (2005), Real-Time Collision Detection, 5.1.5.
    """
    corners = points[triangles]
    count = min(_CANDIDATES, len(triangles))
    _, near = cKDTree(corners.mean(axis=1)).query(x, k=count)
    near = near.reshape(len(x), count)
    weight = _find_weights(x[:, None], *(corners[near][:, :, k] for k in range(3)))
    place = np.einsum("nca,ncai->nci", weight, corners[near])
    best = np.argmin(((place - x[:, None]) ** 2).sum(axis=2), axis=1)
    row = np.arange(len(x))
    return Feet(near[row, best].astype(np.int32), weight[row, best])


def split_long(points: FloatArray, triangles: IntArray, longest: float) -> tuple[FloatArray, IntArray]:
    """Split triangles until no edge is longer than `longest` [mm]; the surface stays as it is.

    An edge is split in its middle, for both triangles that share it, so no gap opens. A triangle with one or two such
    edges goes into two or three.
    """
    for _ in range(40):
        ends = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
        edges, number = np.unique(ends, axis=0, return_inverse=True)
        number = number.reshape(3, -1).T  # of the edges 01, 12, 20 of each triangle
        is_long = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1) > longest
        if not is_long.any():
            break
        middle = np.full(len(edges), -1)
        middle[is_long] = len(points) + np.arange(int(is_long.sum()))
        points = np.concatenate([points, points[edges[is_long]].mean(axis=1)])
        triangles = _split(points, triangles, middle[number])
    return points, triangles.astype(np.int32)


def _split(points: FloatArray, triangles: IntArray, middle: IntArray) -> IntArray:
    """Return triangles split at the middles of their edges 01, 12, 20 (n, 3), -1 where an edge stays."""
    is_split = middle >= 0
    count = is_split.sum(axis=1)
    found = [triangles[count == 0]]
    for k in range(3):
        order = [k, (k + 1) % 3, (k + 2) % 3]
        one = (count == 1) & is_split[:, k]
        a, b, c = triangles[one][:, order].T
        m = middle[one][:, k]
        found += [np.stack([a, m, c], axis=1), np.stack([m, b, c], axis=1)]
        two = (count == 2) & ~is_split[:, k]  # the edge ab stays
        a, b, c = triangles[two][:, order].T
        bc, ca = middle[two][:, order[1]], middle[two][:, order[2]]
        found.append(np.stack([bc, c, ca], axis=1))
        cut = np.linalg.norm(points[a] - points[bc], axis=1) <= np.linalg.norm(points[b] - points[ca], axis=1)
        diagonal = np.where(cut[:, None], np.stack([a, bc, ca], axis=1), np.stack([b, bc, ca], axis=1))
        rest = np.where(cut[:, None], np.stack([a, b, bc], axis=1), np.stack([a, b, ca], axis=1))
        found += [diagonal, rest]
    a, b, c = triangles[count == 3].T
    ab, bc, ca = middle[count == 3].T
    found += [np.stack(each, axis=1) for each in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
    return np.concatenate(found)


def _find_weights(x: FloatArray, a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
    """Return the weights (..., 3) of the corners at the place in a triangle that is nearest to x (..., 3)."""
    ab, ac = b - a, c - a
    ax, bx, cx = x - a, x - b, x - c
    d1, d2 = (ab * ax).sum(-1), (ac * ax).sum(-1)
    d3, d4 = (ab * bx).sum(-1), (ac * bx).sum(-1)
    d5, d6 = (ab * cx).sum(-1), (ac * cx).sum(-1)
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    zero, one = np.zeros_like(d1), np.ones_like(d1)

    def ratio(part: FloatArray, other: FloatArray) -> FloatArray:
        total = part + other
        return np.asarray(part / np.where(total == 0.0, 1.0, total))

    v_ab, w_ac, w_bc = ratio(d1, -d3), ratio(d2, -d6), ratio(d4 - d3, d5 - d6)
    total = np.where(va + vb + vc == 0.0, 1.0, va + vb + vc)
    cases: list[tuple[BoolArray, tuple[FloatArray, FloatArray, FloatArray]]] = [
        ((d1 <= 0) & (d2 <= 0), (one, zero, zero)),
        ((d3 >= 0) & (d4 <= d3), (zero, one, zero)),
        ((d6 >= 0) & (d5 <= d6), (zero, zero, one)),
        ((vc <= 0) & (d1 >= 0) & (d3 <= 0), (one - v_ab, v_ab, zero)),
        ((vb <= 0) & (d2 >= 0) & (d6 <= 0), (one - w_ac, zero, w_ac)),
        ((va <= 0) & (d4 >= d3) & (d5 >= d6), (zero, one - w_bc, w_bc)),
    ]
    inside = (va / total, vb / total, vc / total)
    conditions = [condition for condition, _ in cases]
    return np.stack([np.select(conditions, [w[k] for _, w in cases], inside[k]) for k in range(3)], axis=-1)
