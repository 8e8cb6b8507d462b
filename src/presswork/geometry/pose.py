# SPDX-License-Identifier: Apache-2.0
"""Position and angle of a rigid tool: maps between its own frame, in which its shape is given, and space."""

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


@dataclass(frozen=True)
class SpacePose:
    """Where a tool in space stands: it has turned about its centre, and moved with it."""

    centre: FloatArray
    """Centre in its own frame (3,) [mm]."""
    start: FloatArray
    """Where that was at the start (3,) [mm]."""
    displacement: FloatArray
    """(3,) [mm]."""
    turned: FloatArray | None
    """Rotation from its own frame to space (3, 3); None: it has not turned."""

    def to_frame(self, points: FloatArray) -> FloatArray:
        """Return points (n, 3) of space in the tool's own frame."""
        if self.turned is None:
            return np.asarray(points - self.start - self.displacement)
        return np.asarray((points - self.start - self.displacement) @ self.turned + self.centre)

    def carry(self, points: FloatArray) -> FloatArray:
        """Return where points (n, 3) of the tool's own frame are in space."""
        if self.turned is None:
            return np.asarray(points + self.start + self.displacement)
        return np.asarray((points - self.centre) @ self.turned.T + self.start + self.displacement)

    def turn(self, vectors: FloatArray) -> FloatArray:
        """Return vectors (n, 3) of the tool's own frame as they point in space."""
        return vectors if self.turned is None else np.asarray(vectors @ self.turned.T)


def start_centre_in_space(tool: Tool) -> FloatArray:
    """Return where the point about which a tool in space turns is at the start (3,) [mm]."""
    return np.asarray(turn_about(np.array(tool.rotation)) @ _own_centre(tool) + np.array(tool.position))


def _own_centre(tool: Tool) -> FloatArray:
    return np.array((*tool.centre, 0.0)[:3])


def find_space_pose(tool: Tool, displacement: FloatArray, angle: float = 0.0) -> SpacePose:
    """Return where a tool in space stands that has moved (3,) [mm] and turned about its axis [rad]."""
    if angle == 0.0 and not any(tool.rotation):
        return SpacePose(np.zeros(3), np.array(tool.position), displacement, None)
    start = turn_about(np.array(tool.rotation))
    turned = start @ turn_about(angle * np.array(tool.axis))
    return SpacePose(_own_centre(tool), start_centre_in_space(tool), displacement, turned)


def find_pose_since(centre: FloatArray, displacement: FloatArray, rotation: FloatArray) -> SpacePose:
    """Return the pose of a tool in space whose points are given where they were at the start.

    centre: about which it turns, at the start (3,) [mm]. displacement: of the centre (3,) [mm]. rotation: a vector
    along the axis, its length the angle turned since the start (3,) [rad].
    """
    if not rotation.any():
        return SpacePose(np.zeros(3), np.zeros(3), displacement, None)
    return SpacePose(centre, centre, displacement, turn_about(rotation))


def find_axis(tool: Tool) -> FloatArray:
    """Return the unit vector in space about which a tool turns (3,)."""
    return np.asarray(turn_about(np.array(tool.rotation)) @ np.array(tool.axis))


def turn_about(vector: FloatArray) -> FloatArray:
    """Return the rotation (3, 3) about a vector by its length [rad] (Rodrigues)."""
    angle = float(np.linalg.norm(vector))
    if angle == 0.0:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross)
