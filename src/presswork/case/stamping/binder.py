# SPDX-License-Identifier: Apache-2.0
"""How a holder closes on a die: by their surfaces along the motion, since the faces of a binder may be curved."""

from __future__ import annotations

import itertools
import logging

import numpy as np

from presswork.case.errors import Problem
from presswork.case.stamping.closing import DRAWN_WITHIN, find_approach, find_meeting
from presswork.case.stamping.schema import StampingCase
from presswork.case.stamping.stage import StampingStage, ToolAction
from presswork.mesh.tool_clearance import Closing, find_level_gap
from presswork.model import Tool

logger = logging.getLogger(__name__)

SHORT, NOT_FORMED = 0.5, 1.5
"""Thicknesses by which level faces may be farther apart than asked for where tools close on their walls: a warning, and
an error."""
IDLE = 2.0
"""Thicknesses between die and holder from which on it holds nothing."""
SQUEEZED = 0.9
"""Part of the thickness to which a holder may be moved towards the die."""


def resolve_closings(case: StampingCase, tools: tuple[Tool, ...]) -> tuple[StampingCase, list[Problem]]:
    """Return the case with a stroke for each tool that closes by distance on its die, as the placed tools let it."""
    placed, gone = {tool.name: tool for tool in tools}, dict.fromkeys(case.tools, 0.0)
    stages, problems = [], []
    for index, stage in enumerate(case.stages):
        actions = {}
        for name, action in stage.tools.items():
            if action.close is not None:
                stroke = _find_stroke(case, index, name, placed, gone)
                if isinstance(stroke, Problem):
                    problems.append(stroke)
                    continue
                action = action.model_copy(update={"stroke": stroke})
            actions[name] = action
        for name, action in actions.items():
            gone[name] = np.nan if action.force is not None else gone[name] + (action.stroke or 0.0)
        stages.append(stage.model_copy(update={"tools": actions}))
    return case.model_copy(update={"stages": tuple(stages)}), problems


def _find_stroke(
    case: StampingCase, index: int, name: str, placed: dict[str, Tool], gone: dict[str, float]
) -> float | Problem:
    """Return how far a tool goes in a stage until it leaves its `close` to a die [mm].

    gone: how far each has moved before the stage; not a number where a force has placed it.
    """
    stage, close = case.stages[index], case.stages[index].tools[name].close
    assert close is not None
    key, tool = f"stages.{index}.tools.{name}.close", placed[name]
    travels: list[tuple[float, Tool, Closing]] = []
    for die in (placed[each] for each, entry in case.tools.items() if entry.kind == "die"):
        if np.isnan(gone[name] + gone[die.name]) or _acts(stage.tools.get(die.name)):
            fault = f"where {name} and {die.name} stand to each other is not known, as a force or the stage moves them"
            return Problem(key, fault, "give the stroke, or let the die stand still", close)
        found = find_meeting(tool, die, close, case.blank.thickest)
        if found is not None:
            travels.append((found.travel - find_approach(tool, die, gone), die, found))
    stroke, die, closing = min(travels, key=lambda each: each[0], default=(0.0, tool, None))
    if closing is None or stroke <= 0.0:
        fault = "it stands so near already" if travels else "it never comes so near to a die along its path"
        return Problem(key, fault, "mend the place of the tools, or give the stroke", close)
    problem = _check_level(case, key, tool, die, closing, close)
    return stroke if problem is None else problem


def _check_level(case: StampingCase, key: str, tool: Tool, die: Tool, closing: Closing, close: float) -> Problem | None:
    """Return a problem where a tool stops at a wall of its die long before it comes to the level faces, or warn."""
    thickness, direction = case.blank.thickest, np.array(tool.working_direction)
    between = np.subtract(tool.position, die.position) + closing.travel * direction
    gap = find_level_gap(tool.surface, die.surface, between, direction, DRAWN_WITHIN * thickness)
    if not np.isfinite(gap) or gap - close <= SHORT * thickness:
        return None
    x, y, z = closing.place + np.asarray(die.position)
    fault = (
        f"{tool.name} comes that near to a wall of {die.name} at ({x:.4g}, {y:.4g}, {z:.4g}) mm, and stops there: the "
        f"level faces are still {gap:.4g} mm apart, and do not form the sheet"
    )
    remedy = (
        f"make {tool.name} smaller (offset = {1.1 * thickness:.3g} where its file has the face of {die.name}), take a "
        "smaller close, or give the stroke"
    )
    if gap - close > NOT_FORMED * thickness and case.limits.stop:
        return Problem(key, fault, remedy, close)
    logger.warning("%s: %s; %s", key, fault, remedy)
    return None


def _acts(action: ToolAction | None) -> bool:
    return action is not None and any(getattr(action, key) for key in ("stroke", "force", "close"))


def check_binders(case: StampingCase, tools: tuple[Tool, ...]) -> list[Problem]:
    """Return the problems of holders and dies as their surfaces come together."""
    pairs = itertools.product(tools, tools)
    problems = [_check_binder(case, one, die) for one, die in pairs if (one.kind, die.kind) == ("holder", "die")]
    return [problem for problem in problems if problem is not None]


def _check_binder(case: StampingCase, holder: Tool, die: Tool) -> Problem | None:
    """Return a problem of strokes that press through the sheet or hold nothing, and of a force that slams."""
    thickness, gone = case.blank.thickest, {holder.name: 0.0, die.name: 0.0}
    pressed = find_meeting(holder, die, SQUEEZED * thickness, thickness)
    farthest = 0.0
    for index, stage in enumerate(case.stages):
        before = find_approach(holder, die, gone)
        if pushed := [name for name in gone if _is_pushed(stage, name)]:
            return _check_slam(case, index, pushed[0], holder, die, before)
        for name in gone:
            gone[name] += (stage.tools[name].stroke or 0.0) if name in stage.tools else 0.0
        after = find_approach(holder, die, gone)
        if pressed is not None and after > pressed.travel * (1 + 1e-9) + 1e-6 * thickness:
            return _explain_pressed(case, index, holder, die, pressed, after, before)
        farthest = max(farthest, after)
    idle = find_meeting(holder, die, IDLE * thickness, thickness)
    if idle is not None and idle.travel <= farthest:
        return None
    fault = f"the holder never comes nearer to the die than {IDLE:g} thicknesses: it holds nothing"
    remedy = f'close it in a stage (close = "{thickness:g} mm"), push it by a force, or leave the holder out'
    drawn = case.tools[holder.name]
    if drawn.gap is not None:
        remedy = f"take a gap near {thickness:g} mm, push it by a force, or leave the holder out"
        return Problem(f"tools.{holder.name}.gap", fault, remedy, drawn.gap)
    place = ".position" if drawn.position is not None else ""
    return Problem(f"tools.{holder.name}{place}", fault, remedy)


def _is_pushed(stage: StampingStage, name: str) -> bool:
    return name in stage.tools and stage.tools[name].force is not None


def _check_slam(case: StampingCase, index: int, name: str, holder: Tool, die: Tool, before: float) -> Problem | None:
    """Return a problem of a force that closes a binder over a long distance, in explicit dynamics."""
    thickness = case.blank.thickest
    near = find_meeting(holder, die, IDLE * thickness, thickness)
    if case.procedure == "implicit" or near is None or near.travel <= before:
        return None
    fault = (
        f"{holder.name} and {die.name} are {near.travel - before + (IDLE - 1.0) * thickness:.4g} mm from closed when "
        f"the force sets in, and would slam shut"
    )
    remedy = (
        f'close them by distance in a stage before: tools.{holder.name} = {{ close = "{1.05 * thickness:.3g} mm" }}'
    )
    return Problem(f"stages.{index}.tools.{name}.force", fault, remedy)


def _explain_pressed(
    case: StampingCase, index: int, holder: Tool, die: Tool, pressed: Closing, after: float, before: float
) -> Problem:
    """Explain a stroke after which die and holder leave too little room."""
    name = holder.name if holder.name in case.stages[index].tools else die.name
    x, y, z = pressed.place + np.asarray(die.position)
    thickness = case.blank.thickest
    fault = (
        f"the holder leaves less than {SQUEEZED:g} of the blank's {thickness:g} mm to the die at ({x:.4g}, {y:.4g}, "
        f"{z:.4g}) mm, and goes {after - pressed.travel:.4g} mm further"
    )
    remedy = (
        f'give close = "{1.05 * thickness:.3g} mm" instead of the stroke, shorten it by {after - pressed.travel:.4g} '
        "mm, or push the holder with a force"
    )
    stroke = case.stages[index].tools[name].stroke
    return Problem(f"stages.{index}.tools.{name}.stroke", fault, remedy, stroke)
