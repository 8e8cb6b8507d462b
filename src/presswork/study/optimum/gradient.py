# SPDX-License-Identifier: Apache-2.0
"""Optimum by gradients, for smooth measures: SLSQP (Kraft 1988, scipy) with the derivatives that a run has found, or
finite differences in parallel runs.

The runs of a difference differ from its point by a step along each variable, towards the side with more room. A run
without results counts as worse than all others, so that the line search shortens its step; a difference to it is taken
on the other side, or else as zero.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize

from presswork.model import FloatArray
from presswork.study.optimum.search import Evaluate, Outcome

MARGIN = 1e-3
"""Distance that SLSQP keeps from each limit, over its scale, so that its last run is within the limits."""
_WORSE = 10.0
"""Scaled goal of a run without results."""


def search_by_gradient(evaluate: Evaluate, start: FloatArray, *, step: float, tolerance: float) -> str:
    """Look for the optimum in the unit box from a start (n,); return why it was not found, empty if it was.

    step: of the differences, as a part of the box. tolerance: of the point, as a part of the box. SpentError of
    `evaluate` passes through.
    """
    search = _Smooth(evaluate, step)
    search.look(start)
    limits = {"type": "ineq", "fun": search.distance, "jac": search.distance_gradient}
    found = minimize(
        search.goal, start, jac=search.goal_gradient, method="SLSQP", bounds=[(0.0, 1.0)] * len(start),
        constraints=[limits] if len(search.scale) else [], options={"ftol": 0.01 * tolerance, "maxiter": 100},
    )  # fmt: skip
    return "" if found.success else f"SLSQP ended with `{found.message}`"


class _Smooth:
    """Goal and limits with their gradients, each point run once; scaled by what the first gradients change."""

    def __init__(self, evaluate: Evaluate, step: float) -> None:
        self.evaluate, self.step = evaluate, step
        self.outcomes: list[Outcome] = []
        self.goal_scale, self.scale = 1.0, np.zeros(0)
        self._at: dict[bytes, Outcome] = {}
        self._gradients: dict[bytes, tuple[FloatArray, FloatArray]] = {}

    def look(self, start: FloatArray) -> None:
        """Run the first point and its differences, and take the scales from them."""
        first = self._run([start])[0]
        self.scale = np.ones(len(first.excess))
        if not first.is_known:
            return
        slope, slopes = self._differences(start)
        self.goal_scale = float(np.abs(slope).max()) or 1.0
        scale = np.abs(slopes).max(axis=1, initial=0.0)
        self.scale = np.where(scale > 0.0, scale, 1.0)

    def goal(self, x: FloatArray) -> float:
        """Return the scaled goal."""
        outcome = self._run([x])[0]
        return outcome.goal / self.goal_scale if outcome.is_known else self._worst()

    def distance(self, x: FloatArray) -> FloatArray:
        """Return the scaled distance from the limits (n_sides,), negative where they are passed."""
        outcome = self._run([x])[0]
        return -outcome.excess / self.scale - MARGIN if outcome.is_known else np.full(len(self.scale), -_WORSE)

    def goal_gradient(self, x: FloatArray) -> FloatArray:
        """Return the gradient of the scaled goal (n,)."""
        return self._differences(x)[0] / self.goal_scale

    def distance_gradient(self, x: FloatArray) -> FloatArray:
        """Return the gradient of the scaled distances (n_sides, n)."""
        return -self._differences(x)[1] / self.scale[:, None]

    def _worst(self) -> float:
        known = [outcome.goal / self.goal_scale for outcome in self.outcomes if outcome.is_known]
        return max(known, default=0.0) + _WORSE

    def _run(self, points: list[FloatArray]) -> list[Outcome]:
        """Return the outcomes of points, those that are new run together."""
        points = [np.clip(point, 0.0, 1.0) for point in points]
        new = list({point.tobytes(): point for point in points if point.tobytes() not in self._at}.values())
        for point, outcome in zip(new, self.evaluate(new) if new else [], strict=True):
            self._at[point.tobytes()] = outcome
            self.outcomes.append(outcome)
        return [self._at[point.tobytes()] for point in points]

    def _differences(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the slopes of the goal (n,) and of the excesses (n_sides, n): the run's own, or by differences."""
        x = np.clip(x, 0.0, 1.0)
        if x.tobytes() not in self._gradients:
            here = self._run([x])[0]
            if here.slope is not None and here.slopes is not None:
                self._gradients[x.tobytes()] = here.slope, here.slopes
                return here.slope, here.slopes
            towards = np.where(x <= 0.5, self.step, -self.step)
            there = self._run([_moved(x, i, by) for i, by in enumerate(towards)])
            failed = [i for i, outcome in enumerate(there) if not outcome.is_known]
            others = self._run([_moved(x, i, -towards[i]) for i in failed]) if failed else []
            for i, outcome in zip(failed, others, strict=True):
                there[i] = outcome
            slope, slopes = np.zeros(len(x)), np.zeros((len(here.excess), len(x)))
            for i, outcome in enumerate(there):
                by = outcome.x[i] - here.x[i]
                if here.is_known and outcome.is_known and by != 0.0:
                    slope[i] = (outcome.goal - here.goal) / by
                    slopes[:, i] = (outcome.excess - here.excess) / by
            self._gradients[x.tobytes()] = slope, slopes
        return self._gradients[x.tobytes()]


def _moved(x: FloatArray, i: int, by: float) -> FloatArray:
    moved = x.copy()
    moved[i] = np.clip(moved[i] + by, 0.0, 1.0)
    return moved
