# SPDX-License-Identifier: Apache-2.0
"""How the tools of a stamping come together along their motion: one rule for drawn tools and those from files.

Between punch and die the sheet must have room: its thickness where faces come together, and where walls slide along
each other at least what ironing leaves of it. Holders and punches may touch. The check compares surfaces, whatever they
are made from.
"""

from __future__ import annotations

import itertools
import logging
from collections.abc import Mapping, Sequence

import numpy as np

from presswork.case.errors import Problem
from presswork.case.stamping.schema import StampingCase
from presswork.case.stamping.tools import ToolFile
from presswork.mesh.tool_clearance import Closing, Room, find_closing
from presswork.model import Surface, SweptProfile, Tool

logger = logging.getLogger(__name__)

IRONED = 0.6
"""Part of the thickness that must be left between punch and die where they iron the sheet: less tears it."""
CLOSED = 0.95
"""Part of the thickness that must be left between punch and die: shells are not squeezed thinner, and neither rolled
sheet nor the facets of tools are truer."""
STEP = 0.5
"""Part of the thickness by which tools advance as they are held against each other."""
DRAWN_WITHIN = 0.02
"""Part of the thickness by which the points of drawn tools may be off there."""
OPEN = 0.1
"""Part of the thickness by which tools that press the sheet may be apart beyond it: the sheet is no flatter."""


def check_pairs(case: StampingCase, tools: Sequence[Tool]) -> list[Problem]:
    """Return the problems of punches with dies and holders: too little room on the path, or too much at its end."""
    moved = {tool.name: list_strokes(case, tool.name) for tool in tools}
    problems = []
    for one, other in itertools.permutations(tools, 2):
        if (one.kind, other.kind) not in (("punch", "die"), ("punch", "holder")) or _share_line(case, one, other):
            continue
        if is_pushed(case, one.name) or (other.kind == "die" and is_pushed(case, other.name)):
            continue
        closing = find_closing_stroke(one, other, case.blank.thickest, irons=case.irons)
        if closing is None:
            continue
        problem = _check_pair(case, one, other, moved, closing)
        if problem is None and other.kind == "die":
            problems += _check_dwells(case, one, other, moved, closing)
        elif problem and case.limits.stop:
            problems.append(problem)
        elif problem:
            logger.warning("%s: %s", problem.key, problem.expected)
    return problems


def _check_dwells(
    case: StampingCase, one: Tool, other: Tool, moved: dict[str, list[float]], closing: Closing
) -> list[Problem]:
    """Return the problems of stages in which tools press the sheet that have not closed on it."""
    thickness, problems = case.blank.thickest, []
    for index, stage in enumerate(case.stages):
        if stage.dwell is None or not stage.dwell.pressure:
            continue
        gone = find_approach(one, other, {name: moved[name][index] for name in moved})
        left = closing.travel - gone - (1.0 - CLOSED) * thickness
        if left > OPEN * thickness:
            fault = (
                f"tools are to press with {stage.dwell.pressure:g} MPa, but {one.name} and {other.name} are {left:.4g} "
                f"mm from closing on the sheet: they would after {closing.travel - (1.0 - CLOSED) * thickness:.4g} mm "
                f"of stroke, and go {gone:.4g} mm"
            )
            remedy = "lengthen the stroke; or leave pressure out: then heat flows by what the stage before left"
            problems.append(Problem(f"stages.{index}.dwell.pressure", fault, remedy, stage.dwell.pressure))
    return problems


def list_strokes(case: StampingCase, name: str) -> list[float]:
    """Return the travel of a tool at the end of each stage [mm]; zero for a pushed one."""
    each = [stage.tools[name].stroke or 0.0 if name in stage.tools else 0.0 for stage in case.stages]
    return list(itertools.accumulate(each))


def is_pushed(case: StampingCase, name: str) -> bool:
    return any(name in s.tools and s.tools[name].force is not None for s in case.stages)


def _share_line(case: StampingCase, one: Tool, other: Tool) -> bool:
    """Return whether two tools are the inside and the outside of one line in the plan: they pass each other."""
    drawn = case.tools[one.name], case.tools[other.name]
    lines = [tool.cut for tool in drawn if isinstance(tool, ToolFile) and tool.direction is None and tool.cut]
    if len(lines) < 2 or lines[0].keep == lines[1].keep or tuple(one.position[:2]) != tuple(other.position[:2]):
        return False
    return lines[0].model_copy(update={"keep": lines[1].keep}) == lines[1]


def _check_pair(
    case: StampingCase, one: Tool, other: Tool, moved: dict[str, list[float]], closing: Closing
) -> Problem | None:
    """Return a problem where two tools close on each other or on the sheet between them before their strokes end."""
    along = float(np.dot(np.array(other.working_direction), np.array(one.working_direction)))
    if abs(along) < 1.0 - 1e-9 and any(moved[other.name]):
        return None  # how two that move aslant to each other meet is not looked for
    before = {tool.name: 0.0 for tool in (one, other)}
    for index, _ in enumerate(case.stages):
        after = {tool.name: moved[tool.name][index] for tool in (one, other)}
        start, end = (find_approach(one, other, travel) for travel in (before, after))
        if end <= closing.travel:
            before = after
            continue
        part = (closing.travel - start) / (end - start)
        travel = {name: before[name] + part * (after[name] - before[name]) for name in before}
        mover = one.name if one.name in case.stages[index].tools else other.name
        x, y, z = closing.place + np.asarray(other.position) + travel[other.name] * np.asarray(other.working_direction)
        beyond = end - closing.travel
        room = "strikes" if other.kind != "die" else f"leaves less than the blank's {case.blank.thickest:g} mm to"
        fault = (
            f"after {abs(travel[one.name]):.4g} mm of stroke {one.name} {room} {other.name} at ({x:.4g}, {y:.4g}, "
            f"{z:.4g}) mm, and goes {beyond:.3g} mm further"
        )
        remedy = (
            f"shorten the stroke to {travel[mover] - before[mover]:.4g}, or see that {one.name} and {other.name} fit, "
            "not swapped; limits.stop = false runs it anyway"
        )
        return Problem(f"stages.{index}.tools.{mover}.stroke", fault, remedy, after[mover] - before[mover])
    return None


def find_closing_stroke(one: Tool, other: Tool, thickness: float, *, irons: bool) -> Closing | None:
    """Return the travel after which a tool closes on another, or on the sheet between it and a die.

    irons: whether the sheet may be squeezed between walls that slide along each other. None where they never close,
    and for drawn tools with the same middle and an opening that goes right through, whose clearance in the plan is
    checked exactly.
    """
    is_exact = isinstance(one.shape, SweptProfile) and isinstance(other.shape, SweptProfile)
    is_exact &= tuple(one.position[:2]) == tuple(other.position[:2])
    if is_exact and (other.kind != "die" or not _has_bottom(other.surface)):
        return None
    room = Room(0.0, 0.0)
    if other.kind == "die":
        room = Room(CLOSED * thickness, (IRONED - 2.0 * DRAWN_WITHIN if irons else CLOSED) * thickness)
    return find_meeting(one, other, room, thickness)


def find_meeting(one: Tool, other: Tool, room: float | Room, thickness: float) -> Closing | None:
    """Return where a tool from its start first leaves less than a room [mm] to another."""
    between, direction = np.subtract(one.position, other.position), np.array(one.working_direction)
    return find_closing(
        one.surface, other.surface, between, direction, DRAWN_WITHIN * thickness, room, STEP * thickness
    )


def find_approach(one: Tool, other: Tool, gone: Mapping[str, float]) -> float:
    """Return the approach of two tools along the direction of the first [mm]; gone: of each along its own."""
    along = float(np.dot(np.array(other.working_direction), np.array(one.working_direction)))
    return gone[one.name] - along * gone[other.name]


def _has_bottom(shape: Surface) -> bool:
    """Return whether a drawn tool's profile reaches its middle."""
    if not isinstance(shape, SweptProfile):
        return False
    return float(shape.segments[:, [0, 2]].min()) <= -min(shape.half_widths) * (1.0 - 1e-9)
