# SPDX-License-Identifier: Apache-2.0
"""Surfaces that end at symmetry planes, completed by their mirror images."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from presswork.geometry.pose import find_space_pose
from presswork.model import Model, Tool, Triangulation, find_held_side

WITHIN = 5e-4
"""How far a tool may end off the symmetry plane at which it is completed, over the smallest cells."""


def find_mirrors(tool: Tool, model: Model) -> list[tuple[int, float, float]]:
    """Return the symmetry planes that cut a tool: axis, level [mm], and 1 where the body lies above it, else -1."""
    middle = model.mesh.points.mean(axis=0)
    levels = {axis: find_held_side(model, axis) for axis in range(3) if tool.mirrored_across[axis]}
    return [(axis, level, float(np.sign(middle[axis] - level))) for axis, level in levels.items() if level is not None]


def complete_tool(tool: Tool, mirrors: Sequence[tuple[int, float, float]], tolerance: float) -> Triangulation:
    """Return the facets of a tool, in its own frame, with their mirror images beyond planes as of find_mirrors.

    tolerance: how far the tool may end off the planes [mm].
    """
    assert isinstance(tool.surface, Triangulation)
    start = find_space_pose(tool, np.zeros(3))
    shape = replace(tool.surface, points=start.carry(tool.surface.points))
    for axis, level, inward in mirrors:
        shape = add_mirror_image(shape, axis, level, inward, tolerance)
    return replace(shape, points=np.ascontiguousarray(start.to_frame(shape.points)))


def add_mirror_image(shape: Triangulation, axis: int, level: float, inward: float, tolerance: float) -> Triangulation:
    """Return a surface with its mirror image beyond a plane, or itself where it goes on beyond it by more.

    Metal at a plane finds no tool where the surface that ends there is not normal to it: the nearest place lies beyond.

    axis, level: of the plane [mm]; inward: 1 where the body lies above the level, else -1; tolerance: how far the
    surface may lie off the plane at which it ends [mm].
    """
    points = shape.points.copy()
    away = inward * (points[:, axis] - level)
    if away.min() < -tolerance or away.min() > tolerance:
        return shape
    in_plane = away <= tolerance
    points[in_plane, axis] = level
    triangles = shape.triangles[~in_plane[shape.triangles].all(axis=1)]  # a wall in the plane is none of the whole
    mirrored = points[~in_plane]
    mirrored[:, axis] = 2.0 * level - mirrored[:, axis]
    number = np.arange(len(points))
    number[~in_plane] = len(points) + np.arange(len(mirrored))
    both = np.concatenate([triangles, number[triangles][:, ::-1]]).astype(np.int32)
    return Triangulation(np.concatenate([points, mirrored]), both, shape.is_closed)
