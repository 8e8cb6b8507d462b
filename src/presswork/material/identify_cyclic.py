# SPDX-License-Identifier: Apache-2.0
"""Identification of isotropic and kinematic hardening from tests with reversals, and errors on what was left out.

Damped least squares from several first guesses. Parameters are fitted as logarithms, so that they stay positive; the
derivative is a difference of sets of parameters that are integrated together. A weak pull towards the mean of the
guesses keeps what a test does not determine, as Yoshida and Uemori's h before the flow has gone far back, at a usual
value. It moves parameters that are determined by less than their scatter.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from presswork.case.errors import CaseError, Problem, suggest
from presswork.material.cyclic import Branch, CyclicTest
from presswork.material.cyclic_laws import CYCLIC_LAWS, VOCE
from presswork.model import FloatArray

LEAST = 1.05
"""Branches from which on a test shows what a reversal does."""
DIFFERENCE = 1e-5
"""Relative difference of parameters for derivatives."""
FEW, MANY = 15, 200
"""Evaluations from each first guess, and from the best of these on."""
PULL = 2e-3
"""Weight of a parameter's logarithm beside one of a point's stress over the largest one."""
LOOSE = 0.5
"""Standard deviation of a parameter's logarithm, and of h, beyond which the test does not determine it."""
NAMES_OF_YOSHIDA = ("B", "C", "m", "b", "Rsat", "h")


@dataclass(frozen=True)
class BranchError:
    """How far a law is from a part of the test."""

    branch: int
    """Counted from 1."""
    is_fitted: bool
    """Whether the law was fitted to this part, or predicts it."""
    scatter: float
    """Root mean square of the differences [MPa]."""
    relative: float
    """The same over the largest stress of the test."""
    worst: float
    """Largest difference [MPa]."""


@dataclass(frozen=True)
class CyclicFit:
    """A law fitted to the first branches of a test."""

    law: str
    parameters: dict[str, float]
    """Parameters by the keys of CYCLIC_LAWS."""
    young: float
    """[MPa]"""
    criterion: float
    """Schwarz's criterion on the fitted points; of two laws the smaller is better."""
    errors: tuple[BranchError, ...]
    """Errors of fitted parts, then of predicted ones."""
    stress: tuple[FloatArray, ...]
    """At the points of each branch [MPa]."""
    fitted_path: float
    """Length of the strain's path to which the law is fitted."""
    loose: tuple[str, ...] = ()
    """Parameters that the fitted points do not determine, which are near usual values."""

    def find_error(self, *, fitted: bool) -> float:
        """Return the root mean square over the fitted or the predicted parts [MPa]; nan for none."""
        squares = [error.scatter**2 for error in self.errors if error.is_fitted == fitted]
        return math.sqrt(sum(squares) / len(squares)) if squares else math.nan

    def to_tables(self) -> dict[str, dict[str, object]]:
        """Return the tables `hardening` and `kinematic` of a material."""
        p = self.parameters
        if self.law == "yoshida_uemori":
            return {
                "hardening": {"law": "linear", "yield_stress": p["yield_stress"]},
                "kinematic": {"law": "yoshida_uemori", **{name: p[name] for name in NAMES_OF_YOSHIDA}},
            }
        voce = {name: p[name] for name in VOCE}
        if self.law == "isotropic":
            return {"hardening": {"law": "linear_voce", **voce, "modulus": p["modulus"]}}
        count = CYCLIC_LAWS[self.law].parts
        back = {name: [p[f"{name}{k + 1}"] for k in range(count)] for name in ("C", "gamma")}
        return {"hardening": {"law": "voce", **voce}, "kinematic": {"law": "chaboche", **back}}


def fit_cyclic(test: CyclicTest, law: str, young: float, fitted: float | None = None) -> list[CyclicFit]:
    """Fit one law, or all, to the first `fitted` branches of a test, the best of those first.

    fitted: may be a fraction: 1.5 is the first branch and half of the second's strain; None: all. young: Young's
    modulus [MPa]. Raises CaseError.
    """
    if law not in (*CYCLIC_LAWS, "all"):
        remedy = suggest(law, (*CYCLIC_LAWS, "all"))
        raise CaseError([Problem("--law", "unknown law of tests with reversals", remedy, law)])
    total = len(test.branches)
    count = float(total) if fitted is None else fitted
    if not LEAST <= count <= total:
        remedy = f"give a number from {LEAST:g} to {total}: 1.5 is the first branch and half of the second"
        raise CaseError([Problem("--fit-branches", f"{count:g} branches do not show what a reversal does", remedy)])
    chosen = [np.clip(count - i, 0.0, 1.0) >= branch.path - 1e-9 for i, branch in enumerate(test.branches)]
    chosen = [mask if count > i else np.zeros_like(mask) for i, mask in enumerate(chosen)]
    names = tuple(CYCLIC_LAWS) if law == "all" else (law,)
    fits = [_fit_one(test.branches, name, young, chosen) for name in names]
    return sorted(fits, key=lambda fit: fit.criterion)


def _fit_one(branches: Sequence[Branch], law: str, young: float, chosen: Sequence[FloatArray]) -> CyclicFit:
    """Fit a law to the chosen points of branches."""
    from scipy.optimize import least_squares  # slow to import

    kind = CYCLIC_LAWS[law]
    used = [i for i, mask in enumerate(chosen) if mask.any()]
    ends = [branches[i].end for i in used]
    strains = [branches[i].strain[chosen[i]] for i in used]
    measured = np.concatenate([branches[i].stress[chosen[i]] for i in used])
    top = float(np.abs(measured).max())
    start = float(branches[0].strain[0] - branches[0].stress[0] / young)

    def residuals(x: FloatArray) -> FloatArray:
        sets = np.array([_to_parameters(law, row) for row in np.atleast_2d(x)])
        rows = np.concatenate(kind.stress(sets, ends, strains, young, start))
        return np.asarray((rows - measured[:, None]) / top)

    def slopes(x: FloatArray) -> FloatArray:
        moved = residuals(np.vstack([x, x + DIFFERENCE * np.eye(len(x))]))
        return np.asarray((moved[:, 1:] - moved[:, :1]) / DIFFERENCE)

    guesses = _list_guesses(law, top)
    usual = np.mean([guess for guess, _, _ in guesses], axis=0)
    pull = PULL * np.eye(len(usual))

    def search(guess: FloatArray, low: FloatArray, high: FloatArray, evaluations: int) -> tuple[float, FloatArray]:
        found = least_squares(
            lambda x: np.concatenate([residuals(x)[:, 0], pull @ (x - usual)]),
            np.clip(guess, low + 1e-6, high - 1e-6), jac=lambda x: np.vstack([slopes(x), pull]), bounds=(low, high),
            xtol=1e-10, ftol=1e-10, gtol=1e-10, max_nfev=evaluations,
        )  # fmt: skip
        return float(found.cost), found.x

    tried = [search(*guess, FEW) for guess in guesses]
    first = min(range(len(tried)), key=lambda i: tried[i][0])
    _, best = search(tried[first][1], *guesses[first][1:], MANY)
    off = residuals(best)[:, 0]
    loose = _find_loose(kind.keys, slopes(best), off)
    values = _to_parameters(law, best)
    whole = kind.stress(
        values[None, :], [branch.end for branch in branches], [branch.strain for branch in branches], young, start
    )
    stress = tuple(rows[:, 0] for rows in whole)
    mean = float((off**2).mean()) * top**2
    criterion = len(measured) * math.log(mean + 1e-30) + len(kind.keys) * math.log(len(measured))
    parameters = dict(zip(kind.keys, (float(value) for value in values), strict=True))
    path = sum(float(np.ptp(branch.strain[mask])) for branch, mask in zip(branches, chosen, strict=True) if mask.any())
    return CyclicFit(law, parameters, young, criterion, _find_errors(branches, stress, chosen), stress, path, loose)


def _find_loose(keys: Sequence[str], slopes: FloatArray, off: FloatArray) -> tuple[str, ...]:
    """Return the parameters whose standard deviation is beyond LOOSE, by slopes (n, k) and differences (n,)."""
    scale = np.maximum(np.linalg.norm(slopes, axis=0), 1e-12)
    _, values, rows = np.linalg.svd(slopes / scale, full_matrices=False)
    inverse = (rows.T / np.maximum(values, 1e-12)) / scale[:, None]
    deviation = np.linalg.norm(inverse, axis=1) * float(np.sqrt((off**2).mean()))
    return tuple(key for key, own in zip(keys, deviation, strict=True) if own > LOOSE)


def _find_errors(
    branches: Sequence[Branch], stress: Sequence[FloatArray], chosen: Sequence[FloatArray]
) -> tuple[BranchError, ...]:
    """Return the errors of each branch, of its fitted points and of the others."""
    top = max(float(np.abs(branch.stress).max()) for branch in branches)
    errors = []
    for is_fitted in (True, False):
        for i, (branch, found, mask) in enumerate(zip(branches, stress, chosen, strict=True), 1):
            points = mask == is_fitted
            if points.any():
                off = (found - branch.stress)[points]
                scatter = float(np.sqrt((off**2).mean()))
                errors.append(BranchError(i, is_fitted, scatter, scatter / top, float(np.abs(off).max())))
    return tuple(errors)


def _to_parameters(law: str, x: FloatArray) -> FloatArray:
    """Return the parameters of a law from the logarithms that are fitted.

    The saturation stress counts from the yield stress, B from the yield surface; h is a number between 0 and 1.
    """
    values = np.exp(x)
    if law == "yoshida_uemori":
        values[1] += values[0]
        values[6] = x[6]
        return values
    values[1] += values[0]
    if law == "chaboche_2" and values[4] < values[6]:  # the fast back stress first
        values[[3, 4, 5, 6]] = values[[5, 6, 3, 4]]
    return values


def _list_guesses(law: str, top: float) -> list[tuple[FloatArray, FloatArray, FloatArray]]:
    """Return first guesses with lower and upper bounds, as _to_parameters takes them; top: the largest stress [MPa]."""
    voce_low, voce_high = [1e-2 * top, 1e-3 * top, 0.1], [1.5 * top, 5.0 * top, 500.0]
    if law == "isotropic":
        low, high = [*voce_low, 1e-3 * top], [*voce_high, 20.0 * top]
        return [_take_logarithms([0.6 * top, 0.3 * top, rate, 0.5 * top], low, high) for rate in (10.0, 50.0)]
    if law == "yoshida_uemori":
        low, high = [0.05 * top, 0.01 * top, 5.0, 0.5, 1e-3 * top, 1e-3 * top], [top, top, 5e3, 200.0, 2 * top, 5 * top]
        guesses = []
        for C, m, h in ((200.0, 10.0, 0.3), (800.0, 20.0, 0.3), (80.0, 5.0, 0.3)):
            first = [0.6 * top, 0.2 * top, C, m, 0.1 * top, 0.3 * top]
            guess, least, most = _take_logarithms(first, low, high)
            guesses.append((np.append(guess, h), np.append(least, 0.0), np.append(most, 1.0)))
        return guesses
    slow, fast = (10.0, 60.0), (60.0, 400.0)
    rows = [(g,) for g in (20.0, 80.0, 300.0)] if law == "chaboche_1" else [(g, f) for g in slow for f in fast]
    guesses = []
    for rates in rows:
        first, low, high = [0.6 * top, 0.2 * top, 10.0], list(voce_low), list(voce_high)
        for gamma in rates:
            first += [0.15 * top * gamma, gamma]
            low += [1e-2 * top, 1e-2]
            high += [2e3 * top, 5e3]
        guesses.append(_take_logarithms(first, low, high))
    return guesses


def _take_logarithms(
    guess: Sequence[float], low: Sequence[float], high: Sequence[float]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    return np.log(guess), np.log(low), np.log(high)
