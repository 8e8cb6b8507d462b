# SPDX-License-Identifier: Apache-2.0
"""Where the boundary of one body faces that of another, across no gap or a narrow one."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from presswork.mesh.edges import GAUSS_3
from presswork.model import BoolArray, FloatArray, IndexArray, IntArray

TOUCH = 1e-3
"""Of an edge: how far the ends of another may be from its line and still lie on it."""
LEAST_PART = 1e-9
"""Of an edge: shorter common parts are none."""


@dataclass(frozen=True)
class Facing:
    """Points on the edges of one body, and what lies opposite each."""

    own: IndexArray
    """Edge of the one body (n,)."""
    other: IndexArray
    """Edge of the other (n,)."""
    own_shape: FloatArray
    """Shape functions of the two ends of the own edge there (n, 2)."""
    other_shape: FloatArray
    """Of the ends of the other edge (n, 2)."""
    gap: FloatArray
    """Distance along the normal of the own edge, negative where the bodies overlap (n,) [mm]."""
    area: FloatArray
    """Own surface that a point stands for (n,) [mm2]."""

    def choose(self, which: BoolArray) -> Facing:
        """Return the points that are marked (n,)."""
        return Facing(*(getattr(self, f.name)[which] for f in fields(self)))


def split_edges(edges: IntArray) -> IntArray:
    """Return edges (n, 2 | 3) as straight pieces between neighbouring nodes (n | 2 n, 2)."""
    if edges.shape[1] == 2:
        return edges
    return np.concatenate([edges[:, [0, 2]], edges[:, [2, 1]]])


def find_facing(
    points: FloatArray, own: IntArray, other: IntArray, reach: FloatArray, thickness: float | None
) -> Facing:
    """Find which parts of straight edges (n, 2) of a body face those of another no farther than `reach` (n,) [mm].

    Each body is on the left of its edges, so that edges that face each other run against each other. Parts are
    projected along the normal of the own edge; where several others cover a part, each counts in proportion. Overlaps
    no deeper than half the own edge, or than `reach`, count. thickness [mm]: out of the plane; None: the edges are
    rings.
    """
    a, b = points[own[:, 0]], points[own[:, 1]]
    along = b - a
    length = np.linalg.norm(along, axis=1)
    across = np.column_stack([-along[:, 1], along[:, 0]]) / length[:, None]
    depth = np.maximum(reach, 0.5 * length)
    first, second = _find_candidates(points, own, other, depth)
    start, unit, n = a[first], along[first] / length[first, None] ** 2, across[first]
    ends = np.stack([((points[other[second, k]] - start) * unit).sum(axis=1) for k in (0, 1)], axis=1)
    gaps = np.stack([-((points[other[second, k]] - start) * n).sum(axis=1) for k in (0, 1)], axis=1)
    low, high = np.clip(ends[:, 1], 0.0, 1.0), np.clip(ends[:, 0], 0.0, 1.0)
    near = (gaps.min(axis=1) <= reach[first]) & (gaps.max(axis=1) >= -depth[first])
    keep = (high - low > LEAST_PART) & near & ~_share_a_node(own[first], other[second])
    first, second, ends, gaps, low, high = (x[keep] for x in (first, second, ends, gaps, low, high))
    covered = np.bincount(first, high - low, minlength=len(own))[first]
    parts: list[tuple[FloatArray, ...]] = []
    for s, weight in GAUSS_3:
        at = low + 0.5 * (1 + s) * (high - low)
        place = (at - ends[:, 0]) / (ends[:, 1] - ends[:, 0])
        gap = gaps[:, 0] + place * (gaps[:, 1] - gaps[:, 0])
        radius = a[first, 0] + at * along[first, 0]
        width = 2 * np.pi * radius if thickness is None else np.full(len(at), thickness)
        area = 0.5 * weight * (high - low) / np.maximum(covered, 1.0) * length[first] * width
        parts.append((at, place, gap, area))
    at, place, gap, area = (np.concatenate(values) for values in zip(*parts, strict=True))
    own_edge, other_edge = np.tile(first, len(GAUSS_3)), np.tile(second, len(GAUSS_3))
    near = (gap <= reach[own_edge]) & (gap >= -depth[own_edge])
    shapes = np.column_stack([1 - at, at]), np.column_stack([1 - place, place])
    return Facing(own_edge, other_edge, *shapes, gap, area).choose(near)


def find_lying(points: FloatArray, own: IntArray, other: IntArray, thickness: float | None) -> Facing:
    """Return where straight edges (n, 2) of one body lie on those of another."""
    length = np.linalg.norm(points[own[:, 1]] - points[own[:, 0]], axis=1)
    found = find_facing(points, own, other, TOUCH * length, thickness)
    return found.choose(np.abs(found.gap) <= TOUCH * length[found.own])


def _find_candidates(
    points: FloatArray, own: IntArray, other: IntArray, margin: FloatArray
) -> tuple[IndexArray, IndexArray]:
    """Return the pairs of edges whose boxes come within the margin (n_own,) of each other."""
    low, high = points[own].min(axis=1) - margin[:, None], points[own].max(axis=1) + margin[:, None]
    low_other, high_other = points[other].min(axis=1), points[other].max(axis=1)
    meets = np.ones((len(own), len(other)), dtype=bool)
    for axis in range(2):
        meets &= (low[:, None, axis] <= high_other[None, :, axis]) & (low_other[None, :, axis] <= high[:, None, axis])
    first, second = np.nonzero(meets)
    return first, second


def _share_a_node(own: IntArray, other: IntArray) -> BoolArray:
    return np.asarray((own[:, :, None] == other[:, None, :]).any(axis=(1, 2)))


def sum_pairs(facing: Facing, own: IntArray, other: IntArray, amount: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return pairs of nodes (n, 2), each once, and the sums of an amount at the points (n_points_of_facing,) over them.

    Each point shares its amount among the ends of both edges by their shape functions.
    """
    nodes = np.stack(np.broadcast_arrays(own[facing.own][:, :, None], other[facing.other][:, None, :]), axis=-1)
    shares = amount[:, None, None] * facing.own_shape[:, :, None] * facing.other_shape[:, None, :]
    pairs, place = np.unique(nodes.reshape(-1, 2), axis=0, return_inverse=True)
    sums = np.bincount(place.ravel(), shares.ravel(), minlength=len(pairs))
    return pairs.astype(np.int32).reshape(-1, 2), sums.astype(np.float64)
