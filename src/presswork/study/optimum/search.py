# SPDX-License-Identifier: Apache-2.0
"""What the methods of optimisation share: outcomes of runs in the unit box, and which of two is better."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from presswork.model import FloatArray


class SpentError(Exception):
    """All runs that the study allows are used."""


@dataclass(frozen=True)
class Outcome:
    """Result of one run for the optimum."""

    x: FloatArray
    """The variables as parts of their ranges, 0 to 1 (n_variables,)."""
    goal: float
    """The sum of the goals, to be small; NaN of a run without results."""
    excess: FloatArray
    """Excess over each side of each limit (n_sides,): at most 0 where it holds; NaN without results."""
    slope: FloatArray | None = None
    """Slope of the goal over the variables' ranges (n_variables,), where the run has found it."""
    slopes: FloatArray | None = None
    """Slopes of the excess, in the same form (n_sides, n_variables)."""

    @property
    def is_known(self) -> bool:
        """Whether the run has results."""
        return bool(np.isfinite(self.goal) and np.isfinite(self.excess).all())

    @property
    def is_feasible(self) -> bool:
        """Whether the run has results that keep all limits."""
        return self.is_known and bool((self.excess <= 0.0).all())


Evaluate = Callable[[Sequence[FloatArray]], list[Outcome]]
"""Runs the cases of points of the unit box, at a time, and returns their outcomes. Raises SpentError."""


def find_best(outcomes: Sequence[Outcome]) -> int | None:
    """Return the place of the feasible outcome of the least goal, the first of equals; None if none is feasible."""
    feasible = [i for i, outcome in enumerate(outcomes) if outcome.is_feasible]
    return min(feasible, key=lambda i: outcomes[i].goal, default=None)


def spread(values: FloatArray) -> FloatArray:
    """Return the range of known values along the first axis; 1 where all are alike."""
    found = np.asarray(np.ptp(values, axis=0)) if len(values) else np.ones(values.shape[1:])
    return np.asarray(np.where(found > 0.0, found, 1.0))
