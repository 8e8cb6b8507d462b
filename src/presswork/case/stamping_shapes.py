# SPDX-License-Identifier: Apache-2.0
"""From a drawn tool's dimensions to its plan and profile.

A profile runs in (s, z), s outwards from the plan's curve, z = 0 on the working face; the metal is on its right.
"""

from __future__ import annotations

import numpy as np

from presswork.case.stamping_tools import DrawnTool, HemisphericalTool, RectangularTool, RoundTool
from presswork.model import FloatArray
from presswork.model_stamping import SweptShape


def draw_shape(tool: DrawnTool, depth: float, face_width: float) -> SweptShape:
    """Return the shape of a drawn tool.

    depth: height of its wall beyond the radius [mm]. face_width: of a die or holder [mm].
    """
    half = tool.half_size()
    corner = tool.corner_radius if isinstance(tool, RectangularTool) else min(half)
    radius = half[0] if isinstance(tool, HemisphericalTool) else tool.edge_radius
    if tool.kind == "punch":
        profile = _draw_punch(radius, radius + depth, min(half))
    else:
        draw = _draw_die if tool.kind == "die" else _draw_holder
        profile = draw(radius, radius + depth, face_width)
    return SweptShape(half, corner, profile)


def _draw_punch(radius: float, height: float, inwards: float) -> FloatArray:
    """Draw wall, nose and bottom, from the top of the wall to the middle of the plan, `inwards` of its outline."""
    segments = [_line(0.0, height, 0.0, radius), _arc(0.0, radius, -radius, 0.0, -radius, radius)]
    if radius < inwards:
        segments.append(_line(-radius, 0.0, -inwards, 0.0))
    return np.array(segments)


def _draw_die(radius: float, depth: float, face_width: float) -> FloatArray:
    """Draw wall, shoulder and face, from the bottom of the wall outwards."""
    wall, shoulder = _line(0.0, -depth, 0.0, -radius), _arc(0.0, -radius, radius, 0.0, radius, -radius)
    return np.array([wall, shoulder, _line(radius, 0.0, face_width, 0.0)])


def _draw_holder(radius: float, height: float, face_width: float) -> FloatArray:
    """Draw face, edge and wall, from the outer end of the face."""
    edge = [_arc(radius, 0.0, 0.0, radius, radius, radius)] if radius > 0.0 else []
    return np.array([_line(face_width, 0.0, radius, 0.0), *edge, _line(0.0, radius, 0.0, height)])


def _line(x0: float, z0: float, x1: float, z1: float) -> list[float]:
    return [x0, z0, x1, z1, 0.0, 0.0, 0.0]


def _arc(x0: float, z0: float, x1: float, z1: float, centre_x: float, centre_z: float) -> list[float]:
    """Return a quarter circle that runs clockwise."""
    return [x0, z0, x1, z1, centre_x, centre_z, -1.0]


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
