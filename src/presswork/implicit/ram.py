# SPDX-License-Identifier: Apache-2.0
"""The ram of a press in the implicit procedure: what time an increment takes, and when a stage ends early.

The ram's motion is integrated with the increments: m v dv = -F ds, with the force F of the workpiece on all tools that
move. Work is added up by the trapezoidal rule; an increment takes the time 2 ds / (v_n + v), exact for constant force,
with v predicted by the force at its start, so that laws and heat see one time through all iterations. A blow ends when
its energy is spent, a stage with a limit of force when this is reached; the increment that passes either is tried again
with the part of it that fits.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from presswork.implicit.energy import Work
from presswork.interaction.tool_arrays import SpaceToolArrays, ToolArrays
from presswork.model import Blow, Drive, FloatArray, Model, SpeedTable, ToolMotion
from presswork.outcome import Step
from presswork.state import RUN, Arrays, OnNewMesh, State

SPENT = 1e-5
"""Part of the energy of a blow, or of a limit of force, that may be missing or too much."""
UNSURE = 5e-4
"""Part of the energy of a blow that the change of force over an increment times half the travel is at most: where force
rises to the yield point, or dies close, the trapezoidal rule might miss that much."""
LEAST = 1e-9
"""Smallest increment, over a stage, that is made to meet an end."""


@dataclass
class RamArrays(Arrays):
    """What the ram has done."""

    owner = "ram"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = dict.fromkeys(
        ("speed", "force", "work", "stage_work", "stage_time", "plastic_n", "plastic_share"), RUN
    )
    plastic_share: FloatArray
    """Plastic work over the work of the ram in each stage that is over (n_stages,)."""
    speed: float = 0.0
    """[mm/s]; 0 in a stage without a ram."""
    force: float = 0.0
    """Force of the workpiece against the whole ram [N]."""
    work: float = 0.0
    """Since the start [N mm]."""
    stage_work: float = 0.0
    """Work in the present stage [N mm]."""
    stage_time: float = 0.0
    """Since the present stage began [s]."""
    plastic_n: float = 0.0
    """Plastic work when the present stage began [N mm]."""


class Ram:
    """Times the increments of a model's stages that a ram drives."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self._drives = [stage.drive for stage in model.stages]
        self.is_needed = any(drive is not None for drive in self._drives)

    def at_rest(self) -> RamArrays:
        """Return the arrays of a ram that has not moved."""
        return RamArrays(np.zeros(len(self._drives)))

    def take_time(self, start: State, stage: int, fraction_n: float, fraction: float, *, to_rest: bool) -> float:
        """Return the time of an increment [s]. start: the converged state, as the stage has changed it at its begin.

        to_rest: whether the increment is meant to end a blow.
        """
        drive = self._drives[stage]
        if drive is None or drive.is_prescribed or fraction == fraction_n:
            return self._model.stages[stage].time_between(fraction_n, fraction)
        travel, force = (fraction - fraction_n) * drive.travel, self.find_force(start, stage)
        if isinstance(drive.motion, Blow):
            left = drive.motion.energy - self._spent(start, fraction_n)
            speeds = [drive.motion.speed_with(energy) for energy in (left, 0.0 if to_rest else left - force * travel)]
            return 2.0 * travel / sum(speeds)
        return max(drive.time_between(fraction_n, fraction), force * travel / drive.power)

    def stage_time(self, state: State, stage: int, fraction_n: float) -> float:
        """Return the time since the stage began [s]."""
        if self._drives[stage] is None or fraction_n == 0.0:
            return self._model.stages[stage].duration * fraction_n
        return state[RamArrays].stage_time

    def longest(self, start: State, stage: int, fraction_n: float) -> float:
        """Return the part of the stage after which its end is predicted by the present force."""
        drive = self._drives[stage]
        if drive is None or not isinstance(drive.motion, Blow):
            return math.inf
        left, force = drive.motion.energy - self._spent(start, fraction_n), self.find_force(start, stage)
        return max(left / (force * drive.travel), LEAST) if force > 0.0 else math.inf

    def shorten(self, start: State, trial: State, step: Step) -> tuple[float, bool] | None:
        """Return the part of the stage to try instead, and whether it is to end it, else None.

        So where a converged increment passes the end of a blow or a limit of force, or where force changes too much.
        """
        drive, size = self._drives[step.stage], step.fraction - step.fraction_n
        if drive is None or not drive.may_end_early or size <= LEAST:
            return None
        force_n, force = self.find_force(start, step.stage), self.find_force(trial, step.stage)
        part, ends = 1.0, True
        if isinstance(drive.motion, Blow):
            travel, energy = size * drive.travel, drive.motion.energy
            left = energy - self._spent(start, step.fraction_n)
            unsure = 0.5 * abs(force - force_n) * travel
            if unsure > UNSURE * energy * (1.0 + SPENT):
                part, ends = UNSURE * energy / unsure, False
            elif (
                0.5 * (force_n + force) * travel > left + SPENT * energy
            ):  # left = force_n s + (force - force_n)/way s^2/2
                # left = force_n s + (force - force_n) / way s^2 / 2
                root = math.sqrt(max(force_n**2 + 2.0 * (force - force_n) / travel * left, 0.0))
                part = 2.0 * left / ((force_n + root) * travel)
        elif force > drive.force * (1.0 + SPENT):
            part = (drive.force - force_n) / (force - force_n) if force > force_n else 0.5
        return (max(min(part, 1.0 - SPENT), 1e-3) * size, ends) if part < 1.0 else None

    def is_over(self, trial: State, stage: int) -> bool:
        """Return whether a stage ends with this state, though its travel is not complete."""
        drive = self._drives[stage]
        if drive is None or not drive.may_end_early:
            return False
        now = trial[RamArrays]
        if isinstance(drive.motion, Blow):
            return now.stage_work >= drive.motion.energy * (1.0 - SPENT)
        return now.force >= drive.force * (1.0 - SPENT)

    def strikes(self, stage: int) -> bool:
        """Return whether a stage is a blow."""
        drive = self._drives[stage]
        return drive is not None and isinstance(drive.motion, Blow)

    def find_excess(self, start: State, trial: State, step: Step) -> float:
        """Return the work [N mm] or force [N] of an increment in equilibrium beyond that which ends its stage."""
        drive = self._drives[step.stage]
        assert drive is not None, "a stage without a ram"
        force = self.find_force(trial, step.stage)
        if not isinstance(drive.motion, Blow):
            return force - drive.force
        travel = (step.fraction - step.fraction_n) * drive.travel
        mean = 0.5 * (self.find_force(start, step.stage) + force)
        return self._spent(start, step.fraction_n) + mean * travel - drive.motion.energy

    def commit(self, start: State, trial: State, step: Step) -> None:
        """Add up work and time of a converged increment. trial: a copy of start before."""
        now, drive = trial[RamArrays], self._drives[step.stage]
        if step.fraction_n == 0.0:
            now.stage_work, now.stage_time, now.plastic_n = 0.0, 0.0, start[Work].plastic_work
        now.stage_time += step.dt
        now.speed, now.force = 0.0, 0.0
        if drive is None:
            return
        now.force = self.find_force(trial, step.stage)
        travel = (step.fraction - step.fraction_n) * drive.travel
        work = 0.5 * (self.find_force(start, step.stage) + now.force) * travel
        now.work += work
        now.stage_work += work
        now.speed = self._find_speed(drive, step.fraction * drive.travel, now)
        if now.stage_work > 0.0:
            plastic = drive.whole * (trial[Work].plastic_work - now.plastic_n)
            now.plastic_share[step.stage] = plastic / now.stage_work

    def find_force(self, state: State, stage: int) -> float:
        """Return the force against the ram [N]: its work is that of all tools that move, with their mirror images."""
        drive = self._drives[stage]
        assert drive is not None, "a stage without a ram"
        motions = self._model.stages[stage].tool_motion
        moves = [np.array(motions.get(t.name, ToolMotion()).move) for t in self._model.tools]
        if ToolArrays in state:
            forces = np.pad(state[ToolArrays].force[:, :2], ((0, 0), (0, 1)))
        elif SpaceToolArrays in state:
            forces = -state[SpaceToolArrays].force.sum(axis=1)
        else:
            return 0.0
        work = sum(float(force @ move) for force, move in zip(forces, moves, strict=True))
        return -drive.whole * work / drive.travel

    @staticmethod
    def _spent(state: State, fraction_n: float) -> float:
        """Return the work of the ram in the stage so far [N mm]."""
        return state[RamArrays].stage_work if fraction_n > 0.0 else 0.0

    @staticmethod
    def _find_speed(drive: Drive, travel: float, now: RamArrays) -> float:
        """Return the speed of the ram [mm/s]."""
        if isinstance(drive.motion, Blow):
            left = drive.motion.energy - now.stage_work
            return drive.motion.speed_with(left) if left > SPENT * drive.motion.energy else 0.0
        speed = drive.motion.speed_at(travel)
        if isinstance(drive.motion, SpeedTable) and now.force > 0.0:
            return min(speed, drive.power / now.force)
        return speed
