# SPDX-License-Identifier: Apache-2.0
"""Optimum by radial basis functions through all runs so far: for measures that are not smooth, or have several minima.

1. The first runs: the start, and Halton's points in the box.
2. Radial basis functions (Duchon 1977; scipy's RBFInterpolator) with linear polynomials pass through the goal, and
   through what each limit is passed by. Kernel and smoothing are those of the least leave-one-out error.
3. The next runs are minimisers of this model within the limits, each at a distance from all runs and from each other.
   The distance cycles between none and half of the largest there is, so that the search goes on looking elsewhere
   (Regis & Shoemaker 2005, J. Global Optimization 31, CORS-RBF).
4. It is over when the model's minimiser stays at the best run for rounds in a row, in which its neighbours were run, so
   that the model knows the slope there, and two runs a variable have looked elsewhere.

A run without results is kept away from: no point is taken whose nearest run has failed. All points follow from the
outcomes so far and from no random number, so that a study that is resumed asks for the same ones.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import RBFInterpolator
from scipy.optimize import minimize
from scipy.spatial.distance import cdist
from scipy.stats import qmc

from presswork.model import BoolArray, FloatArray
from presswork.study.optimum.search import Evaluate, Outcome, find_best, spread

DISTANCES = (0.5, 0.05, 0.2)
"""Distances of runs that explore, over the largest distance that a point can have from all runs."""
MARGIN = 0.25
"""Margin that the model must keep from a limit, over the tolerance times the spread of the limit's measure."""
_CANDIDATES = 12
"""Power of two of the points that the model is tried at."""
_KERNELS = tuple(itertools.product(("thin_plate_spline", "cubic"), (0.0, 1e-4, 1e-2)))
_POLISHED = 3
_SLACK = 1e-6
"""Excess of limits that SLSQP accepts."""

Model = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True)
class _Fit:
    """The model of all runs: goal, and what each limit is passed by."""

    goal: Model
    excess: Model
    """Excess with the margin included (n, n_sides), as parts of the spread."""


def search_by_surrogate(evaluate: Evaluate, start: FloatArray, *, together: int, tolerance: float) -> None:
    """Look for the optimum in the unit box; return when it is found.

    start: first point (n,). together: points at a time; tolerance: distance of points that are alike. SpentError of
    `evaluate` passes through.
    """
    n = len(start)
    first = 2 * (n + 1) + 1
    design = qmc.Halton(n, scramble=False).fast_forward(1)
    outcomes = evaluate([start, *design.random(first - 1 + -first % together)])
    confirmed, enough = 0, max(2, -(-2 * n // max(together - 1, 1)))
    for number in itertools.count():
        fit = _fit_model(outcomes, tolerance)
        if fit is None:
            outcomes += evaluate(list(design.random(together)))
            continue
        points, at_best = _propose(fit, outcomes, number, together, tolerance)
        if at_best is not None:  # None: a round that only looks elsewhere
            confirmed = confirmed + 1 if at_best else 0
        if confirmed > enough or not points:
            return
        outcomes += evaluate(points)


def _fit_model(outcomes: Sequence[Outcome], tolerance: float) -> _Fit | None:
    """Fit all runs that have results; None if these are too few, or lie in a line or plane."""
    known = list({outcome.x.tobytes(): outcome for outcome in outcomes if outcome.is_known}.values())
    if not known:
        return None
    x = np.array([outcome.x for outcome in known])
    goal = np.array([[outcome.goal] for outcome in known])
    excess = np.array([outcome.excess for outcome in known])
    margin = MARGIN * tolerance
    goals = _fit(x, (goal - goal.min()) / spread(goal))
    limits = _fit(x, excess / spread(excess)) if excess.shape[1] else lambda at: np.zeros((len(at), 0))
    if goals is None or limits is None:
        return None
    return _Fit(lambda at: goals(at)[:, 0], lambda at: limits(at) + margin)


def _fit(x: FloatArray, values: FloatArray) -> Model | None:
    """Fit values (n, m) at points (n, d) by the kernel and smoothing of the least leave-one-out error."""
    if len(x) < x.shape[1] + 2:
        return None
    try:
        kernel, smoothing = min(_KERNELS, key=lambda choice: _error_of(x, values, *choice))
        model: Model = RBFInterpolator(x, values, kernel=kernel, smoothing=smoothing, degree=1)
    except (np.linalg.LinAlgError, ValueError):
        return None
    return model


def _error_of(x: FloatArray, values: FloatArray, kernel: str, smoothing: float) -> float:
    """Return the sum of squares of what each run is missed by without it."""
    error = 0.0
    for i in range(len(x) if len(x) > x.shape[1] + 2 else 0):
        others = np.arange(len(x)) != i
        model = RBFInterpolator(x[others], values[others], kernel=kernel, smoothing=smoothing, degree=1)
        error += float(((model(x[i : i + 1]) - values[i]) ** 2).sum())
    return error


def _propose(
    fit: _Fit, outcomes: Sequence[Outcome], number: int, together: int, tolerance: float
) -> tuple[list[FloatArray], bool | None]:
    """Return the next points, and whether the model's minimiser lies at the best run (None if it was not asked)."""
    n = len(outcomes[0].x)
    runs = np.array([outcome.x for outcome in outcomes])
    best = find_best(outcomes)
    everywhere = _spread_candidates(n, runs if best is None else runs[best : best + 1])
    candidates = everywhere[_are_near_results(everywhere, outcomes)]
    if not len(candidates):
        candidates = everywhere
    points: list[FloatArray] = []
    at_best: bool | None = None
    for slot in range(together):
        taken = np.concatenate([runs, *(point[None] for point in points)])
        away = cdist(candidates, taken).min(axis=1)
        look = number * max(together - 1, 1) + max(slot - 1, 0)
        if together == 1:
            is_minimiser, look = number % 2 == 0, number // 2
        else:
            is_minimiser = slot == 0
        if is_minimiser:
            found = _minimise(fit, candidates, outcomes)
            at_best = best is not None and float(np.linalg.norm(found - runs[best])) <= tolerance
            if not at_best and cdist(found[None], taken).min() > 0.1 * tolerance:
                points.append(found)
                continue
        least = 0.0 if is_minimiser else DISTANCES[look % len(DISTANCES)] * float(away.max())
        far = away >= max(least, tolerance)
        if far.any():
            points.append(_take_best(fit, candidates[far])[0])
    return points, at_best


def _spread_candidates(n: int, centres: FloatArray) -> FloatArray:
    """Return points all over the box, and clouds around some (m, n)."""
    evenly = qmc.Sobol(n, scramble=False).random_base2(_CANDIDATES)
    around = evenly[: 2**10] - 0.5
    clouds = [np.clip(centre + size * around, 0.0, 1.0) for centre in centres[-8:] for size in (0.3, 0.05)]
    corners = np.array(list(itertools.product((0.0, 1.0), repeat=n))) if n <= 6 else np.zeros((0, n))
    return np.concatenate([evenly, corners, *clouds])


def _are_near_results(points: FloatArray, outcomes: Sequence[Outcome]) -> BoolArray:
    """Return for each point whether the run nearest to it has results."""
    known = np.array([outcome.is_known for outcome in outcomes])
    nearest = cdist(points, np.array([outcome.x for outcome in outcomes])).argmin(axis=1)
    return np.asarray(known[nearest])


def _take_best(fit: _Fit, points: FloatArray, count: int = 1, slack: float = 0.0) -> FloatArray:
    """Return the best points by the model (count, n): within the limits of the least goal, or that pass them least."""
    passed = np.maximum(fit.excess(points) - slack, 0.0).sum(axis=1)
    order = np.lexsort([fit.goal(points), passed])
    return points[order[:count]]


def _minimise(fit: _Fit, candidates: FloatArray, outcomes: Sequence[Outcome]) -> FloatArray:
    """Return the model's minimiser within the limits (n,): the best of the candidates, and of SLSQP from them."""
    found = _take_best(fit, candidates, _POLISHED)
    within = {"type": "ineq", "fun": lambda x: -fit.excess(x[None])[0]}
    polished = [
        minimize(
            lambda x: float(fit.goal(x[None])[0]), start, method="SLSQP", bounds=[(0.0, 1.0)] * len(start),
            constraints=[within] if len(outcomes[0].excess) else [], options={"maxiter": 50},
        ).x
        for start in found
    ]  # fmt: skip
    ends = np.clip(np.array(polished), 0.0, 1.0)
    ends = ends[np.isfinite(ends).all(axis=1)]
    ends = ends[_are_near_results(ends, outcomes)]
    return np.asarray(_take_best(fit, np.concatenate([found, ends]), slack=_SLACK)[0])
