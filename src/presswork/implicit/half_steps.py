# SPDX-License-Identifier: Apache-2.0
"""How far the stress of a user's law (UMAT) is off by the length of an increment, by two half steps.

Such a law is only evaluated, never changed. With q the effective stress at the end of an increment of h seconds, q'
that after two steps of half the strain and half the time, a law of first order is off by 2 |q - q'|, one of higher
order by less.

Errors of later increments add up, and each forgets a part of those before: a perturbation shrinks by 1/(1 + z). With
q_0 the stress that the whole strain gives in next to no time, the answer to a slightly shorter increment shows z:

    1 + z = (q_0 - q)/|dq/d ln h|.

As in stress_error.py, a stress that is the m-th power of the rate relaxes along a curve, m = (q_0 - q)/(z q), and a
stress that rises approaches the flow stress, where the error is forgotten.

A law whose stress does not follow h at all is exact.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from presswork.body.shells import ShellMechanics
from presswork.body.solids import Mechanics
from presswork.fields.shell_fields import sheet_effective_stress
from presswork.fields.solid_fields import effective_stress
from presswork.implicit.stress_error import MEMORY, STEEPEST, root_mean
from presswork.model import FloatArray, Model
from presswork.outcome import Step
from presswork.state import State

SUDDEN = 1e-6
"""Part of its time in which an increment leaves nothing to flow."""
SHORTER = 1e-2
"""Part of its time that an increment is made shorter, to see whether the law follows time."""
FOLLOWS = 1e-6
"""Change of the stress over itself by that, below which it does not."""


class HalfSteps:
    """Estimates the error of the stress of a model's user laws."""

    def __init__(self, model: Model, mechanics: Mechanics | ShellMechanics) -> None:
        self._mechanics = mechanics
        materials = [model.materials[block.material] for block in model.mesh.blocks]
        self._blocks = [i for i, of in enumerate(materials) if of.umat is not None and of.gtn is None]

    def find(self, state_n: State, trial: State, step: Step, least: float) -> float:
        """Return the error of a completed trial state over its stress, of the block where it is largest.

        least: a stress [MPa] that counts as none.
        """
        if not self._blocks:
            return 0.0
        sooner = replace(step, dt=(1.0 - SHORTER) * step.dt)
        shorter = self._evaluate(state_n, trial, 1.0, sooner)
        if shorter is None or not any(self._follows(i, trial, shorter) for i in self._blocks):
            return 0.0
        dt = 0.5 * step.dt
        sudden = self._evaluate(state_n, trial, 1.0, replace(step, dt=SUDDEN * step.dt))
        half = self._evaluate(state_n, trial, 0.5, replace(step, dt=dt))
        if sudden is None or half is None:
            return 0.0
        self._mechanics.end_increment(state_n, half, dt)
        second = replace(step, dt=dt, time_n=step.time_n + dt, stage_time_n=step.stage_time_n + dt)
        twice = self._evaluate(half, trial, 0.5, second)
        if twice is None:
            return 0.0
        others = sudden, shorter, twice
        return max(self._find_of_block(i, state_n, trial, others, least) for i in self._blocks)

    def _evaluate(self, begin: State, trial: State, part: float, step: Step) -> State | None:
        """Return the cells after a part of a trial state's increment in the time of a step; None: the law fails."""
        end = trial.duplicate()
        end.nodes.increment = part * trial.nodes.increment
        self._mechanics.begin_increment(begin, step)
        failed = self._mechanics.evaluate(begin, end, end.nodes.increment, with_stiffness=False, dt=step.dt)
        if not isinstance(failed, np.ndarray):
            return None
        self._mechanics.complete(end)
        end.nodes.displacement = begin.nodes.displacement + end.nodes.increment
        return end

    def _follows(self, block: int, trial: State, shorter: State) -> bool:
        """Return whether the stress of a block follows the time of the increment."""
        stress = trial.cells.stress[block]
        change = float(np.abs(shorter.cells.stress[block] - stress).max())
        return change > FOLLOWS * float(np.abs(stress).max())

    def _find_of_block(
        self, block: int, state_n: State, trial: State, others: tuple[State, State, State], least: float
    ) -> float:
        """Return the error of a block; others: after the whole strain at once, and sooner, and after two half steps."""
        sudden, shorter, twice = others
        states = state_n, trial, sudden, shorter
        before, after, at_once, sooner = (_effective(state.cells.stress[block]) for state in states)
        off = 2.0 * _effective(trial.cells.stress[block] - twice.cells.stress[block])
        flown, slope = np.abs(at_once - after), np.abs(sooner - after) / SHORTER
        kept = np.minimum(np.divide(slope, flown, out=np.ones_like(slope), where=flown > 0.0), 1.0)
        z = np.divide(1.0 - kept, kept, out=np.zeros_like(kept), where=kept > 0.0)
        power = np.divide(flown, z * after, out=np.zeros_like(z), where=z * after > 0.0)
        summed = off / (1.0 - kept + 1.0 / MEMORY) / (1.0 - np.minimum(power, STEEPEST))
        summed = np.where(after < before, summed, np.where(z > 1.0, 0.0, off))
        volume = trial.cells.volume[block]
        stress = max(root_mean(volume, np.maximum(before, after)), least)
        return root_mean(volume, summed) / stress if stress > 0.0 else 0.0


def _effective(stress: FloatArray) -> FloatArray:
    return sheet_effective_stress(stress) if stress.shape[-1] == 3 else effective_stress(stress)
