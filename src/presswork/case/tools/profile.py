# SPDX-License-Identifier: Apache-2.0
"""The profile of a rigid tool: lines, arcs and fillets, its signed distance, and the side on which the metal is.

Segments have the form of model.Tool: x0, y0, x1, y1, centre x, centre y, turn; the left of a directed profile is free.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswork.case.solid.schema import ProfilePoint
from presswork.geometry.smooth import BulgeError, fit_smooth
from presswork.model import FloatArray

X0, X1, CENTRE, TURN = slice(0, 2), slice(2, 4), slice(4, 6), 6


MEETING = 1e-9
"""Of the profile's extent: how close its ends are when they meet."""
RELATIVE_TOLERANCE = 1e-5
"""Of the profile's extent: how far arcs may lie off a smooth curve, and how far apart the ends of a drawing's
pieces."""


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
    """Coefficient of friction of each segment, in the same way."""


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
    if len(points) > 3 and math.dist(points[0].to, points[-1].to) <= MEETING * max(_extent(points), 1e-300):
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
            raise ProfileError(corner, "a radius at the end of an open profile rounds nothing", "leave it out")
        fillets[corner] = _round_corner(pieces[corner], pieces[after], profile[corner].radius, corner)
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
        raise ProfileError(index, "it coincides with the point before", "leave one of them out")
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


def _round_corner(before: FloatArray, after: FloatArray, radius: float, corner: int) -> FloatArray:
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


def reverse_segments(segments: FloatArray) -> FloatArray:
    """Return the profile walked the other way."""
    reverse = segments[::-1].copy()
    reverse[:, X0], reverse[:, X1] = segments[::-1, X1], segments[::-1, X0]
    reverse[:, TURN] *= -1.0
    return reverse + 0.0  # no negative zeros


def sample_points(segments: FloatArray, per_arc: int = 64) -> FloatArray:
    """Return the ends of all segments, and points along the arcs, shape (n, 2)."""
    samples = [segments[:, X0], segments[:, X1]]
    for segment in segments[segments[:, TURN] != 0.0]:
        centre, turn = segment[CENTRE], segment[TURN]
        start, sweep = _arc_angles(segment)
        angles = start + turn * sweep * np.linspace(0.0, 1.0, per_arc)
        radius = np.linalg.norm(segment[X0] - centre)
        samples.append(centre + radius * np.column_stack((np.cos(angles), np.sin(angles))))
    return np.concatenate(samples)


def sample_arc(segment: FloatArray, tolerance: float) -> FloatArray:
    """Return points (n, 2) along a line or an arc, from its start to its end, whose chords follow it within a
    tolerance [mm].
    """
    if segment[TURN] == 0.0:
        return np.array([segment[X0], segment[X1]])
    radius = float(np.linalg.norm(segment[X0] - segment[CENTRE]))
    first, sweep = _arc_angles(segment)
    n = math.ceil(sweep / (2.0 * math.acos(max(0.0, 1.0 - tolerance / radius))))
    angles = first + segment[TURN] * sweep * np.linspace(0.0, 1.0, n + 1)
    points = segment[CENTRE] + radius * np.column_stack((np.cos(angles), np.sin(angles)))
    points[0], points[-1] = segment[X0], segment[X1]
    return points


def _arc_angles(segment: FloatArray) -> tuple[float, float]:
    """Return the angle of an arc's start and the angle swept from there in its turn, in (0, 2 pi]."""
    start, end = segment[X0] - segment[CENTRE], segment[X1] - segment[CENTRE]
    first = float(np.arctan2(start[1], start[0]))
    sweep = float(segment[TURN]) * (float(np.arctan2(end[1], end[0])) - first)
    sweep %= 2.0 * np.pi
    return first, sweep if sweep > 0.0 else 2.0 * np.pi


@dataclass(frozen=True)
class ProfileDistance:
    """Where points lie relative to a profile."""

    distance: FloatArray
    """Signed distance [mm], positive on the left, shape (n,)."""
    outwards: FloatArray
    """Unit vector to the left at the nearest point of the profile, shape (n, 2)."""
    beside: NDArray[np.bool_]
    """Whether the nearest point is not the end of an open profile, shape (n,), bool."""


def measure_distance(points: FloatArray, segments: FloatArray) -> ProfileDistance:
    """Return the signed distance of points, shape (n, 2), to the nearest point of a profile."""
    columns = [_distance_to_segment(points, segment) for segment in segments]
    n_segments = len(segments)
    closed = bool(np.allclose(segments[0, X0], segments[-1, X1], rtol=0.0, atol=1e-9))
    ends_of_profile = []
    for index in range(n_segments + (0 if closed else 1)):
        before = segments[index - 1] if index > 0 or closed else None
        after = segments[index] if index < n_segments else None
        columns.append(_distance_to_vertex(points, before, after))
        ends_of_profile.append(before is None or after is None)
    distances = np.stack([column[0] for column in columns], axis=1)
    outwards = np.stack([column[1] for column in columns], axis=1)
    nearest = np.argmin(np.abs(distances), axis=1)
    row = np.arange(len(points))
    is_end = np.array([False] * n_segments + ends_of_profile)
    return ProfileDistance(distances[row, nearest], outwards[row, nearest], ~is_end[nearest])


def _distance_to_segment(points: FloatArray, segment: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the signed distance to the inside of a segment (infinite beyond its ends) and the left normal there."""
    if segment[TURN] == 0.0:
        along = segment[X1] - segment[X0]
        length = np.linalg.norm(along)
        along = along / length
        normal = np.array([-along[1], along[0]])
        relative = points - segment[X0]
        position = relative @ along
        distance = np.where((position >= 0.0) & (position <= length), relative @ normal, np.inf)
        return distance, np.broadcast_to(normal, points.shape)
    relative = points - segment[CENTRE]
    from_centre = np.linalg.norm(relative, axis=1)
    first, sweep = _arc_angles(segment)
    angle = segment[TURN] * (np.arctan2(relative[:, 1], relative[:, 0]) - first) % (2.0 * np.pi)
    radius = np.linalg.norm(segment[X0] - segment[CENTRE])
    distance = np.where(angle <= sweep, segment[TURN] * (radius - from_centre), np.inf)
    normal = -segment[TURN] * relative / np.maximum(from_centre, 1e-300)[:, None]
    return distance, normal


def _distance_to_vertex(
    points: FloatArray, before: FloatArray | None, after: FloatArray | None
) -> tuple[FloatArray, FloatArray]:
    """Return the signed distance to a vertex, the side taken from the mean of its segments' normals."""
    normals = []
    if before is not None:
        vertex = before[X1]
        normals.append(_end_normal(before, vertex))
    if after is not None:
        vertex = after[X0]
        normals.append(_end_normal(after, vertex))
    mean = np.sum(normals, axis=0)
    size = np.linalg.norm(mean)
    mean = mean / size if size > 1e-12 else normals[0]
    relative = points - vertex
    side = np.where(relative @ mean >= 0.0, 1.0, -1.0)
    return side * np.linalg.norm(relative, axis=1), np.broadcast_to(mean, points.shape)


def _end_normal(segment: FloatArray, vertex: FloatArray) -> FloatArray:
    """Return the left unit normal of a segment at one of its ends."""
    if segment[TURN] == 0.0:
        along = segment[X1] - segment[X0]
        normal = np.array([-along[1], along[0]])
    else:
        normal = -segment[TURN] * (vertex - segment[CENTRE])
    return normal / np.linalg.norm(normal)  # type: ignore[no-any-return]
