# SPDX-License-Identifier: Apache-2.0
"""The profile of a rigid tool: lines, arcs and fillets.

Segments have the form of model.Tool: x0, y0, x1, y1, centre x, centre y, turn; the left of a directed profile is free.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from presswork.case.plane.tool import ProfilePoint
from presswork.geometry.segments import TURN, X0, X1
from presswork.geometry.smooth import BulgeError, fit_smooth
from presswork.model import FloatArray

MEETING = 1e-9
"""How close its ends are when they meet, over the profile's extent."""
RELATIVE_TOLERANCE = 1e-5
"""How far arcs may lie off a smooth curve, and ends of a drawing's pieces apart, over the profile's extent."""


class ProfileError(Exception):
    """A profile that cannot be drawn: the index of the point at fault, what is wrong, and the remedy."""

    def __init__(self, point: int, fault: str, remedy: str) -> None:
        self.point = point
        self.fault = fault
        self.remedy = remedy
        super().__init__(f"point {point}: {fault}; {remedy}")


@dataclass(frozen=True)
class Outline:
    """A profile as drawn."""

    segments: FloatArray
    """Shape (n_segments, 7), in the form of model.Tool [mm]."""
    pieces: tuple[str, ...]
    """What the user calls the piece that each segment belongs to."""
    m: FloatArray
    """Friction factor of each segment, shape (n_segments,); NaN where the tool's holds."""
    mu: FloatArray
    """Coefficient of friction of each segment, in the same order."""


def draw_outline(
    profile: Sequence[ProfilePoint],
    closed: bool,
    *,
    spline: bool = False,
    corner_angle: float = 30.0,
    tolerance: float | None = None,
    names: Sequence[str] | None = None,
) -> Outline:
    """Draw a profile through points; a profile whose ends meet is closed.

    spline: a smooth curve between corners sharper than corner_angle [degrees], in arcs that follow it within
    `tolerance` [mm], without it RELATIVE_TOLERANCE of the profile's extent. names: what the user calls the points.
    Raises ProfileError.
    """
    points = list(profile)
    names = names or [f"point {index}" for index in range(len(points))]
    if len(points) > 2 and math.dist(points[0].to, points[-1].to) <= MEETING * max(_extent(points), 1e-300):
        first, last = points[0], points.pop()
        points[0] = last.model_copy(update={"to": first.to, "radius": max(first.radius, last.radius)})
        closed = True
    if not closed and (points[0].m is not None or points[0].mu is not None):
        raise ProfileError(0, "no piece ends at the first point of an open profile", "give m or mu at the next point")
    if spline:
        segments, owner = _draw_spline(points, closed, corner_angle, tolerance or RELATIVE_TOLERANCE * _extent(points))
    else:
        segments, owner = _draw_pieces(points, closed)
    pieces = tuple(f"the piece that ends at {names[index]}" for index in owner)
    m = np.array([np.nan if points[index].m is None else points[index].m for index in owner], dtype=np.float64)
    mu = np.array([np.nan if points[index].mu is None else points[index].mu for index in owner], dtype=np.float64)
    return Outline(segments, pieces, m, mu)


def _extent(points: Sequence[ProfilePoint]) -> float:
    """Return the diagonal of the box round points [mm]."""
    return float(np.linalg.norm(np.ptp([point.to for point in points], axis=0)))


def _draw_spline(
    points: Sequence[ProfilePoint], closed: bool, corner_angle: float, tolerance: float
) -> tuple[FloatArray, list[int]]:
    """Return the segments of a smooth profile, and the index of the point at the end of each one's span."""
    for index in range(0 if closed else 1, len(points)):
        if points[index].to == points[index - 1].to:
            raise ProfileError(index, "it coincides with the point before", "leave one of them out")
    try:
        smooth = fit_smooth(np.array([point.to for point in points]), closed, corner_angle, tolerance)
    except BulgeError as error:
        remedy = 'add points there (three or more make a straight piece), or set curve = "polyline"'
        raise ProfileError(error.point, error.fault, remedy) from error
    return smooth.segments, smooth.owner.tolist()


def _draw_pieces(profile: Sequence[ProfilePoint], closed: bool) -> tuple[FloatArray, list[int]]:
    """Return the lines, arcs and fillets of a profile, and the index of the point that each belongs to."""
    points = [np.array(point.to) for point in profile]
    n_points = len(points)
    ends = list(range(0 if closed else 1, n_points))  # the piece that ends at point i starts at point i - 1
    pieces = {end: _piece(points[end - 1], points[end], profile[end], end) for end in ends}
    fillets: dict[int, FloatArray] = {}
    for corner in range(n_points):
        if profile[corner].radius == 0.0:
            continue
        after = (corner + 1) % n_points
        if corner not in pieces or after not in pieces:
            raise ProfileError(corner, "a radius at the end of an open profile rounds nothing", "leave the radius out")
        fillets[corner] = round_corner(pieces[corner], pieces[after], profile[corner].radius, corner)
    rows: list[FloatArray] = []
    owner: list[int] = []
    for end in ends:
        if np.linalg.norm(pieces[end][X1] - pieces[end][X0]) > 1e-12 or pieces[end][TURN] != 0.0:
            rows.append(pieces[end])
        if end in fillets:
            rows.append(fillets[end])
        owner += [end] * (len(rows) - len(owner))
    return np.array(rows), owner


def _piece(start: FloatArray, end: FloatArray, point: ProfilePoint, index: int) -> FloatArray:
    """Make the line or arc from one point of the profile to the next."""
    length = float(np.linalg.norm(end - start))
    if length == 0.0:
        remedy = "leave one of them out" if point.centre is None else "draw a circle as two arcs, by the point opposite"
        raise ProfileError(index, "it coincides with the point before", remedy)
    if point.centre is None:
        return np.array([*start, *end, 0.0, 0.0, 0.0])
    centre = np.array(point.centre)
    radius = float(np.linalg.norm(start - centre))
    if abs(radius - np.linalg.norm(end - centre)) > 1e-3 * radius or radius == 0.0:
        raise ProfileError(
            index,
            f"the arc's ends are {radius:.6g} and {np.linalg.norm(end - centre):.6g} mm from its centre",
            "mend the centre, so that both distances are the radius",
        )
    chord = (end - start) / length  # rounded input: move the centre onto the chord's bisector
    centre = centre - chord * ((centre - 0.5 * (start + end)) @ chord)
    return np.array([*start, *end, *centre, 1.0 if point.turn == "left" else -1.0])


def round_corner(before: FloatArray, after: FloatArray, radius: float, corner: int) -> FloatArray:
    """Return the fillet arc at the corner between two lines, and shorten the lines to its ends in place."""
    if before[TURN] != 0.0 or after[TURN] != 0.0:
        raise ProfileError(corner, "a radius beside an arc is not known", "round corners between two lines only")
    point = before[X1].copy()
    length_before = float(np.linalg.norm(point - before[X0]))
    length_after = float(np.linalg.norm(after[X1] - point))
    into, out = (point - before[X0]) / length_before, (after[X1] - point) / length_after
    sine = float(into[0] * out[1] - into[1] * out[0])
    angle = float(np.arctan2(sine, into @ out))
    if abs(sine) < 1e-9:
        raise ProfileError(corner, "a radius where the profile does not turn", "leave the radius out")
    tangent = radius * np.tan(0.5 * abs(angle))
    if tangent > min(length_before, length_after) * (1.0 + 1e-12):
        most = min(length_before, length_after) / np.tan(0.5 * abs(angle))
        raise ProfileError(
            corner, f"the radius of {radius:.6g} mm is too large for the lines beside it", f"at most {most:.6g} mm fits"
        )
    turn = float(np.sign(sine))
    start, end = point - tangent * into, point + tangent * out
    centre = start + turn * radius * np.array([-into[1], into[0]])
    before[X1], after[X0] = start, end
    return np.array([*start, *end, *centre, turn])
