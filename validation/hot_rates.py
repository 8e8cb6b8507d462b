# SPDX-License-Identifier: Apache-2.0
"""Hot flow laws fitted to compression tests at some rates and temperatures, held against tests at the others.

The tests are those of `validation/measured/hot_compression_medium_carbon_gleeble.csv`: a medium carbon steel, cylinders
of 10 x 15 mm, 0.001 to 5 1/s, 1050 to 1250 degrees C, to a strain of 0.7. Laws: Hensel-Spittel and the sinh law as
`material fit` finds them, Johnson and Cook's by least squares of relative errors, and the table of the tests itself,
linear in temperature and in the logarithm of the rate. Three tests that no law knows are simulated, with friction that
the fit takes off and the run puts on, and with the heat of their plastic work.

    python -m validation.hot_rates --picture docs/img/hot_rates.png
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from presswork.case import build_model
from presswork.case.plane.schema import Case
from presswork.material.compression import CompressionTest, correct, find_adiabatic_part, read_compression
from presswork.material.identify_hot import HOT_LAWS, evaluate, fit_hot
from presswork.model import FloatArray
from presswork.recorder import run_model
from validation.hot_compression import HEIGHT, LONGEST, RADIUS

DATA = Path(__file__).parent / "measured" / "hot_compression_medium_carbon_gleeble.csv"
FIRST = 0.04
"""Strain from which on errors count; the first points hold the elastic rise of the machine."""
DENSITY, CAPACITY = 7.85e-9, 6.5e8
"""[t/mm3], [mm2/(s2 K)]"""
FRICTION = 0.15
"""Friction factor between tantalum sheets; not measured."""
SIMULATED = ((1100.0, 2.0), (1200.0, 0.01), (1100.0, 5.0))
"""[degrees C, 1/s]"""
LAWS = (*HOT_LAWS, "johnson_cook", "table")
Law = Callable[[FloatArray, float, FloatArray], FloatArray]
"""Stress [MPa] at strains (n,), a rate [1/s], temperatures [degrees C] (n,)."""


def _is_inner(test: CompressionTest) -> bool:
    return test.start in (1050.0, 1200.0, 1250.0) and test.rate in (0.001, 0.1, 1.0, 5.0)


SPLITS: dict[str, Callable[[CompressionTest], bool]] = {
    "between": _is_inner,
    "faster": lambda test: test.rate <= 1.0,
    "slower": lambda test: test.rate >= 0.1,
    "hotter": lambda test: test.start <= 1200.0,
    "colder": lambda test: test.start >= 1100.0,
}
"""Which tests are fitted: those around 1100 degrees C, 0.01 and 2 1/s; up to 1 1/s; from 0.1 1/s; all but the ends."""


@cache
def read_tests() -> tuple[CompressionTest, ...]:
    """Return the 24 tests."""
    return tuple(read_compression(DATA))


def fit_johnson_cook(tests: Sequence[CompressionTest]) -> Law:
    """Return Johnson and Cook's law, T* from 1000 to 1500 degrees C, by least squares of relative errors."""
    from scipy.optimize import least_squares

    e, s, t, r = (
        np.concatenate(column)
        for column in zip(*((x.strain, x.stress, x.temperature, np.full_like(x.strain, x.rate)) for x in tests),
                          strict=True)
    )  # fmt: skip

    def stress(x: FloatArray, strain: FloatArray, rate: FloatArray, degrees: FloatArray) -> FloatArray:
        a, b, n, c, m = np.exp(x)
        warm = np.clip((degrees - 1000.0) / 500.0, 1e-6, 1.0 - 1e-6)
        return np.asarray((a + b * strain**n) * np.maximum(1.0 + c * np.log(rate / 1e-3), 1e-3) * (1.0 - warm**m))

    used = e >= 0.02
    found = least_squares(
        lambda x: np.log(stress(x, e[used], r[used], t[used]) / s[used]), np.log([20.0, 20.0, 0.3, 0.3, 0.6])
    )
    return lambda strain, rate, degrees: stress(found.x, strain, np.full_like(strain, rate), degrees)


def tabulate(tests: Sequence[CompressionTest]) -> Law:
    """Return the tests themselves, linear in temperature and ln(rate), constant beyond."""
    rates, starts = (sorted({getattr(test, name) for test in tests}) for name in ("rate", "start"))
    known = {(test.rate, test.start): test for test in tests}

    def stress(strain: FloatArray, rate: float, degrees: FloatArray) -> FloatArray:
        rows = []
        for start in starts:
            curves = [np.interp(strain, known[r, start].strain, known[r, start].stress) for r in rates]
            at = np.clip(np.log(rate), np.log(rates[0]), np.log(rates[-1]))
            rows.append([np.interp(at, np.log(rates), column) for column in np.transpose(curves)])
        columns = np.transpose(rows)
        return np.array([np.interp(d, starts, column) for d, column in zip(degrees, columns, strict=True)])

    return stress


def fit_law(name: str, tests: Sequence[CompressionTest]) -> Law:
    """Return a law of some tests."""
    if name == "table":
        return tabulate(tests)
    if name == "johnson_cook":
        return fit_johnson_cook(tests)
    parameters = fit_hot(tests, name).parameters
    return lambda strain, rate, degrees: evaluate(name, parameters, strain, np.full_like(strain, rate), degrees)


@cache
def find_errors(split: str, law: str) -> dict[tuple[float, float], float]:
    """Return the mean magnitude of the relative error of each predicted test, by temperature and rate."""
    fitted = [test for test in read_tests() if SPLITS[split](test)]
    own = fit_law(law, fitted)
    errors = {}
    for test in read_tests():
        if not SPLITS[split](test):
            late = test.strain >= FIRST
            found = own(test.strain[late], test.rate, test.temperature[late])
            errors[test.start, test.rate] = float(np.abs(found / test.stress[late] - 1.0).mean())
    return errors


def press(test: CompressionTest, hardening: dict[str, object], m: float) -> tuple[FloatArray, FloatArray]:
    """Return strain and force over area of half a specimen at a constant rate, with friction and its own heat."""
    half = 0.5 * HEIGHT
    stroke = half * (1.0 - np.exp(-LONGEST))
    strokes = np.linspace(0.0, stroke, 60)  # v = rate h: linear in the stroke
    heat = 0.9 * find_adiabatic_part(test.rate)
    heating = {"start": test.start, "heat_capacity": CAPACITY, "plastic_fraction": heat}
    case = {
        "title": "hot compression with friction",
        "analysis": "axisymmetric",
        "workpiece": {"material": "steel", "mesh": {"size": [RADIUS, half], "cells": [8, 12]}},
        "materials": {
            "steel": {"young": 100e3, "poisson": 0.35, "density": DENSITY, "hardening": hardening, "heating": heating}
        },
        "boundary": {"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
        "tools": {"die": {"profile": [[0, half], [20, half]], "contact": "shear", "m": m}},
        "stages": [
            {
                "name": "press",
                "velocity": [[float(s), float(test.rate * (half - s))] for s in strokes],
                "tools": {"die": {"stroke": float(stroke), "direction": [0, -1]}},
            }
        ],
        "output": {"steps": 2},
    }
    with tempfile.TemporaryDirectory() as folder:
        outcome = run_model(build_model(Case.model_validate(case)), Path(folder) / "run", threads=1)
        assert outcome.status == "completed", outcome.reason
        history = outcome.result.history
    height = half - history["die.stroke"]
    return np.log(half / height), history["die.force"] * height / (np.pi * RADIUS**2 * half)


@cache
def simulate(start: float, rate: float, m: float = FRICTION) -> tuple[CompressionTest, FloatArray]:
    """Return a test that was left out, and the stress simulated at its strains [MPa].

    The law is Hensel-Spittel's of the tests around it, which are taken to have had that friction and their own heat.
    """
    fitted = [replace(test, slenderness=RADIUS / HEIGHT, m=m) for test in read_tests() if SPLITS["between"](test)]
    fit = fit_hot(correct(fitted, DENSITY * CAPACITY), "hensel_spittel")
    (test,) = (each for each in read_tests() if (each.start, each.rate) == (start, rate))
    table = {**fit.to_table(), "temperature_window": [1000.0, 1300.0]}
    strain, stress = press(test, table, m)
    return test, np.interp(test.strain, strain, stress)


def draw(path: Path) -> None:
    """Draw the predicted tests of the first split with three laws, and the simulated ones."""
    from presswork.view.style import clean_axes, new_figure, save_picture

    figure = new_figure(10.5, 6.2)
    axes = figure.subplots(2, 2, sharex=True)
    fitted = [test for test in read_tests() if SPLITS["between"](test)]
    laws = {law: fit_law(law, fitted) for law in LAWS[:3]}
    left_out = [test for test in read_tests() if not SPLITS["between"](test)]
    for ax, start in zip(axes.ravel(), (1050.0, 1100.0, 1250.0), strict=False):
        for k, test in enumerate(each for each in left_out if each.start == start):
            ax.plot(test.strain, test.stress, "o", markersize=3, color=f"C{k}", label=f"{test.rate:g} 1/s")
            for style, law in zip(("-", "--", ":"), laws.values(), strict=True):
                ax.plot(test.strain, law(test.strain, test.rate, test.temperature), style, color=f"C{k}", linewidth=1.0)
        ax.set_title(f"{start:g} °C, not fitted", fontsize="medium")
        ax.legend(frameon=False, fontsize=8, ncols=2)
    last = axes[1, 1]
    for k, (start, rate) in enumerate(SIMULATED):
        test, stress = simulate(start, rate)
        last.plot(test.strain, test.stress, "o", markersize=3, color=f"C{k}", label=f"{start:g} °C, {rate:g} 1/s")
        last.plot(test.strain, stress, color=f"C{k}")
    last.set_title(f"simulated with friction m = {FRICTION:g} and own heat", fontsize="medium")
    last.legend(frameon=False, fontsize=8)
    for ax in axes.ravel():
        ax.set_ylim(0.0, 1.35 * ax.get_ylim()[1])
        ax.set_ylabel("true stress [MPa]")
        clean_axes(ax)
    for ax in axes[1]:
        ax.set_xlabel("strain")
    figure.suptitle("points measured; lines: - Hensel-Spittel, -- sinh, ··· Johnson-Cook", fontsize="medium")
    save_picture(figure, path)


def main() -> None:
    """Print errors by split, law and test, and draw them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--picture", type=Path)
    arguments = parser.parse_args()
    for split in SPLITS:
        for law in LAWS:
            errors = find_errors(split, law)
            start, rate = max(errors, key=lambda key: errors[key])
            print(
                f"{split:8s} {law:15s} {len(errors):2d} tests: mean {100 * np.mean(list(errors.values())):5.2f} %, "
                f"worst {100 * errors[start, rate]:5.2f} % at {start:g} degrees C, {rate:g} 1/s"
            )
    print("between, by test:", *LAWS)
    for key in find_errors("between", LAWS[0]):
        cells = " ".join(f"{100 * find_errors('between', law)[key]:6.2f}" for law in LAWS)
        print(f"{key[0]:g} degrees C, {key[1]:g} 1/s: {cells}")
    for start, rate in SIMULATED:
        for m in (0.0, FRICTION, 0.3):
            test, stress = simulate(start, rate, m)
            off = np.abs(stress / test.stress - 1.0)[test.strain >= FIRST]
            print(
                f"simulated {start:g} degrees C, {rate:g} 1/s, m = {m:g}: mean {100 * off.mean():.2f} %, "
                f"worst {100 * off.max():.2f} %"
            )
    if arguments.picture:
        draw(arguments.picture)


if __name__ == "__main__":
    main()
