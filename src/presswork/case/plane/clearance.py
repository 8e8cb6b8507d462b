# SPDX-License-Identifier: Apache-2.0
"""The clearance of tools that cut: between the wall of one that moves and the wall beside it that stands."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from presswork import model
from presswork.case.errors import Problem
from presswork.case.motion.gaps import measure_gap
from presswork.case.tools.close_fits import PARALLEL, find_relative_direction
from presswork.geometry.pose import start_profile
from presswork.geometry.segments import TURN, X0, X1
from presswork.model import FloatArray

USUAL = (0.05, 0.1)
"""Usual clearances over the thickness."""
_STEP = 1e-6
"""Step off a wall by which its free side is found, over the thickness."""


def check_clearance(tools: Sequence[model.Tool], stages: Sequence[model.Stage], points: FloatArray) -> list[Problem]:
    """Return the problems of tools whose walls leave no clearance, or one beyond the sheet's thickness.

    points: of the workpiece (n_points, 2) [mm].
    """
    problems = []
    for tool in tools:
        found = []
        for other in tools:
            direction = find_relative_direction(tool, other, stages, 2) if other is not tool else np.zeros(2)
            if direction.any() and not any(stage.tool_motion.get(other.name) for stage in stages):
                thickness = float(np.ptp(points @ direction))
                found += [(c, other, thickness) for c in _find_clearances(tool, other, direction, points, thickness)]
        if not found:
            continue
        clearance, other, thickness = min(found, key=lambda each: abs(each[0]))
        usual = f"{USUAL[0] * thickness:.2g} to {USUAL[1] * thickness:.2g} mm are usual"
        if clearance <= _STEP * thickness:
            fault = f"no clearance to {tool.name}: their walls are {clearance:.3g} mm apart"
            problems.append(Problem(f"tools.{other.name}", fault, usual))
        elif clearance > thickness:
            fault = f"the clearance to {tool.name}, {clearance:.3g} mm, exceeds the thickness of {thickness:.3g} mm"
            problems.append(Problem(f"tools.{other.name}", fault, f"{usual}; to draw, leave out [separation]"))
    return problems


def _find_clearances(
    tool: model.Tool, other: model.Tool, direction: FloatArray, points: FloatArray, thickness: float
) -> Iterator[float]:
    """Yield the distance from each wall of a tool to each wall of another that faces it and lies ahead [mm]."""
    middle = float((points @ direction).mean())
    for _, at, side in _list_walls(tool, direction, thickness):
        for far, opposite, facing in _list_walls(other, direction, thickness):
            if side == -facing and far > middle:
                yield side * (opposite - at)


def _list_walls(tool: model.Tool, direction: FloatArray, thickness: float) -> Iterator[tuple[float, float, float]]:
    """Yield the straight pieces along a direction: their end and their place across it [mm], and the free side (±1)."""
    across = np.array([-direction[1], direction[0]])
    for segment in start_profile(tool):
        piece = segment[X1] - segment[X0]
        length = float(np.linalg.norm(piece))
        if segment[TURN] != 0.0 or length == 0.0 or abs(float(piece @ across)) > PARALLEL * length:
            continue
        middle, step = 0.5 * (segment[X0] + segment[X1]), _STEP * thickness
        gap = measure_gap(tool, np.stack([middle + step * across, middle - step * across]), np.inf)
        reach = max(float(segment[X0] @ direction), float(segment[X1] @ direction))
        yield reach, float(middle @ across), 1.0 if gap[0] > gap[1] else -1.0
