# SPDX-License-Identifier: Apache-2.0
"""Warm forward extrusion at five ram speeds: temperature of the product beside the bound of the ram's pressure.

Run: python -m validation.warm_extrusion [--picture docs/img/warm_extrusion.png]
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import numpy as np

from presswork import read_case
from presswork.case.plane.schema import Case
from presswork.examples import copy_example
from presswork.results import Result
from presswork.study import run_sweep
from presswork.view.plots.mesh_plot import plot_mesh
from tests.problems.warm_extrusion import find_enthalpy, find_exit_temperatures, find_pressure

SPEEDS = (5, 20, 50, 200, 500)
"""[mm/s]"""


def find_bound(case: Case, pressure: float) -> float:
    """Return the temperature of metal at 600 degrees C that takes up a pressure as heat [degrees C]."""
    temperature = np.linspace(600.0, 690.0, 901)
    return float(np.interp(pressure, find_enthalpy(case, temperature), temperature))


def main() -> None:
    """Print the table; draw if asked to."""
    parser = argparse.ArgumentParser(description="Warm extrusion at five ram speeds")
    parser.add_argument("--picture", help="PNG file to draw")
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        path = copy_example("warm_extrusion", folder)
        speeds = {"stages.0.velocity": [f"{speed} mm/s" for speed in SPEEDS]}
        run_sweep(path, speeds, Path(folder) / "sweep", jobs=arguments.jobs)
        results = [Result(Path(folder) / f"sweep/member_{i:03d}") for i in range(len(SPEEDS))]
        case = read_case(path)
        rows = []
        for speed, result in zip(SPEEDS, results, strict=True):
            temperature, volume = find_exit_temperatures(result, 15)
            pressure = find_pressure(result)
            mean = float(np.average(temperature, weights=volume))
            low, high, bound = temperature.min(), temperature.max(), find_bound(case, pressure)
            rows.append((speed, mean, low, high, pressure, bound))
            print(f"{speed:4d} mm/s: {mean:.1f}, {low:.1f} to {high:.1f}; {pressure:.1f} MPa, bound {bound:.1f} °C")
        if arguments.picture:
            draw(arguments.picture, results, np.array(rows))


def draw(path: str, results: list[Result], rows: np.ndarray) -> None:
    """Draw the temperatures at the slowest, the middle and the fastest speed in one scale, and those of the product."""
    import matplotlib.pyplot as plt

    figure = plt.figure(figsize=(12, 6), layout="constrained")
    axes = figure.subplots(1, 4, width_ratios=[1, 1, 1, 2.2])
    for axis, i in zip(axes, (0, 2, 4), strict=False):
        plot_mesh(results[i], "nodal_temperature", ax=axis, show_edges=False, value_range=(440.0, 660.0))
        axis.set_title(f"{SPEEDS[i]} mm/s", fontsize="medium")
    curve = axes[-1]
    curve.fill_between(rows[:, 0], rows[:, 2], rows[:, 3], color="C0", alpha=0.2, lw=0, label="coldest to warmest")
    curve.plot(rows[:, 0], rows[:, 1], "o-", color="C0", label="mean of the product")
    curve.plot(rows[:, 0], rows[:, 5], "--", color="0.3", label="bound: all of the ram's work as heat")
    curve.axhline(600, color="0.6", lw=0.8, label="billet at the start")
    curve.set(xscale="log", xlabel="ram speed [mm/s]", ylabel="temperature [degrees C]")
    curve.legend(frameon=False, fontsize="small", loc="lower right")
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    main()
