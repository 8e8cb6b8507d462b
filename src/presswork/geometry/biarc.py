# SPDX-License-Identifier: Apache-2.0
"""Smooth curves as chains of biarcs: two tangent arcs that meet a curve's ends and its tangents there.

Source: Bolton (1975), Biarc curves, Computer-Aided Design 7, 89-92; of the biarcs between two ends the one whose
control legs are equally long is taken. Segments have the form of model.Tool.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from presswork.model import FloatArray

Evaluate = Callable[[FloatArray], FloatArray]

STRAIGHT = 1e-7
"""Half the turn [rad] below which an arc is a line."""
_SAMPLES = np.linspace(0.0, 1.0, 18)[1:-1]
_MOST_HALVINGS = 14


class CurveError(Exception):
    """A curve that arcs cannot follow; the message names the place."""


@dataclass(frozen=True)
class Curve:
    """A parametric plane curve, smooth inside each of its spans."""

    point: Evaluate
    """Parameters (n,) to points (n, 2) [mm]."""
    tangent: Callable[[float, float], FloatArray]
    """Unit tangent (2,) at a parameter, of the side on which the other one lies."""


def fit_biarcs(curve: Curve, start: float, end: float, tolerance: float) -> list[FloatArray]:
    """Return lines and arcs, each (7,), that follow the curve between two parameters within `tolerance` [mm].

    Consecutive pieces are tangent. An interval is halved until 16 points on it lie within the tolerance of its biarc.
    Raises CurveError where that does not succeed.
    """
    return _fit(curve, start, end, tolerance, _MOST_HALVINGS)


def _fit(curve: Curve, start: float, end: float, tolerance: float, halvings: int) -> list[FloatArray]:
    points = curve.point(start + (end - start) * np.concatenate(([0.0], _SAMPLES, [1.0])))
    biarc = _make_biarc(points[0], curve.tangent(start, end), points[-1], curve.tangent(end, start))
    if biarc and max_deviation(points[1:-1], biarc) <= tolerance:
        return biarc
    if halvings == 0:
        x, y = points[len(points) // 2]
        raise CurveError(f"arcs do not follow the curve at ({x:.6g}, {y:.6g}): it turns too sharply there")
    middle = 0.5 * (start + end)
    before = _fit(curve, start, middle, tolerance, halvings - 1)
    return before + _fit(curve, middle, end, tolerance, halvings - 1)


def _make_biarc(start: FloatArray, leave: FloatArray, end: FloatArray, arrive: FloatArray) -> list[FloatArray]:
    """Return the two arcs from `start` in the direction `leave` to `end` in the direction `arrive`; empty if none."""
    chord = end - start
    along = float(chord @ (leave + arrive))
    square = float(chord @ chord)
    if along <= 0.0 or square == 0.0:
        return []
    # legs d with |end - d arrive - start - d leave| = 2 d, written so that nothing cancels when the tangents agree
    leg = square / (along + np.sqrt(along**2 + 2.0 * (1.0 - float(leave @ arrive)) * square))
    joint = 0.5 * (start + end + leg * (leave - arrive))
    return [make_arc(start, leave, joint), reverse_segment(make_arc(end, -arrive, joint))]


def make_arc(start: ArrayLike, tangent: ArrayLike, end: ArrayLike) -> FloatArray:
    """Return the arc, or line, (7,) that leaves `start` along a unit tangent and ends at `end`."""
    first, direction, last = (np.asarray(value, dtype=np.float64) for value in (start, tangent, end))
    chord = last - first
    normal = np.array([-direction[1], direction[0]])
    aside, ahead = float(chord @ normal), float(chord @ direction)
    if abs(np.arctan2(aside, ahead)) < STRAIGHT:
        return np.array([*first, *last, 0.0, 0.0, 0.0])
    centre = first + normal * (float(chord @ chord) / (2.0 * aside))
    return np.array([*first, *last, *centre, np.sign(aside)])


def reverse_segment(segment: FloatArray) -> FloatArray:
    """Return a segment (7,) in the opposite direction."""
    turn = -segment[6] + 0.0
    return np.array([*segment[2:4], *segment[0:2], *segment[4:6], turn])


def max_deviation(points: FloatArray, segments: Sequence[FloatArray]) -> float:
    """Return the largest distance of points (n, 2) from a chain of segments [mm]."""
    nearest = np.full(len(points), np.inf)
    for segment in segments:
        nearest = np.minimum(nearest, _distance(points, segment))
    return float(nearest.max(initial=0.0))


def _distance(points: FloatArray, segment: FloatArray) -> FloatArray:
    """Return the distance of points (n, 2) from a segment; arcs of less than half a turn."""
    start, end, centre = segment[0:2], segment[2:4], segment[4:6]
    chord = end - start
    fraction = (points - start) @ chord / (chord @ chord)
    if segment[6] == 0.0:
        foot = start + np.clip(fraction, 0.0, 1.0)[:, None] * chord
        return np.asarray(np.linalg.norm(points - foot, axis=1))
    relative = points - centre
    radius = float(np.linalg.norm(start - centre))
    first, last = start - centre, end - centre
    turn = segment[6]
    beside = (turn * _cross(first, relative) >= 0.0) & (turn * _cross(relative, last) >= 0.0)
    to_arc = np.abs(np.linalg.norm(relative, axis=1) - radius)
    to_ends = np.minimum(np.linalg.norm(points - start, axis=1), np.linalg.norm(points - end, axis=1))
    return np.asarray(np.where(beside, to_arc, to_ends))


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
