# SPDX-License-Identifier: Apache-2.0
"""How long increments may be to be accurate: those that err by more than solver.increment_tolerance are taken again,
and the next follow the error (docs/theory/time_steps.md).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from presswork.body.shells import ShellMechanics
from presswork.body.solids import Mechanics
from presswork.implicit.half_steps import HalfSteps
from presswork.implicit.localisation import Localisation, note_localisation
from presswork.implicit.step_sizes import SMALLEST
from presswork.implicit.stress_error import StressError
from presswork.implicit.temperature_change import find_change
from presswork.model import Model
from presswork.outcome import Converged, Failed, IterationLog, Step, TooCoarse
from presswork.state import RUN, Arrays, OnNewMesh, State

AIM = 0.9
"""Part of the tolerance that the next increment is to meet."""
REFUSED = 1.5
"""Error over the tolerance above which an increment is repeated."""
SHRINK = 0.02
"""Least part of an increment that is tried next."""
SHORTEST = 1e-9
"""Part of a stage that is taken whatever its error."""
NOTHING = 0.01
"""Part of the largest stress so far that counts as none."""


@dataclass
class AccuracyArrays(Arrays):
    """What errors are compared with."""

    owner = "accuracy"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {"largest_stress": RUN}
    largest_stress: float = 0.0
    """Mean effective stress of a body that depends on the rate, the largest so far [MPa]."""


class Accuracy:
    """Judges increments by their error."""

    def __init__(self, model: Model, mechanics: Mechanics | ShellMechanics) -> None:
        self._model, self._stress, self._user_laws = model, StressError(model, mechanics), HalfSteps(model, mechanics)
        self._error = 0.0

    @staticmethod
    def at_rest() -> tuple[Arrays, Arrays]:
        """Return the arrays of a run that has not begun."""
        return AccuracyArrays(), Localisation()

    def correct(self, state_n: State, trial: State, step: Step) -> None:
        """Take errors that are known off a completed trial state, and keep what is left for judge() and limit()."""
        self._error = 0.0
        kept, tolerance = trial[AccuracyArrays], self._model.solver.increment_tolerance
        kept.largest_stress = max(kept.largest_stress, self._stress.mean_stress(trial))
        if step.dt == 0.0 or self._model.stages[step.stage].dwell is not None:
            return
        if step.fraction - step.fraction_n > SMALLEST * self._model.solver.min_increment:
            # in less, what equilibrium leaves out counts as flow
            self._error = np.sqrt(self._stress.find_of_flow(state_n, trial, step.dt) / tolerance)
        of_stress = self._stress.correct(state_n, trial, NOTHING * kept.largest_stress) / tolerance
        of_user = self._user_laws.find(state_n, trial, step, NOTHING * kept.largest_stress) / tolerance
        self._error = max(self._error, of_stress, of_user)

    def judge(self, step: Step, log: IterationLog) -> Converged | Failed:
        """Refuse an increment that errs by much."""
        if self._error > REFUSED and step.fraction - step.fraction_n > SHORTEST:
            off = 100 * self._model.solver.increment_tolerance * self._error
            return TooCoarse(log, f"its length makes an error of {off:.2g} %", max(AIM / self._error, SHRINK))
        return Converged(log)

    def limit(self, state_n: State, trial: State, step: Step, size: float) -> float:
        """Return the part of the stage that the increment after a converged one may take; size: without an error.

        Arc length has sizes of its own.
        """
        if self._model.solver.control == "arc_length":
            return size
        last, settings = step.fraction - step.fraction_n, self._model.solver
        smallest = min(size, SMALLEST * settings.min_increment)
        change = find_change(self._model, state_n.cells.temperature, trial.cells.temperature, step.stage)
        if change > 0.0:
            size = max(min(size, last / change), smallest)
        note_localisation(state_n, trial, step)
        growth = trial[Localisation].rate
        if growth > 0.0:
            size = max(min(size, 2.0 * settings.increment_tolerance / growth), smallest)
        if self._error > 0.0:
            size = min(size, AIM * last / self._error)
        return size
