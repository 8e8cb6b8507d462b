# SPDX-License-Identifier: Apache-2.0
"""A hot compression test, computed with the law that `presswork material fit` finds in the other tests of the same set.

The tests are those of Tize Mha et al. (2023), Metals 13, 633: a medium carbon steel, cylinders of 10 x 15 mm between
tantalum sheets on a Gleeble 3800, which keeps their temperature. The law is Hensel-Spittel.

    python -m validation.hot_compression --picture docs/img/hot_compression.png
"""

from __future__ import annotations

import argparse
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from presswork.case import build_model
from presswork.case.plane.schema import Case
from presswork.material.compression import CompressionTest, read_compression
from presswork.material.identify_hot import HotFit, fit_hot
from presswork.model import FloatArray
from presswork.recorder import run_model

DATA = Path(__file__).parents[1] / "tests" / "data" / "hot_compression_medium_carbon_steel.csv"
RADIUS, HEIGHT = 5.0, 15.0
HELD_OUT = ((1150.0, 1.0), (1100.0, 0.1), (1200.0, 5.0))
"""Tests that are left out of the fit, one at a time, and computed [degrees C, 1/s]."""
LONGEST = 0.7
"""Strain to which they are computed."""


@dataclass(frozen=True)
class Comparison:
    """A test beside its computation with a law that does not know it."""

    test: CompressionTest
    fit: HotFit
    """Of the other tests."""
    strain: FloatArray
    """Of the computation (n,)."""
    stress: FloatArray
    """Force over the area of a cylinder of the same volume (n,) [MPa]."""

    @property
    def error(self) -> FloatArray:
        """Relative difference at the measured strains."""
        found = np.interp(self.test.strain, self.strain, self.stress)
        return np.asarray(found / self.test.stress - 1.0)


def compare(temperature: float, rate: float) -> Comparison:
    """Fit the law to all tests but one, and compute that one: half of the specimen, at a constant strain rate."""
    tests = read_compression(DATA)
    (test,) = (each for each in tests if (each.start, each.rate) == (temperature, rate))
    fit = fit_hot([each for each in tests if each is not test], "hensel_spittel")
    half = 0.5 * HEIGHT
    stroke = half * (1.0 - np.exp(-LONGEST))
    ways = np.linspace(0.0, stroke, 60)  # v = rate h: linear in the way
    case = {
        "title": "hot compression",
        "analysis": "axisymmetric",
        "workpiece": {"material": "steel", "mesh": {"size": [RADIUS, half], "cells": [6, 9]}},
        "materials": {
            "steel": {
                "young": 100e3,
                "poisson": 0.35,
                "hardening": fit.to_table(),
                "heating": {"start": temperature},
            }
        },
        "boundary": {"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
        "tools": {"die": {"profile": [[0, half], [20, half]], "contact": "frictionless"}},
        "stages": [
            {
                "name": "press",
                "velocity": [[float(s), float(rate * (half - s))] for s in ways],
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
    area = np.pi * RADIUS**2 * half / height
    return Comparison(test, fit, np.log(half / height), history["die.force"] / area)


def draw(comparisons: list[Comparison], path: Path) -> None:
    """Draw measured points and computed curves."""
    from presswork.view.style import DPI, clean_axes, new_figure

    figure = new_figure(6.4, 4.4)
    ax = figure.subplots()
    for i, each in enumerate(comparisons):
        label = f"{each.test.start:g} °C, {each.test.rate:g} 1/s: {100 * np.abs(each.error).mean():.1f} %"
        ax.plot(each.strain, each.stress, color=f"C{i}", label=label)
        ax.plot(each.test.strain, each.test.stress, "o", color=f"C{i}", markersize=5)
    ax.set_xlim(left=0.0)
    ax.set_ylim(bottom=0.0)
    ax.set_xlabel("strain")
    ax.set_ylabel("true stress [MPa]")
    ax.set_title("points: measured; lines: computed, law from the other tests", fontsize="medium")
    ax.legend(frameon=False)
    clean_axes(ax)
    figure.savefig(path, format="png", dpi=DPI)


def main() -> None:
    """Print the figures, and draw the picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--picture", type=Path)
    arguments = parser.parse_args()
    comparisons = [compare(*held) for held in HELD_OUT]
    for each in comparisons:
        worst = float(np.abs(each.error).max())
        print(
            f"{each.test.start:g} degrees C, {each.test.rate:g} 1/s: mean {100 * np.abs(each.error).mean():.2f} %, "
            f"worst {100 * worst:.2f} %; law {each.fit.scatter:.2f} MPa, {100 * each.fit.relative:.2f} %"
        )
    if arguments.picture:
        draw(comparisons, arguments.picture)


if __name__ == "__main__":
    main()
