# SPDX-License-Identifier: Apache-2.0
"""A smooth profile through points: cubic splines between corners, as tangent arcs.

A point where the chords turn by more than the corner angle is a corner. Three points or more on one line make a
straight piece. What lies between is a cubic spline over the chord length (twice continuously differentiable,
not-a-knot at free ends, tangent to a straight piece beside it, periodic for a closed curve without corners).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
import scipy

from presswork.geometry.biarc import Curve, CurveError, fit_biarcs
from presswork.model import BoolArray, FloatArray, IndexArray

ON_LINE = 1e-7
"""Largest distance of points of a straight piece from its line, over the extent of the points."""
BULGE = 3.0
"""Largest bulge of a span, over that of an arc with the same turn."""
LEAST_BULGE = 1e-3
"""Bulge that is always accepted, over the extent of the points."""


class BulgeError(Exception):
    """A spline that swings out between two points: the index of the point at the span's end, and what is wrong."""

    def __init__(self, point: int, fault: str) -> None:
        self.point = point
        self.fault = fault
        super().__init__(fault)


@dataclass(frozen=True)
class Smooth:
    """Lines and arcs through points."""

    segments: FloatArray
    """Shape (n_segments, 7), in the form of model.Tool."""
    owner: IndexArray
    """Index of the point at the end of the span that each segment belongs to, shape (n_segments,)."""


def fit_smooth(points: FloatArray, closed: bool, corner_angle: float, tolerance: float) -> Smooth:
    """Return the smooth curve through points.

    points: (n_points, 2) [mm], no two neighbours alike; closed: from the last to the first, too. corner_angle: turn
    [degrees] above which a point stays a corner. tolerance: of the arcs from the spline [mm]. Raises BulgeError.
    """
    n_points = len(points)
    if n_points == 2 and not closed:
        return Smooth(np.array([[*points[0], *points[1], 0.0, 0.0, 0.0]]), np.array([1]))
    turns = _find_turns(points, closed)
    is_corner = np.abs(turns) > np.radians(corner_angle)
    extent = float(np.linalg.norm(np.ptp(points, axis=0)))
    order, before = _arrange(points, closed, is_corner, ON_LINE * extent)
    path = points[order]
    corners = np.flatnonzero(is_corner[order[1:-1]]) + 1
    runs: list[Run] = []
    if isinstance(before, str):
        runs.append(_spline(path, before))
    else:
        for start, end in pairwise([0, *corners.tolist(), len(order) - 1]):
            runs += _split_run(path[start : end + 1], before if start == 0 else None, ON_LINE * extent)
    rows: list[FloatArray] = []
    owner: list[int] = []
    spans = iter(pairwise(order.tolist()))
    for curve, knots in runs:
        for begin, finish in pairwise(knots.tolist()):
            first, last = next(spans)
            if curve is None:
                pieces = [np.array([*points[first], *points[last], 0.0, 0.0, 0.0])]
            else:
                _check_bulge(curve, begin, finish, np.abs(turns[[first, last]]), last, extent)
                pieces = _fit_span(curve, begin, finish, tolerance, last)
            rows += pieces
            owner += [last] * len(pieces)
    return Smooth(np.array(rows), np.array(owner))


def _arrange(
    points: FloatArray, closed: bool, is_corner: BoolArray, tolerance: float
) -> tuple[IndexArray, FloatArray | Literal["periodic"] | None]:
    """Return the points' order along the path, and what comes before its start.

    A closed path begins at a corner, or else, in the direction that is returned, behind a straight piece; without
    either it is periodic.
    """
    order = np.arange(len(points))
    if not closed:
        return order, None
    if is_corner.any():
        order = np.roll(order, -int(np.flatnonzero(is_corner)[0]))
        return np.append(order, order[0]), None
    twice = np.concatenate([order, order, order[:1]])  # so that a straight piece over the seam is seen
    straight = _find_straight(points[twice], tolerance).reshape(2, -1).any(axis=0)
    ends = np.flatnonzero(np.roll(straight, 1) & ~straight)
    if len(ends) == 0:
        return np.append(order, order[0]), "periodic"
    order = np.roll(order, -int(ends[0]))
    return np.append(order, order[0]), points[order[0]] - points[order[-1]]


def _fit_span(curve: Curve, start: float, end: float, tolerance: float, point: int) -> list[FloatArray]:
    try:
        return fit_biarcs(curve, start, end, tolerance)
    except CurveError as error:
        raise BulgeError(point, str(error)) from error


def _find_turns(points: FloatArray, closed: bool) -> FloatArray:
    """Return the angle [rad] by which the chords turn at each point; at an open end that of its neighbour."""
    before = points - np.roll(points, 1, axis=0)
    after = np.roll(points, -1, axis=0) - points
    turns = np.arctan2(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0], np.sum(before * after, axis=1))
    if not closed:
        turns[0], turns[-1] = turns[1], turns[-2]
    return np.asarray(turns)


Run = tuple[Curve | None, FloatArray]
"""A curve, None for straight pieces, and its parameters at the points."""


def _find_straight(path: FloatArray, tolerance: float) -> BoolArray:
    """Mark the spans of a path that belong to a straight piece of three points or more."""
    straight = np.zeros(len(path) - 1, dtype=bool)
    start = 0
    while start < len(path) - 2:
        end = start + 1
        while end + 1 < len(path) and _is_on_line(path[start : end + 2], tolerance):
            end += 1
        if end - start > 1:
            straight[start:end] = True
            start = end
        else:
            start += 1
    return straight


def _is_on_line(points: FloatArray, tolerance: float) -> bool:
    chord = points[-1] - points[0]
    length = np.linalg.norm(chord)
    if length == 0.0:
        return False
    off = (points - points[0]) @ np.array([-chord[1], chord[0]]) / length
    return bool(np.abs(off).max() <= tolerance)


def _split_run(path: FloatArray, before: FloatArray | None, tolerance: float) -> list[Run]:
    """Split the points between two corners into straight pieces and splines tangent to them.

    before: the direction in which the path is entered, if it is tangent there.
    """
    straight = _find_straight(path, tolerance) if len(path) > 2 else np.array([before is None])
    edges = [0, *(np.flatnonzero(np.diff(straight)) + 1).tolist(), len(straight)]
    runs: list[Run] = []
    for start, end in pairwise(edges):
        if straight[start]:
            runs.append((None, np.arange(end - start + 1.0)))
            continue
        enter = path[start] - path[start - 1] if start > 0 else before
        leave = path[end + 1] - path[end] if end < len(straight) else None
        runs.append(_spline(path[start : end + 1], enter, leave))
    return runs


def _spline(path: FloatArray, before: FloatArray | str | None, after: FloatArray | None = None) -> Run:
    """Return the cubic spline through points: "periodic", or tangent to the directions before and after it."""
    knots = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))))
    if isinstance(before, str):
        spline = scipy.interpolate.CubicSpline(knots, path, bc_type=before)
    else:
        free = "not-a-knot" if len(path) > 2 else "natural"
        ends = [free if d is None else (1, d / np.linalg.norm(d)) for d in (before, after)]
        spline = scipy.interpolate.CubicSpline(knots, path, bc_type=(ends[0], ends[1]))

    def tangent(at: float, _: float) -> FloatArray:
        slope = spline(at, 1)
        return np.asarray(slope / np.linalg.norm(slope))

    return Curve(lambda at: np.asarray(spline(at)), tangent), knots


def _check_bulge(curve: Curve, start: float, end: float, turns: FloatArray, point: int, extent: float) -> None:
    """Refuse a span that bulges far more than its points' turns explain: a long span beside short ones."""
    points = curve.point(np.linspace(start, end, 18))
    chord = points[-1] - points[0]
    length = float(np.linalg.norm(chord))
    bulge = float(np.abs((points - points[0]) @ np.array([-chord[1], chord[0]])).max()) / length
    if bulge > max(BULGE * length * float(turns.sum()) / 16.0, LEAST_BULGE * extent):
        raise BulgeError(
            point, f"the curve through the points swings out by {bulge:.3g} mm in the {length:.6g} mm before it"
        )
