# SPDX-License-Identifier: Apache-2.0
"""What `presswork check` reports about a round cup's drawing ratio, and the limit that its wall sets."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from presswork.law.wall import Cup, find_drawing_ratio, has_wall
from presswork.model import Model, SweptProfile

NEAR = 0.95
"""Share of the limiting drawing ratio from which on a hint warns."""


def describe_drawing_ratio(problem: Model) -> Iterator[str]:
    """Describe the drawing ratio of a round punch that a holder helps, with the limit of its sheet."""
    section, material = problem.sheet
    round_punches = [
        tool for tool in problem.tools
        if tool.kind == "punch" and isinstance(tool.shape, SweptProfile) and len({*tool.shape.half_widths,
                                                                                 tool.shape.corner_radius}) == 1
    ]  # fmt: skip
    holds = any(tool.kind == "holder" for tool in problem.tools)
    if not (round_punches and holds and has_wall(material)) or problem.heat is not None:
        return
    punch = round_punches[0]
    assert isinstance(punch.shape, SweptProfile)
    diameter = 2.0 * punch.shape.corner_radius
    area = _measure_area(problem) * 2 ** sum(problem.symmetry)
    ratio = math.sqrt(4.0 * area / math.pi) / diameter
    mu = max((float(np.max(tool.friction.mu)) for tool in problem.tools if tool.kind in ("die", "holder")), default=0.1)
    limit = find_drawing_ratio(material, Cup(punch=diameter / section.thickness, mu=mu))
    text = f"drawing ratio: {ratio:.3g}; the wall bears {limit:.3g} (theory of a round cup)"
    yield text
    if ratio > NEAR * limit:
        yield "hint: that is near or above what the wall bears if the cup is drawn through; a smaller blank, or redraw"


def _measure_area(problem: Model) -> float:
    """Return the area of the blank that is modelled [mm2]."""
    total = 0.0
    for block in problem.mesh.blocks:
        corners = problem.mesh.points[block.connectivity[:, :4], :2]
        x, y = corners[..., 0], corners[..., 1]
        total += 0.5 * float(np.abs((x * np.roll(y, -1, 1) - y * np.roll(x, -1, 1)).sum(axis=1)).sum())
    return total
