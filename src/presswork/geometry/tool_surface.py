# SPDX-License-Identifier: Apache-2.0
"""The compiled surfaces that contact asks, made from the shapes of tools in space."""

from __future__ import annotations

import math

from presswork import _core
from presswork.model import Surface, SweptProfile


def make_surface(shape: Surface, depth: float = math.inf, *, smooth: bool = False) -> _core.ToolSurface:
    """Return the surface of a tool, in the tool's own frame.

    depth: penetrations deeper than this are not found [mm]; for an open triangulation, or a thin-walled tool, less than
    half of what lies between its faces. smooth: round off triangles, so that normals do not jump from facet to facet; a
    swept profile is smooth in any case. Raises ValueError where profile and plan do not fit.
    """
    if isinstance(shape, SweptProfile):
        return _core.ToolSurface.swept(shape.half_widths, shape.corner_radius, shape.segments, depth=depth)
    return _core.ToolSurface.triangles(shape.points, shape.triangles, depth=depth, smooth=smooth)
