# SPDX-License-Identifier: Apache-2.0
"""Closed forms of signed distances, and surfaces to compare with them."""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def line(start: tuple[float, float], end: tuple[float, float]) -> list[float]:
    return [*start, *end, 0.0, 0.0, 0.0]


def clockwise(start: tuple[float, float], end: tuple[float, float], centre: tuple[float, float]) -> list[float]:
    return [*start, *end, *centre, -1.0]


def counter_clockwise(start: tuple[float, float], end: tuple[float, float], centre: tuple[float, float]) -> list[float]:
    return [*start, *end, *centre, 1.0]


def box_distance(points: FloatArray, half: tuple[float, float, float], radius: float = 0.0) -> FloatArray:
    """Signed distance from a box of half widths `half`, its edges and corners rounded."""
    q = np.abs(points) - (np.array(half) - radius)
    return np.linalg.norm(np.maximum(q, 0.0), axis=1) + np.minimum(q.max(axis=1), 0.0) - radius


def box_triangles(half: tuple[float, float, float]) -> tuple[FloatArray, NDArray[np.int32]]:
    """A box of twelve triangles, seen counter-clockwise from outside."""
    points = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], dtype=float) * half
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return points, np.array(triangles, dtype=np.int32)


def height_field(n: int, size: float, height: float) -> tuple[FloatArray, NDArray[np.int32]]:
    """An open bumpy surface of 2 n^2 triangles over a square, metal below."""
    x = np.linspace(-size, size, n + 1)
    grid = np.array(np.meshgrid(x, x, indexing="ij")).reshape(2, -1).T
    z = height * np.sin(1.7 * grid[:, 0]) * np.cos(1.3 * grid[:, 1])
    i, j = (k.ravel() for k in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    a, b, c, d = i * (n + 1) + j, (i + 1) * (n + 1) + j, (i + 1) * (n + 1) + j + 1, i * (n + 1) + j + 1
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])]).astype(np.int32)
    return np.column_stack([grid, z]), triangles


def distance_to_triangles(x: FloatArray, points: FloatArray, triangles: NDArray[np.int32]) -> float:
    """Distance of one point by trying every triangle: its plane where the foot lies inside, else its three sides."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    height = ((x - a) * normal).sum(axis=1)
    foot = x - height[:, None] * normal
    inside = np.ones(len(a), dtype=bool)
    best = np.full(len(a), np.inf)
    for p, q in ((a, b), (b, c), (c, a)):
        inside &= (np.cross(q - p, foot - p) * normal).sum(axis=1) >= 0.0
        f = np.clip(((x - p) * (q - p)).sum(axis=1) / ((q - p) ** 2).sum(axis=1), 0.0, 1.0)
        best = np.minimum(best, np.linalg.norm(x - p - f[:, None] * (q - p), axis=1))
    return float(np.where(inside, np.abs(height), best).min())
