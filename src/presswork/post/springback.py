# SPDX-License-Identifier: Apache-2.0
"""Springback of a section: angles of the wall with bottom and flange, and the radius of its curl."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.model import FloatArray
from presswork.post.section import SheetSection, cut_sheet
from presswork.results import Result, ResultError

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
    """Between bottom and the third of the wall beside it [degree], 90 for an upright wall."""
    flange_angle: float | None
    """Between the third of the wall beside the flange and the flange [degree]."""
    curl_radius: float
    """Radius of the whole wall by least squares [mm]; infinite if it is straight."""


@dataclass(frozen=True)
class SectionSpringback:
    """A section before and after springback."""

    formed: SheetSection
    free: SheetSection
    walls: tuple[tuple[WallShape, WallShape], ...]
    """Each wall from the beginning of the section outwards, as formed and after springback."""


def find_formed_step(result: Result, step: int = -1) -> int:
    """Return the last step before springback that has the mesh of `step`. Raises ResultError without one."""
    last = step % len(result.times)
    mesh = result.mesh_at(last)
    if "springback" in result.field_names and result.field("springback", last).any():
        for before in range(last - 1, -1, -1):
            if result.mesh_at(before) is not mesh:
                break
            if not result.field("springback", before).any():
                return before
    raise ResultError(f"{result.folder} has no step before and after springback on one mesh")


def measure_springback(
    result: Result, angle: float = 0.0, step: int = -1, *, start: tuple[float, float] = (0.0, 0.0)
) -> SectionSpringback:
    """Measure the walls of the section from `start` (x, y) [mm] at an angle from x [rad], formed and at `step`.

    A wall is a run of pieces of the sheet steeper than 60 degrees as formed, without the radii at its ends. Angles and
    curl radius are those of the draw-bending benchmark (NUMISHEET '93): theta_1, theta_2 and rho. Raises ResultError if
    nothing has sprung back.
    """
    formed = cut_sheet(result, angle, find_formed_step(result, step), start=start)
    free = cut_sheet(result, angle, step, start=start)
    if len(formed.way) != len(free.way):
        raise ResultError(f"{result.folder}: the section does not cut the same sheet before and after springback")
    along = formed.line[:, 1] - formed.line[:, 0]
    inclination = np.degrees(np.arctan2(np.abs(along[:, 1]), np.abs(along[:, 0])))
    walls = []
    for first, last in _find_walls(inclination):
        flats = [inclination[:first] < _FLAT, inclination[last:] < _FLAT]
        bottom, flange = np.flatnonzero(flats[0]), last + np.flatnonzero(flats[1])
        shapes = [_measure_wall(section.line, first, last, bottom, flange) for section in (formed, free)]
        walls.append((shapes[0], shapes[1]))
    return SectionSpringback(formed, free, tuple(walls))


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
