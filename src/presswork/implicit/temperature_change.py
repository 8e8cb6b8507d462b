# SPDX-License-Identifier: Apache-2.0
"""How far temperatures given to laws may change in an increment (docs/theory/heat.md)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from presswork.model import FloatArray, Model
from presswork.outcome import Converged, Failed, IterationLog, Step

REFUSED = 1.5
"""Times the largest change of temperature: an increment that is taken again."""
LEAST_INCREMENTS = 20.0
"""Times solver.min_increment: an increment that is taken whatever its change of temperature."""


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
