# SPDX-License-Identifier: Apache-2.0
"""Closed polygons in the plane: what lies inside, how far away, where edges cross them."""

from __future__ import annotations

import numpy as np

from presswork.model import BoolArray, FloatArray

_AT_ONCE = 4096
"""Pairs of points and sides that are computed together; more of them fall out of the cache."""
_AT_A_TIME = 200_000
"""Pairs of points and sides held in memory."""


def list_sides(polygon: FloatArray) -> FloatArray:
    """Return the sides (m, 2, 2): start and end."""
    return np.stack([polygon, np.roll(polygon, -1, axis=0)], axis=1)


def contains(sides: FloatArray, points: FloatArray) -> BoolArray:
    """Return which points (n, 2) lie inside the closed loops of sides (m, 2, 2): a ray along x meets an odd number."""
    inside = np.zeros(len(points), dtype=bool)
    x, y = points.T
    sides = sides[sides[:, 0, 1] != sides[:, 1, 1]]
    count = max(1, _AT_ONCE // max(len(points), 1))
    for first in range(0, len(sides), count):
        (x0, y0), (x1, y1) = np.moveaxis(sides[first : first + count, :, :, None], 0, 2)
        met = ((y0 > y) != (y1 > y)) & (x < x0 + (y - y0) * ((x1 - x0) / (y1 - y0)))
        inside ^= np.logical_xor.reduce(met, axis=0)
    return inside


def measure_distance(sides: FloatArray, points: FloatArray) -> FloatArray:
    """Return the distance of points (n, 2) to the nearest of sides (m, 2, 2) (n,) [mm]."""
    start, along = sides[:, 0], sides[:, 1] - sides[:, 0]
    square = np.maximum((along**2).sum(axis=1), 1e-300)
    nearest = np.full(len(points), np.inf)
    rows = max(1, _AT_A_TIME // len(sides))
    for first in range(0, len(points), rows):
        away = points[first : first + rows, None] - start
        part = np.clip((away * along).sum(axis=2) / square, 0.0, 1.0)
        nearest[first : first + rows] = ((away - part[..., None] * along) ** 2).sum(axis=2).min(axis=1)
    return np.asarray(np.sqrt(nearest))


def sample_sides(sides: FloatArray, spacing: float) -> FloatArray:
    """Return points along sides (m, 2, 2), both ends of each among them, no farther apart than `spacing` (n, 2)."""
    samples = []
    for start, end in sides:
        n = int(np.ceil(np.linalg.norm(end - start) / spacing)) + 1
        samples.append(start + np.linspace(0.0, 1.0, max(n, 2))[:, None] * (end - start))
    return np.concatenate(samples)


def find_crossings(sides: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    """Return the part of each edge, from start (n, 2) to end (n, 2), after which it first meets one of sides.

    NaN where it meets none.
    """
    first = np.full(len(start), np.nan)
    along = end - start
    for a, b in sides:
        side = b - a
        sine = along[:, 0] * side[1] - along[:, 1] * side[0]
        meets = np.abs(sine) > 1e-14 * np.linalg.norm(along, axis=1) * np.linalg.norm(side)
        safe = np.where(meets, sine, 1.0)
        away = a - start
        part = (away[:, 0] * side[1] - away[:, 1] * side[0]) / safe
        on_side = (away[:, 0] * along[:, 1] - away[:, 1] * along[:, 0]) / safe
        meets &= (part >= -1e-12) & (part <= 1 + 1e-12) & (on_side >= -1e-12) & (on_side <= 1 + 1e-12)
        first = np.where(meets, np.fmin(first, part), first)
    return np.asarray(np.clip(first, 0.0, 1.0))


def polygon_area(polygon: FloatArray) -> float:
    """Return the signed area of a polygon (m, 2) [mm2], positive where it runs counter-clockwise."""
    x, y = polygon.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def find_corners(polygon: FloatArray, sharp: float, tight: float, window: float) -> FloatArray:
    """Return the corners (n, 2) of a polygon (m, 2).

    They are the points where it turns by more than `sharp` [rad], and the middles of bends that turn by more than
    `tight` within a length `window` [mm], none of which lies in another one's window.
    """
    into = polygon - np.roll(polygon, 1, axis=0)
    out = np.roll(polygon, -1, axis=0) - polygon
    turn = np.arctan2(into[:, 0] * out[:, 1] - into[:, 1] * out[:, 0], (into * out).sum(axis=1))
    length = np.linalg.norm(out, axis=1)
    at, whole = np.cumsum(length) - length, float(length.sum())
    ahead = (at - at[:, None] + 0.5 * whole) % whole - 0.5 * whole
    within = np.abs(ahead) <= 0.5 * window
    bend = np.abs(within @ turn)
    lopsided = np.abs((within * ahead) @ turn) / window  # zero in the middle of a bend
    corners = np.flatnonzero(np.abs(turn) > sharp).tolist()
    for i in np.argsort(lopsided - bend).tolist():
        if bend[i] > tight and not within[i, corners].any():
            corners.append(i)
    return np.asarray(polygon[sorted(corners)])
