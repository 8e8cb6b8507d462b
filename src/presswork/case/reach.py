# SPDX-License-Identifier: Apache-2.0
"""Whether the tools' motions bring them to the workpiece."""

from __future__ import annotations

import logging
from collections.abc import Sequence

import numpy as np

from presswork import _core
from presswork.case.errors import Problem
from presswork.model import FloatArray, Mesh, Stage, Tool, ToolMotion

logger = logging.getLogger(__name__)

TOLERANCE = 1e-6
"""Of the size of the workpiece: how close a tool is that touches."""
_SAMPLES = 16
"""Places along each stage's motion."""


def check_reach(tools: Sequence[Tool], stages: Sequence[Stage], mesh: Mesh) -> list[Problem]:
    """Return a problem when nothing can ever happen: no tool that moves ever touches a node of the workpiece.

    That is certain only where nothing else moves or loads the workpiece. Where something does, a tool that never comes
    nearer than it starts is a warning in the log.
    """
    nodes = mesh.points[np.unique(mesh.boundary_edges)]
    tolerance = TOLERANCE * float(np.linalg.norm(np.ptp(nodes, axis=0)))
    moving = [tool for tool in tools if any(_moves(stage.tool_motion.get(tool.name)) for stage in stages)]
    approach = {tool.name: _approach(tool, stages, nodes) for tool in moving}
    leaving = [tool for tool in moving if _leaves(*approach[tool.name], tolerance)]
    loaded = any(stage.prescribed or stage.forces or stage.pressures for stage in stages)
    loaded = loaded or any(tool.spring is not None for tool in tools)
    nearest = {name: min(gaps) for name, gaps in approach.items()}
    if moving and not loaded and all(tool in leaving or nearest[tool.name] > tolerance for tool in moving):
        first = min(moving, key=lambda tool: nearest[tool.name])
        stage = next(i for i, stage in enumerate(stages) if _moves(stage.tool_motion.get(first.name)))
        how = f"it comes no nearer to a node than {nearest[first.name]:.6g} mm"
        if first in leaving:
            how = "it only moves away from it"
        return [
            Problem(
                f"stages.{stage}.tools.{first.name}",
                f"the tool never reaches the workpiece: {how}, and nothing else moves",
                "lengthen the stroke, turn it round, mend the profile, or refine the mesh under a narrow tool",
            )
        ]
    for tool in leaving:
        logger.warning("tools.%s: the tool moves, but never comes nearer to the workpiece than it starts", tool.name)
    return []


def _moves(motion: ToolMotion | None) -> bool:
    return motion is not None and (any(motion.move) or motion.turn != 0.0 or motion.force is not None)


def _leaves(first: float, later: float, tolerance: float) -> bool:
    """Say whether a tool never comes nearer than it starts, and touches nothing once it has moved."""
    return later >= first - tolerance and later > tolerance


def _approach(tool: Tool, stages: Sequence[Stage], nodes: FloatArray) -> tuple[float, float]:
    """Return the least gap of a tool to the nodes at its start, and after it on its way [mm].

    Of a tool that turns, or that a force pushes, the way is not known: 0.
    """
    motions = [stage.tool_motion.get(tool.name, ToolMotion()) for stage in stages]
    place = np.zeros(2)
    first = _distance(tool, nodes, place)
    if any(motion.turn != 0.0 or motion.force is not None for motion in motions):
        return first, 0.0
    later = np.inf
    for motion in motions:
        move = np.array(motion.move)
        for fraction in np.linspace(0.0, 1.0, _SAMPLES + 1)[1:] if move.any() else ():
            later = min(later, _distance(tool, nodes, place + fraction * move))
        place = place + move
    return first, later


def _distance(tool: Tool, nodes: FloatArray, place: FloatArray) -> float:
    """Return the least gap of the nodes to a tool moved to `place` [mm]; infinite if it faces none of them."""
    gap, _, second_gap, *_ = _core.touch_profile(np.ascontiguousarray(tool.segments), nodes - place)
    return float(min(gap.min(), second_gap.min()))
