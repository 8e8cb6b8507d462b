# SPDX-License-Identifier: Apache-2.0
"""Turns a drawn tool's dimensions into its surface; the clearance between two tools."""

from __future__ import annotations

import numpy as np

from presswork.case.stamping.tools import (
    DrawnTool,
    HemisphericalTool,
    RectangularTool,
    RingTool,
    RoundTool,
    SectionTool,
)
from presswork.geometry.section_tool import draw_one_sided, draw_round_x, draw_section
from presswork.geometry.swept_tool import (
    draw_closed_die,
    draw_die,
    draw_hemispherical_punch,
    draw_holder,
    draw_punch,
    draw_ring,
)
from presswork.model import SweptProfile, Triangulation


def draw_shape(
    tool: DrawnTool | RingTool | SectionTool, depth: float, face_width: float
) -> SweptProfile | Triangulation:
    """Return the surface of a drawn tool.

    depth: height of its wall beyond the radius [mm]. face_width: of a die or holder, half the length of a tool on one
    side [mm].
    """
    if isinstance(tool, SectionTool) and tool.plan == "one_sided":
        return draw_one_sided(tool.corners, tool.radii(), face_width)
    if isinstance(tool, SectionTool) and tool.plan == "round_x":
        return draw_round_x(tool.corners, tool.radii())
    if isinstance(tool, SectionTool):
        return draw_section(tool.corners, tool.radii(), is_round=tool.plan == "round")
    if isinstance(tool, RingTool):
        inner, outer = (0.5 * tool.inner_diameter, tool.inner_radius), (0.5 * tool.outer_diameter, tool.outer_radius)
        return draw_ring(inner, outer, max(inner[1], outer[1]) + depth, works_up=tool.kind == "die")
    half = tool.half_size()
    if isinstance(tool, HemisphericalTool):
        return draw_hemispherical_punch(half[0], half[0] + depth)
    radius = tool.edge_radius
    corner = tool.corner_radius if isinstance(tool, RectangularTool) else min(half)
    if tool.kind == "punch":
        return draw_punch(half, corner, radius, radius + depth)
    if tool.kind == "die" and tool.depth is not None:
        return draw_closed_die(half, corner, radius, width=face_width, depth=tool.depth, bottom=tool.bottom_radius)
    if tool.kind == "die":
        return draw_die(half, corner, radius, width=face_width, depth=radius + depth)
    return draw_holder(half, corner, radius, width=face_width, height=radius + depth)


def clearance(punch: DrawnTool, die: DrawnTool) -> float:
    """Return the smallest distance between the walls of a punch and a die about the same axis [mm]."""
    outer, inner = die.half_size(), punch.half_size()
    gaps = [o - i for o, i in zip(outer, inner, strict=True) if not np.isinf(o)]
    return min(_corner_gap(punch, die), *gaps)


def _corner_gap(punch: DrawnTool, die: DrawnTool) -> float:
    """Return the distance of the walls along the diagonal of the corners; infinite where one has none."""
    corners = []
    for tool in (punch, die):
        if isinstance(tool, RectangularTool):
            corners.append((*tool.half_size(), tool.corner_radius))
        elif isinstance(tool, RoundTool | HemisphericalTool):
            corners.append((*tool.half_size(), tool.half_size()[0]))
        else:
            return float("inf")
    (inner_x, inner_y, inner_r), (outer_x, outer_y, outer_r) = corners
    # from the die's corner centre to the farthest point of the punch's corner
    away = np.hypot(inner_x - inner_r - outer_x + outer_r, inner_y - inner_r - outer_y + outer_r)
    ahead = inner_x - inner_r > outer_x - outer_r and inner_y - inner_r > outer_y - outer_r
    return float(outer_r - inner_r - away) if ahead else float("inf")
