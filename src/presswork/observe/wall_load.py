# SPDX-License-Identifier: Apache-2.0
"""How near the force of a punch comes to what the wall of the drawn part bears."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.law.elastic_plastic import make_yield_function
from presswork.law.wall import find_flow_stress, find_strengths, find_wall_force, has_wall
from presswork.model import FloatArray, Model, SweptProfile, Tool

NEAR = 0.9
"""Part of what the wall bears from which on the force is a warning."""
BEYOND = 1.1
"""Part above which the force is no longer the wall's: the punch presses the sheet against the die."""


def warn_of_wall_load(model: Model, history: Mapping[str, NDArray[Any]]) -> list[str]:
    """Return a warning for each drawn punch of a stamping whose largest force is near what the wall bears."""
    if model.analysis != "stamping" or model.heat is not None or model.zones:
        return []
    section, material = model.sheet
    if not has_wall(material):
        return []
    strength = find_wall_force(find_strengths(make_yield_function(material.yield_function)), find_flow_stress(material))
    found = []
    for tool in model.tools:
        around, column = _measure_wall(tool), history.get(f"{tool.name}.force_z")
        if around is None or column is None or not len(column):
            continue
        force, bears = _largest_steady(np.abs(column)), around * section.thickness * strength
        if NEAR < force / bears < BEYOND:
            found.append(
                f"{tool.name}: its largest force, {force / 1000:.4g} kN, is {100 * force / bears:.0f} % of what the "
                f"wall bears, {bears / 1000:.4g} kN ({around:.4g} mm around, {section.thickness:g} mm thick): the part "
                "may tear where friction, thickness or strength are a little off; draw a smaller blank, take less "
                "holder force or friction, or larger radii"
            )
    return found


def _measure_wall(tool: Tool) -> float | None:
    """Return the length around the wall that a drawn punch draws [mm]; None for other tools, and for strips."""
    shape = tool.shape
    if tool.kind != "punch" or not isinstance(shape, SweptProfile) or math.isinf(sum(shape.half_widths)):
        return None
    x, y = shape.half_widths
    return 4.0 * (x + y) - (8.0 - 2.0 * math.pi) * shape.corner_radius


def _largest_steady(force: FloatArray) -> float:
    """Return the largest force that is no single peak: of medians of three rows in a row."""
    if len(force) < 3:
        return float(force.max())
    return float(np.median([force[:-2], force[1:-1], force[2:]], axis=0).max())
