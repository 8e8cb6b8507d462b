# SPDX-License-Identifier: Apache-2.0
"""Sides that a triangulation must have: edges across them are flipped until they are there (Sloan 1993).

Delaunay's triangles leave out a side where a narrow gap opens before it, as a crack does: points of the opposite face
are nearer to its ends than these to each other. Sides that cross each other cannot all be there.
"""

from __future__ import annotations

from collections import deque

import numpy as np

from presswork.model import FloatArray, IndexArray

_MOST_FLIPS = 50
"""Flips for one side, times the edges across it."""


def force_sides(points: FloatArray, triangles: IndexArray, sides: IndexArray) -> IndexArray:
    """Return triangles, counter-clockwise (n, 3), with as many of wanted sides (k, 2) as can be had.

    points: (n_points, 2) [mm]. The same array comes back where nothing is missing.
    """
    missing = sides[find_missing(triangles, sides)]
    if not len(missing):
        return triangles
    flips = _Flips(points, triangles)
    for a, b in missing.tolist():
        flips.force(a, b)
    return flips.list_triangles()


def find_missing(triangles: IndexArray, sides: IndexArray) -> IndexArray:
    """Return which sides (k, 2) are no edge of triangles (n, 3) in either direction."""
    n = 1 + max(int(triangles.max()), int(sides.max()))
    ends = np.concatenate([triangles, np.roll(triangles, -1, axis=1)], axis=1).reshape(-1, 2, 3).transpose(0, 2, 1)
    key = np.sort(ends.reshape(-1, 2), axis=1) @ np.array([n, 1])
    return np.flatnonzero(~np.isin(np.sort(sides, axis=1) @ np.array([n, 1]), key))


class _Flips:
    """Triangles by their edges: the corner opposite to each, in the direction in which the triangle has it."""

    def __init__(self, points: FloatArray, triangles: IndexArray) -> None:
        self._points = points.tolist()
        self._apex: dict[tuple[int, int], int] = {}
        for a, b, c in triangles.tolist():
            self._apex |= {(a, b): c, (b, c): a, (c, a): b}

    def list_triangles(self) -> IndexArray:
        """Return the triangles as they are now (n, 3)."""
        found = [(a, b, c) for (a, b), c in self._apex.items() if a < b and a < c]
        return np.array(found, dtype=np.intp)

    def force(self, a: int, b: int) -> None:
        """Flip edges until a side is there, or stop where a point or a side prevents it."""
        across = deque(self._find_across(a, b))
        for _ in range(_MOST_FLIPS * (1 + len(across))):
            if not across:
                return
            u, v = across.popleft()
            p, q = self._apex[u, v], self._apex[v, u]
            if not (self._turn(p, u, q) > 0.0 and self._turn(q, v, p) > 0.0):  # not convex: later
                across.append((u, v))
                continue
            for edge in ((u, v), (v, p), (p, u), (v, u), (u, q), (q, v)):
                del self._apex[edge]
            self._apex |= {(p, u): q, (u, q): p, (q, p): u, (p, q): v, (q, v): p, (v, p): q}
            if not {p, q} & {a, b} and self._turn(a, b, p) * self._turn(a, b, q) < 0.0:
                across.append((p, q))

    def _find_across(self, a: int, b: int) -> list[tuple[int, int]]:
        """Return the edges that a side crosses, from its beginning on; none where a point lies on it."""
        starts = [(u, v) for (u, v), apex in self._apex.items() if apex == a]
        first = [(u, v) for u, v in starts if self._turn(a, b, u) < 0.0 < self._turn(a, b, v)]
        ahead = [(u, v) for u, v in first if self._turn(u, v, b) < 0.0]
        if not ahead:
            return []
        found, (u, v) = [ahead[0]], ahead[0]
        while True:
            w = self._apex.get((v, u))
            if w is None:
                return []
            if w == b:
                return found
            side = self._turn(a, b, w)
            if side == 0.0:
                return []
            u, v = (u, w) if side > 0.0 else (w, v)
            found.append((u, v))

    def _turn(self, a: int, b: int, c: int) -> float:
        """Return twice the area of a triangle, positive counter-clockwise."""
        (ax, ay), (bx, by), (cx, cy) = self._points[a], self._points[b], self._points[c]
        return float((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))
