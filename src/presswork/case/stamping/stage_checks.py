# SPDX-License-Identifier: Apache-2.0
"""Checks of a stamping's stages that show without geometry: names, what each tool does, timing, presses."""

from __future__ import annotations

from presswork.case.errors import Problem, suggest
from presswork.case.press.builder import check_in_explicit, check_timing
from presswork.case.stamping.schema import StampingCase
from presswork.case.stamping.stage import ACTIONS, VELOCITY, StampingStage


def check_stages(case: StampingCase) -> list[Problem]:
    """Return the problems of all stages."""
    problems: list[Problem] = []
    names = [stage.name for stage in case.stages]
    for index, stage in enumerate(case.stages):
        key = f"stages.{index}"
        if stage.name in names[:index]:
            problems.append(Problem(f"{key}.name", "two stages have this name", "give each its own", stage.name))
        problems += [
            Problem(f"{key}.tools.{tool}", "no such tool", suggest(tool, case.tools, "tools"))
            for tool in stage.tools
            if tool not in case.tools
        ]
        problems += _check_actions(case, key, stage) + _check_timing(key, stage) + _check_press(case, index, stage)
    return problems


def _check_actions(case: StampingCase, key: str, stage: StampingStage) -> list[Problem]:
    """Return the problems of tools that a stage names without an action."""
    problems = []
    for name, action in stage.tools.items():
        if name in case.tools and all(getattr(action, each) is None for each in ACTIONS):
            usual = "force = 20000" if case.tools[name].kind == "holder" else "stroke = 25"
            remedy = f"for instance {usual}; leave {name} out where it stands still"
            problems.append(Problem(f"{key}.tools.{name}.{usual.split()[0]}", "no motion given", remedy))
    return problems


def _check_press(case: StampingCase, index: int, stage: StampingStage) -> list[Problem]:
    """Return the problems of the press of a stage."""
    problems = list(check_timing(stage.find_timing(index), case.presses))
    if problems or stage.press is None:
        return problems
    key = f"stages.{index}"
    if stage.press.blows > 1:
        fault = "the tools of a stamping cannot be placed anew for a second blow"
        problems.append(Problem(f"{key}.press.blows", fault, "take one blow", stage.press.blows))
    if stage.displacement:
        fault = "the blank itself is moved, whose work is not the ram's"
        problems.append(Problem(f"{key}.displacement", fault, "give it a stage of its own"))
    if case.procedure == "explicit":
        problems += check_in_explicit(key, case.presses[stage.press.name], stage.press, blows=False)
    return problems


def _check_timing(key: str, stage: StampingStage) -> list[Problem]:
    """Return the problems of a stage's motions in time."""
    if stage.dwell is not None:
        return []
    strokes = [abs(a.stroke) for a in stage.tools.values() if a.stroke]
    distances = [abs(action.travel) for action in stage.tools.values()]
    farthest = max([*distances, *(abs(e.value) for e in stage.displacement)], default=0.0)
    problems = []
    for name, action in stage.tools.items():
        if isinstance(action.force, tuple) and not strokes:
            fault, remedy = "a table over the stroke, but no tool moves in this stage", "give one force"
            problems.append(Problem(f"{key}.tools.{name}.force", fault, remedy))
    if farthest == 0.0 and stage.duration is None:
        remedy = "give a tool a stroke ([stages.tools.NAME]), or the stage a duration"
        problems.append(Problem(key, f'nothing moves in the stage "{stage.name}", so its duration is unknown', remedy))
    elif stage.ramp is not None:
        speed = stage.velocity or VELOCITY
        longest = 0.5 * stage.duration if stage.duration is not None else farthest / speed
        if stage.ramp > longest * (1 + 1e-12):
            what = f"{stage.duration:g} s" if stage.duration is not None else f"{farthest:g} mm at {speed:g} mm/s"
            fault = f"the smooth start and end do not fit into {what}"
            problems.append(Problem(f"{key}.ramp", fault, f"take at most {longest:.3g} s", stage.ramp))
    return problems
