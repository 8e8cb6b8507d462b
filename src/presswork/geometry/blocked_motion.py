# SPDX-License-Identifier: Apache-2.0
"""Whether a rigid tool stands where points would go."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from presswork.geometry.pose import find_space_pose, start_profile
from presswork.geometry.segments import measure_distance
from presswork.geometry.tool_surface import make_surface
from presswork.geometry.touch_in_space import AGAINST, find_touch_in_space
from presswork.model import FloatArray, Plane, Profile, Tool


def look_at(tool: Tool) -> Callable[[FloatArray, float], tuple[FloatArray, FloatArray]]:
    """Return what gives gap (n,) and normal (n, d) of a tool where it starts, at points (n, d) within a reach [mm].

    Beside the ends of an open profile there is no metal, on neither side.
    """
    if isinstance(tool.shape, Profile):
        segments = start_profile(tool)

        def nearest_in_plane(points: FloatArray, _: float) -> tuple[FloatArray, FloatArray]:
            place = measure_distance(points, segments)
            return np.where(place.beside, place.distance, np.abs(place.distance)), place.outwards

        return nearest_in_plane
    surface, pose = make_surface(tool.surface), find_space_pose(tool, np.zeros(3))

    def nearest_in_space(points: FloatArray, reach: float) -> tuple[FloatArray, FloatArray]:
        gap, normal, *_ = surface.nearest(np.ascontiguousarray(pose.to_frame(points)), reach)
        return gap, pose.turn(normal)

    return nearest_in_space


def blocks_motion(tool: Tool, points: FloatArray, direction: FloatArray) -> bool:
    """Return whether points (n, d) that go along a unit vector (d,), however far, come upon a tool where it starts."""
    if isinstance(tool.shape, Plane):  # without end: reached, however far, by all that does not glide along it
        _, normal = look_at(tool)(points[:1], np.inf)
        return bool(normal[0] @ -direction > AGAINST)
    return find_touch_in_space(look_at(tool), points, -direction) is not None
