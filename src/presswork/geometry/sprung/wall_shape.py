# SPDX-License-Identifier: Apache-2.0
"""Walls of a section before and after springback: angles with bottom and flange, and the radius of their curl."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.model import FloatArray

_STEEP, _FLAT = 60.0, 5.0
"""Inclinations [degree] as formed above which a piece is wall or radius, and below which bottom or flange."""
_ALIKE = 3.0
"""Inclination off the wall's median [degree] from which on a piece at its end belongs to the radius."""
_STRAIGHT = 1e3
"""Radius of a wall over its length from which on it counts as straight."""


@dataclass(frozen=True)
class WallShape:
    """One wall of a section; None where there is no bottom or flange beside it."""

    bottom_angle: float | None
    """Angle between bottom and the third of the wall beside it [degree], 90 for an upright wall."""
    flange_angle: float | None
    """Angle between the third of the wall beside the flange and the flange [degree]."""
    curl_radius: float
    """Radius of the whole wall by least squares [mm]; infinite if it is straight."""


def measure_walls(formed: FloatArray, free: FloatArray) -> tuple[tuple[WallShape, WallShape], ...]:
    """Return each wall of a section as formed and after springback.

    formed, free: ends of the same pieces in order, distance and height (n, 2, 2) [mm]. What lies before a wall counts
    as its bottom, what lies after it as its flange, each up to the neighbouring wall. A wall is a run of pieces
    steeper than 60 degrees as formed, without the radii at its ends. Angles and curl radius are those of the
    draw-bending benchmark (NUMISHEET '93): theta_1, theta_2 and rho.
    """
    along = formed[:, 1] - formed[:, 0]
    inclination = np.degrees(np.arctan2(np.abs(along[:, 1]), np.abs(along[:, 0])))
    walls = []
    ends = _find_walls(inclination)
    limits = [0, *(bound for wall in ends for bound in wall), len(inclination)]
    for number, (first, last) in enumerate(ends):
        flats = [(limits[2 * number], first), (last, limits[2 * number + 3])]  # as far as the neighbouring walls
        bottom, flange = (start + np.flatnonzero(inclination[start:end] < _FLAT) for start, end in flats)
        shapes = [_measure_wall(line, first, last, bottom, flange) for line in (formed, free)]
        walls.append((shapes[0], shapes[1]))
    return tuple(walls)


def _find_walls(inclination: FloatArray) -> list[tuple[int, int]]:
    """Return first and last + 1 of every wall of at least three pieces (n,) by their inclination [degree]."""
    ends = np.flatnonzero(np.diff(np.concatenate([[0], (inclination > _STEEP).astype(np.int8), [0]])))
    walls = []
    for first, last in ends.reshape(-1, 2).tolist():
        own = inclination[first:last]
        straight = first + np.flatnonzero(np.abs(own - np.median(own)) < _ALIKE)
        if len(straight) >= 3:
            walls.append((int(straight[0]), int(straight[-1]) + 1))
    return walls


def _measure_wall(line: FloatArray, first: int, last: int, bottom: np.ndarray, flange: np.ndarray) -> WallShape:
    """Measure the wall of the pieces first to last - 1 of lines (n, 2, 2) [mm]."""
    third = max((last - first) // 3, 1)
    beside_bottom, beside_flange = line[first : first + third], line[last - third : last]
    return WallShape(
        bottom_angle=_angle_between(line[bottom], beside_bottom) if len(bottom) else None,
        flange_angle=_angle_between(beside_flange, line[flange]) if len(flange) else None,
        curl_radius=_fit_radius(np.concatenate([line[first:last, 0], line[last - 1 : last, 1]])),
    )


def _angle_between(before: FloatArray, after: FloatArray) -> float:
    """Return the angle that two parts of a section enclose [degree], from the ends of their pieces (n, 2, 2)."""
    one, other = ((part[:, 1] - part[:, 0]).sum(axis=0) for part in (before, after))
    cosine = float(one @ other / (np.linalg.norm(one) * np.linalg.norm(other)))
    return 180.0 - float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))


def _fit_radius(points: FloatArray) -> float:
    """Return the radius of the circle through points (n, 2) by least squares [mm] (Pratt 1987).

    a (x^2 + z^2) + b x + c z + d has the least squares on the points under b^2 + c^2 - 4 a d = 1, which leaves lines
    among the circles. Under a = 1 a nearly straight wall whose points lie to both sides has a radius of its length.
    """
    centred = points - points.mean(axis=0)
    size = np.sqrt((centred**2).sum(axis=1).mean())
    x, z = (centred / size).T
    rows = np.column_stack([x**2 + z**2, x, z, np.ones_like(x)])
    constraint = np.array([[0.0, 0, 0, -2], [0, 1, 0, 0], [0, 0, 1, 0], [-2, 0, 0, 0]])
    squares, found = np.linalg.eig(np.linalg.solve(constraint, rows.T @ rows))
    square = np.where(squares.real > -1e-10 * np.abs(squares).max(), squares.real, np.inf)  # one other is below zero
    a, b, c, d = found[:, np.argmin(square)].real
    norm = np.sqrt(b**2 + c**2 - 4 * a * d)
    if 2 * abs(a) * np.ptp(centred, axis=0).max() / size < norm / _STRAIGHT:
        return float("inf")
    return float(size * norm / (2 * abs(a)))
