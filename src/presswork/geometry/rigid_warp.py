# SPDX-License-Identifier: Apache-2.0
"""A smooth map of space that follows nodes and, near each place, moves like a rigid body.

Moving least squares with rigid motions (Schaefer, McPhail and Warren 2006, Image deformation using moving least
squares; in space by Kabsch 1976): each place moves by the rigid motion that fits the nodes near it best. Lengths and
angles next to the nodes are kept, so two tools on either side of a sheet keep their distance. Beyond the sheet's edge
the map goes on straight over a few times the distance of the nodes. Farther off only the rotation of all nodes together
goes on: that of the last nodes would lift the end of a wide tool by many millimetres. The map smooths over the nodes
near: a node does not come to lie exactly at its target.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from presswork.model import FloatArray

_NEAR = 20
"""Nodes that take part at each place."""
_ARM = 2.0
"""Distance to which the nodes' rotation continues, over that of the farthest of them from their middle."""
_CHUNK = 50_000


class RigidWarp:
    """The map that takes nodes to where they are wanted."""

    def __init__(self, points: FloatArray, moved: FloatArray, planes: tuple[bool, bool]) -> None:
        """points, moved: nodes (n, 3) [mm] and where they are wanted.

        planes: symmetry planes x = 0 | y = 0, which the map keeps; the nodes lie on the positive or the negative side.
        """
        self._planes = planes
        for axis in (0, 1):
            if planes[axis]:
                sign = np.where(np.arange(3) == axis, -1.0, 1.0)
                points, moved = np.concatenate([points, points * sign]), np.concatenate([moved, moved * sign])
        self._tree, self._points, self._moved = cKDTree(points), points, moved
        start, goal = points - points.mean(axis=0), moved - moved.mean(axis=0)
        self._turn = _find_rotations(start.T[None] @ goal[None])[0]

    def carry(self, x: FloatArray) -> FloatArray:
        """Return where places (n, 3) go [mm]."""
        signs = np.ones_like(x)
        for axis in (0, 1):
            if self._planes[axis]:
                signs[:, axis] = np.where(x[:, axis] < 0.0, -1.0, 1.0)
        folded = x * signs
        found = np.concatenate([self._carry(folded[i : i + _CHUNK]) for i in range(0, len(x), _CHUNK)])
        for axis in (0, 1):
            if self._planes[axis]:
                found[folded[:, axis] == 0.0, axis] = 0.0
        return np.asarray(found * signs)

    def _carry(self, x: FloatArray) -> FloatArray:
        distance, near = self._tree.query(x, k=min(_NEAR, len(self._points)))
        reach = distance[:, -1:] * (1.0 + 1e-9)
        weight = (1.0 - distance / np.maximum(reach, 1e-300)) ** 2 / np.maximum(distance / reach, 0.05)
        weight /= weight.sum(axis=1, keepdims=True)
        start, goal = self._points[near], self._moved[near]
        from_middle, to_middle = (np.einsum("nk,nki->ni", weight, p) for p in (start, goal))
        spread = np.einsum("nk,nki,nkj->nij", weight, start - from_middle[:, None], goal - to_middle[:, None])
        away = x - from_middle
        span = np.linalg.norm(start - from_middle[:, None], axis=2).max(axis=1)
        arm = away * np.minimum(1.0, _ARM * span / np.maximum(np.linalg.norm(away, axis=1), 1e-300))[:, None]
        own = np.einsum("nj,njk->nk", arm, _find_rotations(spread) - self._turn)
        return np.asarray(to_middle + away @ self._turn + own)


def _find_rotations(spread: FloatArray) -> FloatArray:
    """Return the rotations (n, 3, 3) of rows of vectors that fit best, from their products (n, 3, 3)."""
    u, _, vt = np.linalg.svd(spread)
    u[:, :, 2] *= np.sign(np.linalg.det(u @ vt))[:, None]
    return np.asarray(u @ vt)
