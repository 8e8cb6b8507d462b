# SPDX-License-Identifier: Apache-2.0
"""Directed profiles of lines and arcs in the plane: signed distance, samples, and the travel until contact.

Segments have the form of model.Tool: x0, y0, x1, y1, centre x, centre y, turn; the left of a directed profile is free.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswork.model import FloatArray

X0, X1, CENTRE, TURN = slice(0, 2), slice(2, 4), slice(4, 6), 6
TOUCHING = 1e-9
"""Gap that remains where a tool is moved to touch the workpiece, over the workpiece's size."""
MOST_STEPS = 2000
"""Most steps of the travel until contact: one for a flat tool, more the more it slides along the workpiece."""


def reverse_segments(segments: FloatArray) -> FloatArray:
    """Return the profile in the opposite direction."""
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
    """Position of points relative to a profile."""

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


def find_touch(nodes: FloatArray, segments: FloatArray, direction: FloatArray) -> float | None:
    """Return how far a profile goes along `way`, a direction (2,), until it touches a node [mm]; None if it never does.

    It goes by the least distance of any node again and again: no node can come nearer.
    """
    corners = segments[:, 0:4].reshape(-1, 2)
    size = float(np.linalg.norm(np.ptp(nodes, axis=0)))
    farthest = size + float(np.linalg.norm(np.ptp(corners, axis=0)))
    farthest += float(np.linalg.norm(corners.mean(axis=0) - nodes.mean(axis=0)))
    gone = 0.0
    for _ in range(MOST_STEPS):
        gap = float(np.abs(measure_distance(nodes - gone * direction, segments).distance).min())
        if gap <= TOUCHING * size:
            return gone
        gone += gap
        if gone > farthest:
            break
    return None
