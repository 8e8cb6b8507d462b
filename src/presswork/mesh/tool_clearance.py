# SPDX-License-Identifier: Apache-2.0
"""How far a rigid tool can go before it strikes another."""

from __future__ import annotations

import math

import numpy as np

from presswork.mesh.swept_tool import SweptTool
from presswork.mesh.tool_file import TriangulatedTool
from presswork.model import FloatArray

ToolShape = SweptTool | TriangulatedTool

MOST_ADVANCES = 200
"""A gap between surfaces that lie 60 degrees to the way is halved by each or by every other one."""


def sample_tool(shape: ToolShape, within: float) -> FloatArray:
    """Return the corners and middles of a tool's triangles (n, 3) [mm], in its own frame.

    within: by how much those of a drawn tool may be off it [mm].
    """
    if isinstance(shape, TriangulatedTool):
        points, triangles = shape.points, shape.triangles
    else:
        points, triangles = shape.triangulate(within)
    return np.concatenate([points, points[triangles].mean(axis=1)])


def find_clearance(
    one: ToolShape, other: ToolShape, between: FloatArray, way: FloatArray, within: float, tolerance: float = 1e-4
) -> float:
    """Return how far a tool can go along its way before it strikes another [mm]; infinite where it never does.

    between: from the other's origin to the one's (3,) [mm]. way: unit vector (3,). within: as in `sample_tool`.
    tolerance: of the gap that is left [mm].

    Points of either are held against the surface of the other. While the least gap is g nothing can touch within g, so
    the tool advances by g, and gaps that may now be small are asked again. Where that comes to no end, they only slide
    past each other. Tools that overlap from the start have no clearance to find: infinite, too.
    """
    points = sample_tool(one, within) + between, sample_tool(other, within) - between
    surfaces, ways = (other.surface(), one.surface()), (way, -way)
    gaps = [surface.nearest(x)[0] for surface, x in zip(surfaces, points, strict=True)]  # later: at least so much
    advance = 0.0
    for _ in range(MOST_ADVANCES):
        least = min(float(g.min()) for g in gaps)
        if least < tolerance:
            return advance if advance > 0.0 else math.inf
        if math.isinf(least):
            break
        advance += least
        for surface, x, along, gap in zip(surfaces, points, ways, gaps, strict=True):
            gap -= least
            near = gap < least
            gap[near] = surface.nearest(x[near] + advance * along)[0]
    return math.inf
