# SPDX-License-Identifier: Apache-2.0
"""Turns the stages of a stamping's case into the Model's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from presswork import model
from presswork.case.errors import Problem
from presswork.case.held_stages import list_released
from presswork.case.press.builder import Halves, build_drive
from presswork.case.settings import RAMP
from presswork.case.shell.schema import FREEDOMS
from presswork.case.stamping.beads import closed_stages
from presswork.case.stamping.place import find_tool_direction
from presswork.case.stamping.schema import StampingCase
from presswork.case.stamping.stage import VELOCITY, StampingStage

SOFT = 0.5
"""Part of a stage's time in which a tool that closes by distance starts, and in which it stops."""


def build_stages(case: StampingCase) -> tuple[tuple[model.Stage, ...], list[Problem]]:
    """Return the Model's stages, and the problems of presses."""
    stages, problems = [], []
    for number, stage_case in enumerate(case.stages):
        stage = build_stage(stage_case, case)
        drive = build_drive(stage_case.find_timing(number), case.presses, Halves())
        if isinstance(drive, Problem):
            problems.append(drive)
        elif drive is not None:
            stage = replace(stage, drive=drive, duration=drive.duration, ramp=RAMP * drive.duration)
        stages.append(stage)
    return tuple(stages), problems


def build_stage(stage: StampingStage, case: StampingCase) -> model.Stage:
    """Turn a stage of a case into the Model's."""
    moved = [action.travel for action in stage.tools.values() if action.travel]
    moved += [e.value for e in stage.displacement]
    farthest = max((abs(m) for m in moved), default=0.0)
    smooth = SOFT if any(action.closes_softly for action in stage.tools.values()) else RAMP
    if stage.dwell is not None:
        duration, ramp = stage.dwell.duration, RAMP * stage.dwell.duration
    elif stage.duration is not None:
        duration = stage.duration
        ramp = smooth * duration if stage.ramp is None else stage.ramp
    else:
        cruise = farthest / (stage.velocity or VELOCITY)  # its time at full speed
        ramp = cruise * smooth / (1 - smooth) if stage.ramp is None else stage.ramp
        duration = cruise + ramp
    longest = max((abs(a.stroke) for a in stage.tools.values() if a.stroke), default=0.0)
    motions = {}
    for name, action in stage.tools.items():
        x, y, z = find_tool_direction(case.tools[name])
        if isinstance(action.force, tuple):
            rows = np.array(action.force, dtype=float)
            push = model.Push((x, y, z), np.column_stack([rows[:, 0] / longest, rows[:, 1]]))
            motions[name] = model.ToolMotion(push=push)
        elif action.force is not None:
            motions[name] = model.ToolMotion(push=model.Push((x, y, z), np.array([[0.0, action.force]])))
        else:
            stroke = action.travel
            motions[name] = model.ToolMotion((stroke * x, stroke * y, stroke * z))
    prescribed = [(e.set, FREEDOMS.index(e.component), e.value) for e in stage.displacement]
    shares = {f"bead_{i + 1}": float(stage.name in closed_stages(bead, case)) for i, bead in enumerate(case.beads)}
    return model.Stage(
        name=stage.name,
        duration=duration,
        ramp=ramp,
        tool_motion=motions,
        bead_share={name: np.array([[0.0, share]]) for name, share in shares.items()},
        prescribed=tuple(model.PrescribedDisplacement(*entry) for entry in prescribed),  # type: ignore[arg-type]
        process_time=stage.process_time,
        released=list_released(case.boundary, stage.name),
        dwell=stage.dwell.to_model() if stage.dwell else None,
    )
