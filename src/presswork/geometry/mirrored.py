# SPDX-License-Identifier: Apache-2.0
"""Surfaces that end at symmetry planes, completed by their mirror images."""

from __future__ import annotations

import numpy as np

from presswork.model import Triangulation


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
