# SPDX-License-Identifier: Apache-2.0
"""Closed-die forging with flash, and heading with friction: the packaged examples, measured.

Run: python -m validation.forging [--pictures docs/img]
"""

from __future__ import annotations

import argparse
import tempfile
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

import presswork
from presswork.post import measure_die_fill, trace_interface
from presswork.view import plot_mesh, plot_mesh_and_contours

CAVITY = (0.0, 20.4)
"""Radii of the forging die's cavity, without the flash [mm]."""
FLOW = 700.0
"""Flow stress at a strain of 1 [MPa]."""
_FOLDERS: list[tempfile.TemporaryDirectory[str]] = []


@cache
def run_example(name: str, *overrides: str) -> presswork.Result:
    """Run a packaged example with changed keys; the results stay until the program ends."""
    _FOLDERS.append(tempfile.TemporaryDirectory())
    case = presswork.Case.from_toml(str(files("presswork.examples") / f"{name}.toml"), overrides=list(overrides))
    outcome = presswork.run(case, Path(_FOLDERS[-1].name) / "out", threads=1)
    if outcome.status != "completed":
        raise RuntimeError(f"{name} {overrides}: {outcome.reason}")
    return outcome.result


def force_at(result: presswork.Result, tool: str, fractions: Any) -> np.ndarray:
    """Return a tool's force [kN] at fractions of its stroke."""
    stroke, force = result.history[f"{tool}.stroke"], result.history[f"{tool}.force"]
    return np.interp(np.asarray(fractions) * stroke[-1], stroke, force) / 1e3


def fill_history(result: presswork.Result) -> list[tuple[float, float, float]]:
    """Return, for every saved step after the start, stroke over final stroke, part filled and open volume [mm3]."""
    rows = []
    for step in range(1, len(result.times)):
        fill = measure_die_fill(result, "die", step, x_range=CAVITY)
        rows.append((float(result.times[step]), fill.filled, fill.unfilled_volume))
    return rows


def closing_pressure() -> float:
    """Estimate the pressure where the flash begins, over the flow stress: (2/sqrt(3)) (1 + ln(flange / flash)).

    Ideal work in plane strain of metal that goes from the flange's thickness, 10 mm, to the flash's, 2 mm, against the
    yield stress of the flash. No friction, no redundant work: a figure for the order of magnitude.
    """
    return float(2 / np.sqrt(3) * (1 + np.log(10 / 2)))


def outline(result: presswork.Result) -> dict[str, float]:
    """Return what tells one head from another: radii at the punch, the bulge and the die's face [mm]."""
    points = result.points(-1)
    boundary = points[np.unique(result.mesh.boundary_edges)]
    head = boundary[boundary[:, 1] > 0.5]
    punch = trace_interface(result, "punch")
    return {"at the punch": float(punch.points[:, 0].max()), "bulge": float(head[:, 0].max())}


def print_forging() -> None:
    """Print force and fill over the stroke, and how they depend on the mesh and on friction."""
    fractions = (0.5, 0.75, 0.9, 0.95, 0.98, 1.0)
    print("force [kN] at " + ", ".join(f"{100 * f:g} %" for f in fractions))
    variants: dict[str, tuple[str, ...]] = {
        "packaged, 20 x 14 quad4_fbar": (),
        "30 x 21 quad4_fbar": ("workpiece.mesh.cells=[30,21]",),
        "30 x 21 4CST": ("workpiece.mesh.cells=[30,21]", "workpiece.element=tri3"),
        "40 x 28 4CST": ("workpiece.mesh.cells=[40,28]", "workpiece.element=tri3"),
        "m = 0.2": ("tools.die.m=0.2",),
    }
    for name, overrides in variants.items():
        result = run_example("forging_flash", *overrides)
        counts = [result.summary[k] for k in ("increments", "iterations", "cutbacks")]
        forces = " ".join(f"{f:6.0f}" for f in force_at(result, "die", fractions))
        print(f"{name:30s} {forces}  increments, iterations, cut-backs {counts}")
    result = run_example("forging_flash")
    print("stroke, filled, open volume:")
    for time, filled, volume in fill_history(result):
        if time > 0.7:
            print(f"  {100 * time:5.1f} %  {100 * filled:5.1f} %  {volume:7.1f} mm3")
    last = force_at(result, "die", 1.0)
    area = np.pi * result.points(-1)[:, 0].max() ** 2
    print(f"mean pressure {1e3 * last / area / FLOW:.2f} of the flow stress; closing estimate {closing_pressure():.2f}")


def print_heading() -> None:
    """Print force and shape of the head with friction and sticking."""
    fractions = (0.1, 0.25, 0.5, 0.75, 0.9, 1.0)
    print("punch force [kN] at " + ", ".join(f"{100 * f:g} %" for f in fractions))
    for name in ("heading", "heading_friction"):
        result = run_example(name)
        forces = " ".join(f"{f:6.0f}" for f in force_at(result, "punch", fractions))
        shape = ", ".join(f"{k} {v:.2f} mm" for k, v in outline(result).items())
        summary = result.summary
        strain = summary["extremes"]["equivalent_plastic_strain"][1]
        counts = [summary[k] for k in ("increments", "iterations", "cutbacks")]
        print(f"{name:18s} {forces}  {shape}, largest strain {strain:.2f}, {counts}")


def draw(folder: Path) -> None:
    """Draw fill and force of the forging, and the two heads side by side."""
    import matplotlib.pyplot as plt

    result = run_example("forging_flash")
    plot_mesh_and_contours(result, "eqps", -1).savefig(folder / "forging_flash.png", dpi=110)
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.8), layout="constrained")
    left.plot(result.history["die.stroke"], result.history["die.force"] / 1e3)
    left.set(xlabel="die stroke [mm]", ylabel="die force [kN]", ylim=(0, None))
    rows = np.array(fill_history(result))
    right.plot(5.6 * rows[:, 0], 100 * rows[:, 1], "o-", ms=3)
    right.set(xlabel="die stroke [mm]", ylabel="cavity filled [%]", ylim=(0, 102))
    for axis in (left, right):
        axis.grid(True, color="0.92")
        axis.spines[["top", "right"]].set_visible(False)
    figure.savefig(folder / "forging_fill.png", dpi=110)
    figure, axes = plt.subplots(1, 2, figsize=(11, 6.4), layout="constrained")
    for axis, name in zip(axes, ("heading", "heading_friction"), strict=True):
        plot_mesh(run_example(name), "eqps", -1, axis)
        axis.set_title({"heading": "sticking", "heading_friction": "mu = 0.1, at most m = 0.3"}[name])
        axis.set_xlim(-1, 23)
        axis.set_ylim(-17, 12)
    figure.savefig(folder / "heading_friction.png", dpi=110)


def main() -> None:
    """Print the figures; draw if asked to."""
    parser = argparse.ArgumentParser(description="Closed-die forging and heading with friction")
    parser.add_argument("--pictures", type=Path, help="folder for the pictures")
    arguments = parser.parse_args()
    print_forging()
    print_heading()
    if arguments.pictures:
        draw(arguments.pictures)


if __name__ == "__main__":
    main()
