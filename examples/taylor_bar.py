# SPDX-License-Identifier: Apache-2.0
"""Taylor bar: runs the packaged case and draws four moments, temperature on the left and plastic strain on the right.

Run: python examples/taylor_bar.py [taylor_bar.png].
"""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.collections import PolyCollection

from presswork.case import build_model, read_case
from presswork.examples import copy_example
from presswork.recorder import run_model
from presswork.results import Result

MOMENTS = (1, 3, 6, 16)
"""Saved steps, every 5 us."""


def draw(result: Result, target: str) -> None:
    """Draw the moments."""
    figure, axes = plt.subplots(1, 4, figsize=(9, 5), sharey=True, layout="constrained")
    sides = (("equivalent_plastic_strain", 1.0, (0.0, 2.0), "viridis"), ("temperature", -1.0, (20.0, 650.0), "inferno"))
    cells = result.mesh.blocks[0].connectivity
    for axis, step in zip(axes, MOMENTS, strict=True):
        for field, sign, limits, colours in sides:
            corners = (result.points(step)[:, :2] * [sign, 1.0])[cells]
            shape = PolyCollection(
                corners, array=result.field(field, step), cmap=colours, linewidth=0.4, edgecolor="face"
            )
            shape.set_clim(*limits)
            axis.add_collection(shape)
            if step == MOMENTS[-1]:
                label = f"{field.replace('_', ' ')} [{result.unit(field)}]"
                figure.colorbar(shape, ax=axes, location="right" if sign > 0 else "left", label=label, shrink=0.6)
        axis.axhline(0.0, color="black")
        title = f"{1e6 * result.times[step]:.0f} us"
        axis.set(title=title, xlim=(-6.5, 6.5), ylim=(-0.5, 33.0), aspect="equal", xlabel="r [mm]")
    figure.savefig(target, dpi=110, bbox_inches="tight")
    print(f"wrote {target}")


def main() -> None:
    """Run the impact, print the shape, draw it."""
    target = sys.argv[1] if len(sys.argv) > 1 else "taylor_bar.png"
    with TemporaryDirectory() as folder:
        model = build_model(read_case(copy_example("taylor_bar", folder)))
        result = run_model(model, Path(folder) / "out").result
        end, summary = result.history, result.summary
        print(f"length {end['y_max'][-1] - end['y_min'][-1]:.2f} mm, foot {2 * end['x_max'][-1]:.2f} mm")
        for field in ("equivalent_plastic_strain", "temperature"):
            print(f"largest {field.replace('_', ' ')} {summary['extremes'][field][1]:.4g}")
        print(f"cycles {summary['cycles']}, energy error {end['energy_error_percent'][-1]:.4f} %")
        draw(result, target)


if __name__ == "__main__":
    main()
