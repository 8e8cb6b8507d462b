# SPDX-License-Identifier: Apache-2.0
"""Position and angle of a rigid tool: maps between the tool's own frame, in which its profile is given, and space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.model import FloatArray, Tool


@dataclass(frozen=True)
class ToolPose:
    """A tool has turned about its centre, and moved with it."""

    centre: FloatArray
    """Position at the start (2,) [mm]."""
    displacement: FloatArray
    """(2,) [mm]."""
    angle: float
    """[rad], counter-clockwise."""


def turn_vectors(vectors: FloatArray, angle: float) -> FloatArray:
    """Return vectors (..., 2) turned by an angle [rad]."""
    if angle == 0.0:
        return vectors
    cosine, sine = np.cos(angle), np.sin(angle)
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=-1)


def place_points(points: FloatArray, pose: ToolPose) -> FloatArray:
    """Return where points (..., 2) of the tool's own frame are in space."""
    if pose.angle == 0.0:
        return np.asarray(points + pose.displacement)
    return np.asarray(turn_vectors(points - pose.centre, pose.angle) + pose.centre + pose.displacement)


def to_tool_frame(points: FloatArray, pose: ToolPose) -> FloatArray:
    """Return points (..., 2) of space in the tool's own frame."""
    if pose.angle == 0.0:
        return np.asarray(points - pose.displacement)
    return np.asarray(turn_vectors(points - pose.displacement - pose.centre, -pose.angle) + pose.centre)


def place_segments(segments: FloatArray, pose: ToolPose) -> FloatArray:
    """Return a profile (n_segments, 7), as in model.Profile, where it is in space."""
    placed = segments.copy()
    for columns in (slice(0, 2), slice(2, 4), slice(4, 6)):
        placed[:, columns] = place_points(segments[:, columns], pose)
    return placed


def shift_segments(segments: FloatArray, place: FloatArray) -> FloatArray:
    """Return a profile moved by `place` [mm]; centres of arcs move along."""
    shifted = segments.copy()
    shifted[:, 0:4] += np.tile(place, 2)
    shifted[:, 4:6] += np.where(segments[:, 6:7] != 0.0, place, 0.0)
    return shifted


def start_profile(tool: Tool) -> FloatArray:
    """Return the profile of a tool in the plane where it starts, segments (n, 7) as in model.Profile [mm]."""
    return shift_segments(tool.profile.segments, np.array(tool.position[:2]))


def start_centre(tool: Tool) -> FloatArray:
    """Return where the point about which a tool in the plane turns is at the start (2,) [mm]."""
    return np.array([tool.centre[0] + tool.position[0], tool.centre[1] + tool.position[1]])
