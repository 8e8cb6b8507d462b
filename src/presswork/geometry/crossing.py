# SPDX-License-Identifier: Apache-2.0
"""Find where a profile of lines and arcs crosses or touches itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.model import FloatArray

TOUCHING = 1e-9
"""Distance below which two pieces touch, over the profile's extent."""


@dataclass(frozen=True)
class Crossing:
    """Two segments of a profile that meet where they should not."""

    first: int
    second: int
    point: FloatArray
    """Where, shape (2,) [mm]."""


def find_crossing(segments: FloatArray) -> Crossing | None:
    """Return the first place along the profile (n_segments, 7) where it crosses or touches itself, if any.

    Neighbours share the point between them and must not meet again; nor may one fold back onto the other.
    """
    low, high = _bound(segments)
    extent = float(np.linalg.norm(high.max(axis=0) - low.min(axis=0)))
    tolerance = TOUCHING * extent
    low, high = low - tolerance, high + tolerance
    n_segments = len(segments)
    closed = np.linalg.norm(segments[-1, 2:4] - segments[0, 0:2]) <= tolerance
    for i in range(n_segments):
        near = ((low[i + 1 :] <= high[i]) & (high[i + 1 :] >= low[i])).all(axis=1)
        for j in (np.flatnonzero(near) + i + 1).tolist():
            shared = [segments[i, 2:4]] if j == i + 1 else []
            if closed and i == 0 and j == n_segments - 1:
                shared.append(segments[i, 0:2])
            for point in _meet(segments[i], segments[j], tolerance):
                if all(np.linalg.norm(point - vertex) > 10.0 * tolerance for vertex in shared):
                    return Crossing(i, j, point)
    return None


def bound_segments(segments: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the lower and the upper corner of the box round all segments (n_segments, 7), each (2,) [mm]."""
    low, high = _bound(segments)
    return np.asarray(low.min(axis=0)), np.asarray(high.max(axis=0))


def _bound(segments: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the corners of the boxes round each segment, both (n_segments, 2)."""
    low, high = np.minimum(segments[:, 0:2], segments[:, 2:4]), np.maximum(segments[:, 0:2], segments[:, 2:4])
    for i in np.flatnonzero(segments[:, 6]).tolist():
        segment = segments[i]
        centre, radius = segment[4:6], float(np.linalg.norm(segment[0:2] - segment[4:6]))
        for direction in np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]]):
            part = segment.copy()
            part[2:4] = centre + radius * direction
            if _sweep(part) <= _sweep(segment):
                low[i], high[i] = np.minimum(low[i], part[2:4]), np.maximum(high[i], part[2:4])
    return low, high


def _sweep(segment: FloatArray) -> float:
    """Return the angle that an arc sweeps, in (0, 2 pi]; 0 for a line."""
    if segment[6] == 0.0:
        return 0.0
    start, end = segment[0:2] - segment[4:6], segment[2:4] - segment[4:6]
    turned = float(segment[6] * np.arctan2(start[0] * end[1] - start[1] * end[0], start @ end))
    return turned if turned > 0.0 else turned + 2.0 * np.pi


def _meet(a: FloatArray, b: FloatArray, tolerance: float) -> list[FloatArray]:
    """Return points at which two segments meet: crossings, touching tangents, and ends that lie on the other one."""
    candidates = [a[0:2], a[2:4], b[0:2], b[2:4]]
    if a[6] == 0.0 and b[6] == 0.0:
        candidates += _line_line(a, b)
    elif a[6] == 0.0:
        candidates += _line_circle(a, b)
    elif b[6] == 0.0:
        candidates += _line_circle(b, a)
    else:
        candidates += _circle_circle(a, b)
    return [point for point in candidates if _is_on(point, a, tolerance) and _is_on(point, b, tolerance)]


def _is_on(point: FloatArray, segment: FloatArray, tolerance: float) -> bool:
    """Return whether a point lies on a segment, its ends included."""
    if min(np.linalg.norm(point - segment[0:2]), np.linalg.norm(point - segment[2:4])) <= tolerance:
        return True
    if segment[6] == 0.0:
        along = segment[2:4] - segment[0:2]
        length = float(np.linalg.norm(along))
        along = along / length
        relative = point - segment[0:2]
        aside = abs(float(relative[0] * along[1] - relative[1] * along[0]))
        return aside <= tolerance and 0.0 <= float(relative @ along) <= length
    radius = float(np.linalg.norm(segment[0:2] - segment[4:6]))
    if abs(float(np.linalg.norm(point - segment[4:6])) - radius) > tolerance:
        return False
    part = segment.copy()
    part[2:4] = point
    return _sweep(part) <= _sweep(segment)


def _line_line(a: FloatArray, b: FloatArray) -> list[FloatArray]:
    """Return where two lines cross; parallel ones meet, if at all, at an end."""
    p, q = a[2:4] - a[0:2], b[2:4] - b[0:2]
    sine = float(p[0] * q[1] - p[1] * q[0])
    if abs(sine) < 1e-12 * float(np.linalg.norm(p) * np.linalg.norm(q)):
        return []
    between = b[0:2] - a[0:2]
    return [a[0:2] + p * float(between[0] * q[1] - between[1] * q[0]) / sine]


def _line_circle(line: FloatArray, arc: FloatArray) -> list[FloatArray]:
    """Return where a line meets an arc's circle; the nearest point where it just misses or touches."""
    along = line[2:4] - line[0:2]
    along = along / np.linalg.norm(along)
    radius = float(np.linalg.norm(arc[0:2] - arc[4:6]))
    foot = line[0:2] + along * float((arc[4:6] - line[0:2]) @ along)
    half = np.sqrt(max(radius**2 - float((foot - arc[4:6]) @ (foot - arc[4:6])), 0.0))
    return [foot, foot - half * along, foot + half * along]


def _circle_circle(a: FloatArray, b: FloatArray) -> list[FloatArray]:
    """Return where two arcs' circles meet; the nearest point where they just miss or touch."""
    between = b[4:6] - a[4:6]
    distance = float(np.linalg.norm(between))
    first, second = (float(np.linalg.norm(arc[0:2] - arc[4:6])) for arc in (a, b))
    if distance < 1e-12 * max(first, second):
        return []  # about one centre: they meet, if at all, at an end
    along = between / distance
    foot = (distance**2 + first**2 - second**2) / (2.0 * distance)
    half = np.sqrt(max(first**2 - foot**2, 0.0))
    middle, aside = a[4:6] + foot * along, half * np.array([-along[1], along[0]])
    return [middle, middle - aside, middle + aside]
