# SPDX-License-Identifier: Apache-2.0
"""Identification of flow stress by strain, rate and temperature from hot compression tests.

Hensel-Spittel is linear in the logarithm of the stress: least squares of relative errors have one solution. The sinh
law is fitted to the same errors, from the best of a row of alpha, for each of which ln(rate) is linear. Every point
counts with the temperature of its metal, so that heating in the test does not pass for softening by strain.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from presswork.case.errors import CaseError, Problem
from presswork.material.compression import CompressionTest
from presswork.model import FloatArray

GAS = 8.31446261815324
"""[J/(mol K)]"""
KELVIN = 273.15
HOT_LAWS = ("hensel_spittel", "sinh_arrhenius")
TERMS: dict[str, Callable[[FloatArray, FloatArray, FloatArray], FloatArray]] = {
    "m1": lambda e, r, t: t,
    "m2": lambda e, r, t: np.log(e),
    "m3": lambda e, r, t: np.log(r),
    "m4": lambda e, r, t: 1.0 / e,
    "m5": lambda e, r, t: t * np.log1p(e),
    "m7": lambda e, r, t: e,
    "m8": lambda e, r, t: t * np.log(r),
    "m9": lambda e, r, t: np.log(t),
}
"""Terms of Hensel-Spittel: the factor of each parameter in the logarithm of the stress; e, rate, T [degrees C]."""
USUAL_TERMS = ("m1", "m3", "m2", "m8", "m5", "m7", "m4")
"""Terms in the order of their use: those that few tests determine come first; m9 beside m1 has the same effect over
most windows."""
DISTINCT = 1e-6
"""Least singular value over the largest, of columns of length 1, from which on the points distinguish terms."""
OF_SINH = 4
"""Constants of the sinh law, which do not depend on the strain."""
FIRST_STRAIN = 0.02
"""Where the fit starts; below lies the bend from elastic to plastic."""
TABLE_STRAINS = 15


@dataclass(frozen=True)
class HotFit:
    """A law with its parameters, fitted to tests."""

    law: str
    parameters: dict[str, float]
    """Parameters by the keys of the case."""
    strain_window: tuple[float, float]
    rate_window: tuple[float, float]
    temperature_window: tuple[float, float]
    """[degrees C]"""
    scatter: float
    """Root mean square of the differences [MPa]."""
    relative: float
    """Mean of their magnitudes over the measured stress."""
    left_out: tuple[str, ...] = ()
    """Parameters of Hensel-Spittel that the tests do not determine, which are zero."""

    def stress(self, strain: FloatArray, rate: float, temperature: FloatArray) -> FloatArray:
        """Return the flow stress [MPa] at strains and temperatures [degrees C] (n,), a rate [1/s], in the window."""
        e, r, t = (np.asarray(v, dtype=float) for v in np.broadcast_arrays(strain, rate, temperature))
        return evaluate(self.law, self.parameters, np.clip(e, *self.strain_window), r, t)

    def to_table(self) -> dict[str, object]:
        """Return the keys of a case's hardening."""
        windows = {name: list(getattr(self, f"{name}_window")) for name in ("strain", "rate", "temperature")}
        return {
            "law": self.law,
            **self.parameters,
            **{f"{name}_window": window for name, window in windows.items()},
        }


def evaluate(
    law: str, parameters: dict[str, float], strain: FloatArray, rate: FloatArray, degrees: FloatArray
) -> FloatArray:
    """Return the flow stress [MPa] of a law."""
    if law == "hensel_spittel":
        exponent = np.log(parameters["A"]) + np.zeros_like(strain)
        for name, term in TERMS.items():
            if parameters.get(name, 0.0) != 0.0:
                exponent = exponent + parameters[name] * term(strain, rate, degrees)
        return np.asarray(np.exp(exponent))
    a, alpha, n, q = (parameters[key] for key in ("A", "alpha", "n", "Q"))
    log_z = np.log(rate) + q / (GAS * (degrees + KELVIN))
    return np.asarray(np.arcsinh(np.exp((log_z - np.log(a)) / n)) / alpha)


def fit_hot(tests: Sequence[CompressionTest], law: str, terms: Sequence[str] | None = None) -> HotFit:
    """Fit a law to corrected tests.

    terms: parameters of Hensel-Spittel that may differ from zero; without them the usual ones that the tests
    distinguish. Raises CaseError where the tests do not determine it.
    """
    short = [test for test in tests if test.strain[-1] < FIRST_STRAIN]
    if short:
        text = f"strains end at {{:g}}, below {FIRST_STRAIN:g}, where elastic strains no longer count"
        remedy = "give the curve to larger strains, or leave the test out"
        wheres = [(f"the test at {t.start:g} degrees C and {t.rate:g} 1/s", t.strain[-1]) for t in short]
        raise CaseError([Problem(where, text.format(e), remedy) for where, e in wheres], "compression tests")
    points = [
        (test.strain[chosen], np.full(int(chosen.sum()), test.rate), test.temperature[chosen], test.stress[chosen])
        for test in tests
        for chosen in [test.strain >= FIRST_STRAIN]
    ]
    e, r, t, s = (np.concatenate(column) for column in zip(*points, strict=True))
    for name, values, unit in (("rate", r, "1/s"), ("temperature", [test.start for test in tests], "degrees C")):
        if len(np.unique(values)) < 2:
            text = f"all tests have one {name}, {np.unique(values)[0]:g} {unit}"
            raise CaseError([Problem("", text, "give tests at two at least")], "compression tests")
    left_out: tuple[str, ...] = ()
    if law == "hensel_spittel":
        if terms is None:
            starts = np.concatenate(
                [np.full(len(own), test.start) for test, (own, *_) in zip(tests, points, strict=True)]
            )
            terms = _choose_terms(e, r, starts)
            left_out = tuple(sorted(set(USUAL_TERMS) - set(terms)))
        found = _fit_hensel_spittel(e, r, t, s, terms)
    else:
        kinds = len({(test.rate, test.start) for test in tests})
        if kinds < OF_SINH:
            text = f"{kinds} pairs of rate and temperature do not determine its {OF_SINH} constants"
            remedy = f"give tests at {OF_SINH} pairs at least, or take --law hensel_spittel"
            raise CaseError([Problem("", text, remedy)], "sinh_arrhenius")
        found = _fit_sinh(r, t, s)
    fitted = evaluate(law, found, e, r, t)
    return HotFit(
        law,
        found,
        (float(e.min()), float(e.max())),
        (float(r.min()), float(r.max())),
        (min(float(t.min()), *(test.start for test in tests)), float(t.max())),
        float(np.sqrt(np.mean((fitted - s) ** 2))),
        float(np.mean(np.abs(fitted - s) / s)),
        left_out,
    )


def _choose_terms(e: FloatArray, r: FloatArray, t: FloatArray) -> tuple[str, ...]:
    """Return the usual terms that the points distinguish, with one point more than parameters.

    t: temperatures at which the tests begin, since those by heating in the test depend on strain and rate.
    """
    chosen: tuple[str, ...] = ()
    for name in USUAL_TERMS:
        terms = (*chosen, name)
        columns = np.column_stack([np.ones_like(e), *(TERMS[term](e, r, t) for term in terms)])
        values = np.linalg.svd(columns / np.linalg.norm(columns, axis=0), compute_uv=False)
        if len(e) > columns.shape[1] and values[-1] > DISTINCT * values[0]:
            chosen = terms
    return chosen


def _fit_hensel_spittel(
    e: FloatArray, r: FloatArray, t: FloatArray, s: FloatArray, terms: Sequence[str]
) -> dict[str, float]:
    """Return the parameters by linear least squares of ln(stress)."""
    if "m9" in terms and t.min() <= 0.0:
        raise CaseError([Problem("m9", "T^m9 has no value at 0 degrees C and below", "leave m9 out")], "fit")
    columns = np.column_stack([np.ones_like(e), *(TERMS[name](e, r, t) for name in terms)])
    scale = np.linalg.norm(columns, axis=0)
    solution, _, rank, _ = np.linalg.lstsq(columns / scale, np.log(s), rcond=1e-12)
    if rank < columns.shape[1]:
        text = f"the tests do not determine {len(terms)} parameters"
        raise CaseError([Problem("", text, "give tests at more rates and temperatures, or fewer terms")], "fit")
    values = solution / scale
    return {"A": float(np.exp(values[0])), **dict.fromkeys(TERMS, 0.0)} | dict(
        zip(terms, (float(v) for v in values[1:]), strict=True)
    )


def _fit_sinh(r: FloatArray, t: FloatArray, s: FloatArray) -> dict[str, float]:
    """Return the parameters of asinh((Z/A)^(1/n))/alpha."""
    from scipy.optimize import least_squares  # slow to import

    inverse, log_s = 1.0 / (GAS * (t + KELVIN)), np.log(s)
    starts = []
    for alpha in np.geomspace(0.05, 5.0, 30) / s.max():
        columns = np.column_stack([np.ones_like(s), np.log(np.sinh(alpha * s)), -inverse])
        (log_a, n, q), *_ = np.linalg.lstsq(columns, np.log(r), rcond=None)
        if n > 0.0 and q > 0.0:
            starts.append((alpha, log_a, n, q))
    if not starts:
        text = "stress does not rise with the rate and fall with temperature"
        raise CaseError([Problem("", text, "check the columns rate and temperature")], "sinh_arrhenius")

    def residual(x: FloatArray) -> FloatArray:
        alpha, log_a, n, q = np.exp(x[0]), x[1], np.exp(x[2]), np.exp(x[3])
        return np.asarray(np.log(np.arcsinh(np.exp((np.log(r) + q * inverse - log_a) / n)) / alpha) - log_s)

    guesses = [np.array([np.log(alpha), log_a, np.log(n), np.log(q)]) for alpha, log_a, n, q in starts]
    guess = min(guesses, key=lambda x: float(np.sum(residual(x) ** 2)))
    found = least_squares(residual, guess, x_scale=np.maximum(np.abs(guess), 1.0), xtol=1e-15, ftol=1e-15, gtol=1e-15)
    alpha, log_a, n, q = np.exp(found.x[0]), found.x[1], np.exp(found.x[2]), np.exp(found.x[3])
    return {"A": float(np.exp(log_a)), "alpha": float(alpha), "n": float(n), "Q": float(q)}


def tabulate(tests: Sequence[CompressionTest], fit: HotFit) -> FloatArray:
    """Return rows of strain, rate, temperature and stress of the measured curves at common strains (n, 4), if any.

    Heating in the test is taken off by the ratio of the fitted law's stresses at both temperatures. Pairs of rate and
    temperature without a test have the law's stresses, since a table holds all pairs.
    """
    first = max(FIRST_STRAIN, *(float(test.strain[0]) for test in tests))
    last = min(float(test.strain[-1]) for test in tests)
    if last <= first:
        return np.zeros((0, 4))
    strains = np.linspace(first, last, TABLE_STRAINS)
    rows = []
    for test in tests:
        at_start = fit.stress(test.strain, test.rate, np.full_like(test.strain, test.start))
        isothermal = test.stress * at_start / fit.stress(test.strain, test.rate, test.temperature)
        stress = np.interp(strains, test.strain, isothermal)
        rows += [(e, test.rate, test.start, s) for e, s in zip(strains, stress, strict=True)]
    for rate, start in find_untested(tests):
        stress = fit.stress(strains, rate, np.full_like(strains, start))
        rows += [(e, rate, start, s) for e, s in zip(strains, stress, strict=True)]
    return np.array(sorted(rows))


def find_untested(tests: Sequence[CompressionTest]) -> list[tuple[float, float]]:
    """Return the pairs of a test's rate [1/s] and another one's temperature [degrees C] at which there is no test."""
    pairs = {(test.rate, test.start) for test in tests}
    return sorted({(one.rate, other.start) for one in tests for other in tests} - pairs)
