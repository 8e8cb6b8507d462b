# SPDX-License-Identifier: Apache-2.0
"""The two faces of a crack that has closed are parted where a new outline lets them cross each other.

Contact keeps faces apart but for a small penetration, and a new line leaves the old one by the bend of an edge. So
nodes that lie in the metal of the other face move back out of it. There a ray leaves the outline an even number of
times, which it does not on the far side of thin metal.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from presswork.geometry.polygon import contains
from presswork.model import BoolArray, FloatArray, IndexArray
from presswork.remesh.boundary import find_folds
from presswork.remesh.fill import measure_thickness
from presswork.remesh.volume import put_on_tools

DEEPEST = 0.5
"""Deepest penetration that is taken back, over the edges beside the node."""
APART = 0.02
"""Gap that is left, over the edges beside the node."""
_ROUNDS = 12


def part_faces(
    points: FloatArray, after: IndexArray, may_move: BoolArray, profiles: Sequence[FloatArray]
) -> FloatArray:
    """Return the nodes of loops (n, 2) [mm] with those that lie in the metal of another part of them moved out.

    after: the node that follows each (n,); may_move: nodes that no plane holds (n,); profiles: of the tools, in which
    no node may end.
    """
    points, before = points.copy(), np.argsort(after)
    for _ in range(_ROUNDS):
        along = points[after] - points[before]
        reach = np.linalg.norm(along, axis=1)
        outwards = np.column_stack([along[:, 1], -along[:, 0]]) / np.maximum(reach, 1e-300)[:, None]
        sides = np.stack([points, points[after]], axis=1)
        depth = measure_thickness(sides, points, -outwards)
        near = may_move & (depth < DEEPEST * 0.5 * reach)
        near[near] = ~contains(sides, points[near] - 0.5 * depth[near, None] * outwards[near])
        points[near] -= (0.6 * depth + APART * 0.5 * reach)[near, None] * outwards[near]
        folds = find_folds(np.stack([points, points[after]], axis=1))
        if not near.any() and not len(folds):
            break
        for first, second in folds.tolist():
            _take_back(points, after, may_move, first, second)
        put_on_tools(points, may_move, profiles)
    return points


def _take_back(points: FloatArray, after: IndexArray, may_move: BoolArray, first: int, second: int) -> None:
    """Put the end of one of two sides that cross each other, the one that lies least deep, out of the other's metal."""
    best: tuple[float, int, FloatArray] | None = None
    for side, other in ((first, second), (second, first)):
        start, end = points[side], points[after[side]]
        length = float(np.linalg.norm(end - start))
        inwards = np.array([start[1] - end[1], end[0] - start[0]]) / max(length, 1e-300)
        for node in (other, int(after[other])):
            depth = float((points[node] - start) @ inwards)
            if may_move[node] and depth >= 0.0 and (best is None or depth < best[0]):
                best = depth, node, (depth + APART * length) * inwards
    if best is not None:
        points[best[1]] -= best[2]
