# SPDX-License-Identifier: Apache-2.0
"""Statistics of a measure that scatters: share beyond a limit, capability, and the inputs that make it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import stats

from presswork.model import BoolArray, FloatArray
from presswork.study.optimum.study_file import Limit

BEST = 1e6
"""Capability of values that do not scatter."""
CONFIDENCE = 0.95
"""Confidence of one-sided bounds."""


@dataclass(frozen=True)
class Capability:
    """How many times three standard deviations the limits lie from the mean."""

    cpk: float
    least: float
    """That it has at least, at CONFIDENCE (Bissell 1990)."""


def find_capability(values: FloatArray, limit: Limit) -> Capability:
    """Return the capability of values (n,) within a limit.

    >>> ten = np.array([-1.0, 1.0] * 15) * np.sqrt(29 / 30)
    >>> found = find_capability(ten, Limit(measure="x", at_most=3.99))
    >>> round(found.cpk, 3), round(found.least, 3)
    (1.33, 1.026)
    """
    n, mean, deviation = len(values), float(values.mean()), float(values.std(ddof=1))
    nearest = min(sign * (value - mean) for sign, value in limit.sides)
    cpk = nearest / max(3.0 * deviation, abs(nearest) / BEST, 1e-300)
    spread = np.sqrt(1.0 / (9.0 * n) + cpk**2 / (2.0 * (n - 1)))
    return Capability(cpk, cpk - float(stats.norm.ppf(CONFIDENCE)) * float(spread))


def share_beyond(cpk: float) -> float:
    """Return the share of normal values beyond the nearer limit.

    >>> [round(1e6 * share_beyond(cpk), 2) for cpk in (1.0, 1.33, 1.67)]
    [1349.9, 33.04, 0.27]
    """
    return float(stats.norm.sf(3.0 * cpk))


def bound_share(passed: int, n: int) -> float:
    """Return the share that is passed at most, at CONFIDENCE, if so many of n runs pass (Clopper & Pearson 1934).

    >>> bound_share(0, 299) < 0.01 < bound_share(0, 297)
    True
    """
    return 1.0 if passed >= n else float(stats.beta.ppf(CONFIDENCE, passed + 1, n - passed))


def is_beyond(values: FloatArray, limit: Limit) -> BoolArray:
    """Return whether values (n,) pass a limit (n,); one that is no number does."""
    kept = np.ones(len(values), dtype=bool)
    for sign, value in limit.sides:
        kept &= sign * (values - value) <= 0.0
    return ~kept


@dataclass(frozen=True)
class Indices:
    """Parts of a function's variance by input (d,)."""

    first: FloatArray
    """That each input makes by itself."""
    total: FloatArray
    """That would go with the input, its interactions included."""


def find_indices(function: Callable[[FloatArray], FloatArray], a: FloatArray, b: FloatArray) -> Indices:
    """Return Sobol's indices by independent points a and b (n, d) of the inputs, n a power of two."""
    n, d = a.shape
    if d == 1:  # it makes all
        return Indices(np.ones(1), np.ones(1))
    mixed = np.repeat(a[None], d, axis=0)
    mixed[np.arange(d), :, np.arange(d)] = b.T
    found = stats.sobol_indices(
        func={
            "f_A": function(a)[None],
            "f_B": function(b)[None],
            "f_AB": function(mixed.reshape(-1, d)).reshape(d, 1, n),
        },
        n=n,
    )
    return Indices(np.asarray(found.first_order).reshape(d), np.asarray(found.total_order).reshape(d))
