# SPDX-License-Identifier: Apache-2.0
"""Temperatures given to laws before and after an increment, and how far they may change (docs/theory/heat.md)."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from presswork.body.shells import ShellMechanics
from presswork.body.solids import Mechanics
from presswork.model import FloatArray, Model
from presswork.outcome import Converged, Failed, IterationLog, Step
from presswork.state import State

REFUSED = 1.5
"""Change of temperature over the largest allowed one above which an increment is repeated."""
LEAST_INCREMENTS = 20.0
"""Size of an increment over solver.min_increment below which it is accepted whatever its change of temperature."""


def find_change(model: Model, before: Sequence[FloatArray], after: Sequence[FloatArray], stage: int) -> float:
    """Return the largest change of a temperature given to a law in an increment, over that which may be.

    before, after: block by block [degrees C], empty where the law does not depend on them. Where nothing moves any
    change may be.
    """
    if model.heat is None or model.stages[stage].dwell:
        return 0.0
    pairs = zip(before, after, strict=True)
    return max((float(np.abs(a - b).max()) for a, b in pairs if a.size), default=0.0) / model.heat.max_change


def judge_change(
    model: Model, before: Sequence[FloatArray], after: Sequence[FloatArray], step: Step, log: IterationLog
) -> Converged | Failed:
    """Refuse an increment in which the temperatures given to laws change by much."""
    change = find_change(model, before, after, step.stage)
    shortest = LEAST_INCREMENTS * model.solver.min_increment * model.stages[step.stage].duration
    if change <= REFUSED or step.dt <= shortest:
        return Converged(log)
    return Failed(log, "temperatures change by much", max(0.9 / change, 0.2))


def find_temperatures(
    mechanics: Mechanics | ShellMechanics,
    at_points: Callable[[State, int], FloatArray] | None,
    state_n: State,
    trial: State,
) -> list[tuple[FloatArray, FloatArray] | None]:
    """Return temperatures of each block's points (n_cells, p) [degrees C] before and after an increment.

    at_points: those of a state's block by its heat, for laws that are not given any; None: there is no heat.
    """
    found: list[tuple[FloatArray, FloatArray] | None] = []
    for block, given in enumerate(trial.cells.temperature):
        if given.size:
            shape = trial.cells.eqps[block].shape
            before, after = (mechanics.temperature_at_points(s, block) for s in (state_n, trial))
            found.append((before.reshape(shape), after.reshape(shape)))
        else:
            found.append((at_points(state_n, block), at_points(trial, block)) if at_points else None)
    return found
