# SPDX-License-Identifier: Apache-2.0
"""Where the boundary of one body faces that of another, across no gap or a narrow one."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from presswork import _core
from presswork.model import BoolArray, FloatArray, IntArray, find_cell

TOUCH = 1e-3
"""How far the ends of an edge may be from the line of another and still lie on it, over the length of the other."""


@dataclass(frozen=True)
class Facing:
    """Points on the sides of one body, edges or in space faces, and what lies opposite each."""

    own: IntArray
    """Side of the one body (n,)."""
    other: IntArray
    """Side of the other (n,)."""
    own_shape: FloatArray
    """Shape functions of the nodes of the own side there (n, 2 | 3 | 4)."""
    other_shape: FloatArray
    """Shape functions of the nodes of the other side, in the same form."""
    gap: FloatArray
    """Distance along the normal of the own side, negative where the bodies overlap (n,) [mm]."""
    area: FloatArray
    """Own surface that a point stands for (n,) [mm2]."""

    def choose(self, which: BoolArray) -> Facing:
        """Return the points that are marked (n,)."""
        return Facing(*(getattr(self, f.name)[which] for f in fields(self)))


def split_edges(edges: IntArray) -> IntArray:
    """Return edges (n, 2 | 3) as straight pieces between neighbouring nodes (n | 2 n, 2)."""
    return np.concatenate([edges[:, ends] for ends in find_cell(1, edges).pieces])


def find_facing(
    points: FloatArray, own: IntArray, other: IntArray, reach: FloatArray, thickness: float | None
) -> Facing:
    """Find which parts of straight edges (n, 2) of a body face those of another no farther than `reach` (n,) [mm].

    In space they are faces (n, 3 | 4), and thickness has no meaning. Each body is on the left of its edges, so that
    edges that face each other run against each other. Parts are projected along the normal of the own edge; where
    several others cover a part, each counts in proportion. Overlaps no deeper than half the own edge, of faces half the
    root of its area, or than `reach`, count. thickness [mm]: out of the plane; None: the edges are rings.
    """
    if points.shape[1] == 3:
        return Facing(*_core.find_facing_faces(points, own, other, reach))
    return Facing(*_core.find_facing(points, own, other, reach, 0.0 if thickness is None else thickness))


def measure_lengths(points: FloatArray, sides: IntArray) -> FloatArray:
    """Return the lengths of straight edges (n, 2), or the mean lengths of the edges of faces (n, 3 | 4) (n,) [mm]."""
    if points.shape[1] == 2:
        return np.asarray(np.linalg.norm(points[sides[:, 1]] - points[sides[:, 0]], axis=1))
    return np.asarray(np.linalg.norm(points[np.roll(sides, -1, axis=1)] - points[sides], axis=2).mean(axis=1))


def find_touching_faces(points: FloatArray, own: IntArray, other: IntArray, thickness: float | None) -> Facing:
    """Return where straight edges (n, 2), in space faces (n, 3 | 4), of one body lie on those of another."""
    length = measure_lengths(points, own)
    found = find_facing(points, own, other, TOUCH * length, thickness)
    return found.choose(np.abs(found.gap) <= TOUCH * length[found.own])


def sum_pairs(
    facing: Facing, own: IntArray, other: IntArray, *amounts: FloatArray
) -> tuple[IntArray, tuple[FloatArray, ...]]:
    """Return pairs of nodes (n, 2), each once, and the sums of amounts at the points (n_points_of_facing,) over them.

    Each point shares its amounts among the nodes of both sides by their shape functions.
    """
    pairs, sums = _core.sum_pairs(
        facing.own, facing.other, facing.own_shape, facing.other_shape, own, other, list(amounts)
    )
    return np.asarray(pairs), tuple(np.asarray(each) for each in sums)
