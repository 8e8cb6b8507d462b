# SPDX-License-Identifier: Apache-2.0
"""Split a polygon of three to six corners into quadrilaterals and triangles of good shape."""

from __future__ import annotations

import numpy as np

from presswork.model import FloatArray

BLUNT = 0.25
"""Least sine of a quadrilateral's angles; one below it is split into triangles."""

Loop = tuple[int, ...]


def split_polygon(points: FloatArray, normal: FloatArray) -> tuple[list[Loop], float]:
    """Return the corners of each piece of a polygon (n, 3), which runs counter-clockwise about `normal`, and a quality.

    The quality is that of the worst piece: 1 for an equilateral triangle or a rectangle, 0 or less for one that has
    folded.
    """
    return _split(tuple(range(len(points))), points, normal)


def _split(loop: Loop, points: FloatArray, normal: FloatArray) -> tuple[list[Loop], float]:
    if len(loop) == 3:
        return [loop], _triangle_quality(points[list(loop)], normal)
    if len(loop) == 4:
        whole = _least_sine(points[list(loop)], normal)
        if whole >= BLUNT:
            return [loop], whole
    best: tuple[list[Loop], float] = ([], -np.inf)
    for i in range(len(loop) if len(loop) > 4 else 2):
        ear = (loop[i - 1], loop[i], loop[(i + 1) % len(loop)])
        rest, quality = _split(tuple(k for k in loop if k != loop[i]), points, normal)
        quality = min(quality, _triangle_quality(points[list(ear)], normal))
        if quality > best[1]:
            best = ([*rest, ear], quality)
    return best


def _triangle_quality(corners: FloatArray, normal: FloatArray) -> float:
    sides = np.roll(corners, -1, axis=0) - corners
    area = 0.5 * float(np.cross(sides[0], sides[1]) @ normal)
    return float(4.0 * 3.0**0.5 * area / (sides**2).sum())


def _least_sine(corners: FloatArray, normal: FloatArray) -> float:
    after, before = np.roll(corners, -1, axis=0) - corners, np.roll(corners, 1, axis=0) - corners
    lengths = np.linalg.norm(after, axis=1) * np.linalg.norm(before, axis=1)
    return float((np.cross(after, before) @ normal / np.maximum(lengths, 1e-300)).min())
