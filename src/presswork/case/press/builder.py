# SPDX-License-Identifier: Apache-2.0
"""Turns the presses of a case into the drives of the Model's stages."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from presswork import model
from presswork.case.errors import Problem, suggest
from presswork.case.press.schema import CrankPress, EnergyPress, HydraulicPress, Press, Speeds, StagePress, tabulate

KILO = 1e6
"""N mm/s in a kW."""
KILO_JOULE = 1e6
"""Energy in a kJ [N mm]."""


@dataclass(frozen=True)
class Timing:
    """Timing of a stage in a case."""

    key: str
    """Key of the stage, e.g. `stages.0`."""
    velocity: Speeds | None
    press: StagePress | None
    has_duration: bool
    travel: float
    """Travel of the tool that moves farthest [mm]; 0 where none moves."""


@dataclass(frozen=True)
class Halves:
    """Factors of the whole press that follow from symmetry planes."""

    whole: float = 1.0
    """The whole workpiece over what is modelled."""
    across: float = 1.0
    """Travel of the ram over that of the tools: 2 where a symmetry plane lies across it."""


def find_halves(stage: model.Stage, mirrors: Sequence[model.FloatArray]) -> Halves:
    """Return the factors that symmetry planes set for the press of a stage; mirrors: their positions by axis [mm]."""
    d = len(mirrors)
    moves = np.array([motion.move[:d] for motion in stage.tool_motion.values()]).reshape(-1, d)
    cut = [len(np.unique(of_axis)) == 1 for of_axis in mirrors]  # between two planes nothing is cut in half
    along = [bool(moves[:, axis].any()) and not np.delete(moves, axis, axis=1).any() for axis in range(d)]
    across = any(is_cut and is_along for is_cut, is_along in zip(cut, along, strict=True))
    return Halves(float(2 ** sum(cut)), 2.0 if across else 1.0)


def check_timing(timing: Timing, presses: Mapping[str, Press]) -> Iterator[Problem]:
    """Yield the problems of a stage's time that show without the mesh."""
    key, press = timing.key, timing.press
    if press is None and timing.velocity is None:
        return
    name = "press" if press is not None else "velocity"
    if press is not None and timing.velocity is not None:
        yield Problem(f"{key}.velocity", "the press gives the speed", "leave velocity or press out")
    if timing.has_duration:
        yield Problem(f"{key}.duration", f"its time follows from {name}", f"leave duration or {name} out")
    if timing.travel == 0.0:
        yield Problem(f"{key}.{name}", "no tool moves in this stage", "give a tool a stroke or move")
    if press is None:
        return
    if press.name not in presses:
        yield Problem(f"{key}.press", "no such press", suggest(press.name, presses, "presses"), press.name)
        return
    kind = presses[press.name].kind
    of_cranks = [k for k in ("before_bottom", "angle_before_bottom") if getattr(press, k) is not None]
    of_blows = [k for k in ("blows", "pause") if k in press.model_fields_set]
    for keys, fits in ((of_cranks, kind == "crank"), (of_blows, kind in ("hammer", "screw"))):
        for k in keys if not fits else ():
            yield Problem(f"{key}.press.{k}", f"has no meaning for a press of kind {kind}", "leave it out")


def check_in_explicit(key: str, press: Press, stage_press: StagePress, *, blows: bool) -> list[Problem]:
    """Return the problem of a press in an explicit stage; blows: whether a single blow can be computed."""
    remedy, name = 'take a crank or a given speed, or procedure = "implicit"', stage_press.name
    if isinstance(press, EnergyPress) and not blows:
        return [Problem(f"{key}.press", "the explicit procedure of sheets has no blows by energy", remedy, name)]
    if isinstance(press, EnergyPress) and stage_press.blows > 1:
        fault = "in the explicit procedure a tool goes on from where it is, so there is one blow"
        return [Problem(f"{key}.press.blows", fault, 'leave it out, or set procedure = "implicit"', stage_press.blows)]
    if isinstance(press, HydraulicPress) and (press.force or press.power):
        return [Problem(f"{key}.press", "the explicit procedure has no limits of force and power", remedy, name)]
    return []


def build_drive(timing: Timing, presses: Mapping[str, Press], halves: Halves) -> model.Drive | Problem | None:
    """Return the ram that drives a stage; None of a stage that has none."""
    travel = timing.travel * halves.across
    if timing.velocity is not None:  # of the tool itself
        return model.Drive(tabulate(timing.velocity), timing.travel, halves.whole)
    if timing.press is None:
        return None
    name, whole = timing.press.name, halves.whole
    press = presses[name]
    if isinstance(press, HydraulicPress):
        force, power = press.force or math.inf, (press.power or math.inf) * KILO
        return model.Drive(tabulate(press.velocity), travel, whole, name, force, power)
    if isinstance(press, EnergyPress):
        return model.Drive(press.strike(1), travel, whole, name, rated_force=press.force or math.inf)
    return _place_crank(timing, timing.press, press, travel, whole)


def _place_crank(
    timing: Timing, placed: StagePress, press: CrankPress, travel: float, whole: float
) -> model.Drive | Problem:
    """Return the ram of a crank press, or the problem that its stroke is too short."""
    start, key = travel, "press"
    if placed.before_bottom is not None:
        start, key = placed.before_bottom, "press.before_bottom"
    elif placed.angle_before_bottom is not None:
        start = press.place(0.0).height_at(math.radians(placed.angle_before_bottom))
        key = "press.angle_before_bottom"
    if start > press.stroke * (1.0 + 1e-12):
        text = f"the stroke of the press is {press.stroke:g} mm, too short for a ram {start:.6g} mm before the bottom"
        remedy = "shorten the tools' travel, or take a press with a longer stroke"
        return Problem(f"{timing.key}.{key}", text, remedy, placed.name)
    if start < travel * (1.0 - 1e-12):
        twice = ", twice the tool's for the mirror image beyond the symmetry plane" if travel > timing.travel else ""
        text = f"the ram turns round at bottom dead centre after {start:.6g} mm, its travel is {travel:.6g} mm{twice}"
        remedy = "begin farther from bottom dead centre, or shorten the tools' travel"
        return Problem(f"{timing.key}.{key}", text, remedy)
    force, energy = press.force or math.inf, (press.energy or math.inf) * KILO_JOULE
    crank = press.place(min(start, press.stroke))
    return model.Drive(crank, travel, whole, placed.name, rated_force=force, rated_energy=energy)


def list_blows(stage: model.Stage, press: StagePress | None, first: int) -> list[model.Stage]:
    """Return the stages that a stage of several blows consists of: between two blows the tools go back.

    first: number of the first of them, counted over the blows of its press.
    """
    if stage.drive is None or not isinstance(stage.drive.motion, model.Blow) or press is None:
        return [stage]
    found: list[model.Stage] = []
    for number in range(press.blows):
        blow = replace(stage.drive, motion=replace(stage.drive.motion, number=first + number))
        name = stage.name if press.blows == 1 else f"{stage.name} {number + 1}"
        motions = dict(stage.tool_motion)
        if number > 0:
            motions = {n: replace(m, start="touch_again") if any(m.move) else m for n, m in motions.items()}
            back = {n: model.ToolMotion(move=tuple(0.0 - x for x in m.move)) for n, m in stage.tool_motion.items()}
            pause = press.pause or model.Stage("").duration
            found.append(
                model.Stage(f"{stage.name}, pause {number}", duration=pause, tool_motion=back, released=stage.released)
            )
        found.append(replace(stage, name=name, drive=blow, tool_motion=motions))
    return found
