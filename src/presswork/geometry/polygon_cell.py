# SPDX-License-Identifier: Apache-2.0
"""A cell as a polygon: its pieces of good shape, its normal, where a place lies in it."""

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


def find_normal(corners: FloatArray) -> FloatArray:
    """Return the unit normal of a cell (k, 3)."""
    centred = corners - corners.mean(axis=0)
    normal = np.cross(centred, np.roll(centred, -1, axis=0)).sum(axis=0)
    return np.asarray(normal / max(float(np.linalg.norm(normal)), 1e-300))


def find_weights(corners: FloatArray, place: FloatArray) -> FloatArray | None:
    """Return the weights of a cell's corners (k, 2) at a place in it (2,); None outside."""
    if len(corners) == 3:
        a, b = corners[1] - corners[0], corners[2] - corners[0]
        r, s = np.linalg.lstsq(np.column_stack([a, b]), place - corners[0], rcond=None)[0]
        weights = np.array([1 - r - s, r, s])
    else:
        natural = np.zeros(2)
        for _ in range(20):  # Newton's method on the bilinear map
            x, y = natural
            shape = 0.25 * np.array([(1 - x) * (1 - y), (1 + x) * (1 - y), (1 + x) * (1 + y), (1 - x) * (1 + y)])
            slopes = 0.25 * np.array([[y - 1, 1 - y, 1 + y, -1 - y], [x - 1, -1 - x, 1 + x, 1 - x]])
            jacobian = (slopes @ corners).T
            if abs(float(np.linalg.det(jacobian))) < 1e-12 * float(np.ptp(corners, axis=0).max()) ** 2:
                return None
            natural = np.clip(natural + np.linalg.solve(jacobian, place - shape @ corners), -2.0, 2.0)
        x, y = natural
        weights = 0.25 * np.array([(1 - x) * (1 - y), (1 + x) * (1 - y), (1 + x) * (1 + y), (1 - x) * (1 + y)])
    return (
        weights
        if weights.min() >= -1e-9 and np.abs(weights @ corners - place).max() < 1e-9 * (1 + np.abs(corners).max())
        else None
    )
