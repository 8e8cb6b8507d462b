# SPDX-License-Identifier: Apache-2.0
"""The compiled surfaces that contact asks, made from the shapes of tools in space."""

from __future__ import annotations

import math

import numpy as np

from presswork import _core
from presswork.model import FloatArray, Plane, Surface, SweptProfile, Triangulation

ENDLESS = 1e5
"""Half the width of the square that stands for a plane without end [mm]."""


def make_surface(shape: Surface, depth: float = math.inf, *, smooth: bool = False) -> _core.ToolSurface:
    """Return the surface of a tool, in the tool's own frame.

    depth: penetrations deeper than this are not found [mm]; for an open triangulation, or a thin-walled tool, less than
    half of what lies between its faces. smooth: round off triangles, so that normals do not jump from facet to facet; a
    swept profile is smooth in any case. Raises ValueError where profile and plan do not fit.
    """
    if isinstance(shape, Plane):
        shape = cut_plane(shape, ENDLESS)
    if isinstance(shape, SweptProfile):
        return _core.ToolSurface.swept(shape.half_widths, shape.corner_radius, shape.segments, depth=depth)
    return _core.ToolSurface.triangles(shape.points, shape.triangles, depth=depth, smooth=smooth)


def cut_plane(plane: Plane, half_width: float) -> Triangulation:
    """Return a square of a plane about its origin, of two triangles; half_width: of the square [mm]."""
    normal = np.asarray(plane.normal)
    along = np.cross(normal, np.eye(3)[int(np.abs(normal).argmin())])
    along *= half_width / np.linalg.norm(along)
    across = np.cross(normal, along)
    points = np.array([-along - across, along - across, along + across, across - along])
    return Triangulation(points, np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32), False)


def list_extreme_points(shape: SweptProfile | Triangulation) -> FloatArray:
    """Return points whose extent is that of a shape, in its own frame (n, 3) [mm]."""
    if isinstance(shape, Triangulation):
        return shape.points
    outwards, heights = shape.segments[:, [0, 2]], shape.segments[:, [1, 3]]
    x, y = np.array(shape.half_widths) + max(float(outwards.max()), 0.0)
    return np.array([(i * x, j * y, z) for i in (-1, 1) for j in (-1, 1) for z in (heights.min(), heights.max())])
