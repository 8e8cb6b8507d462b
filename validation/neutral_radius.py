# SPDX-License-Identifier: Apache-2.0
"""Neutral radius of the ring 6:3:2 against friction, beside Avitzur's.

The shipped ring on 20 x 10 blocks of 4CST, at friction factors from 0.05 to 1. Three readings of presswork: on the
platen, where the slip vanishes and where the shear changes its sign (presswork.post.find_neutral_radius), and that of
the flow averaged over the height (presswork.study.measure_ring), which is there too when all the ring flows outwards.
Run: python -m validation.neutral_radius [--picture docs/img/ring_neutral_radius.png]
"""

from __future__ import annotations

import argparse
import tempfile
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path

import numpy as np

from presswork.model import FloatArray
from presswork.post import find_neutral_radius
from presswork.study import integrate_ring, measure_ring, run_sweep
from presswork.study.avitzur import find_neutral_square

FRICTION = (0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.7, 1.0)
CURVES = (0.1, 0.2, 0.3, 0.5, 1.0)
EXAMPLE = Path(str(files("presswork.examples") / "ring_compression.toml"))
BORE, OUTSIDE, HEIGHT = 9.0, 18.0, 12.0
"""Radii and height of the ring before [mm]."""


@dataclass(frozen=True)
class Neutral:
    """Neutral radii at the saved steps, over the first bore radius; all (n_steps,)."""

    reduction: FloatArray
    by_slip: FloatArray
    stick_width: FloatArray
    by_shear: FloatArray
    of_mean_flow: FloatArray


@cache
def compress(cells: tuple[int, int] = (20, 10)) -> dict[float, Neutral]:
    """Run the rings."""
    settings = [f"workpiece.mesh.cells=[{cells[0]},{cells[1]}]", "output.steps=20"]
    rings = {}
    with tempfile.TemporaryDirectory() as folder:
        sweep = run_sweep(EXAMPLE, {"tools.punch.m": FRICTION}, Path(folder) / "rings", settings=settings)
        for member in sweep.members:
            result = member.result
            ring = measure_ring(result)
            found = [find_neutral_radius(result, step) for step in range(len(result.times))]
            rings[float(member.values["tools.punch.m"])] = Neutral(
                ring.height_reduction,
                np.array([f.by_slip for f in found]) / BORE,
                np.array([f.stick_width for f in found]) / BORE,
                np.array([f.by_shear for f in found]) / BORE,
                ring.neutral_radius / BORE,
            )
    return rings


def avitzur(m: float, reductions: FloatArray) -> FloatArray:
    """Return Avitzur's neutral radius over the first bore radius, the ring's shape by his field too."""
    bore, outside = integrate_ring(m, reductions)
    heights = HEIGHT * (1 - np.asarray(reductions))
    square = [find_neutral_square(m, OUTSIDE * o, BORE * i, h) for i, o, h in zip(bore, outside, heights, strict=True)]
    return np.sqrt(square) / BORE


def at(ring: Neutral, values: FloatArray, reduction: float) -> float:
    """Return a neutral radius at a reduction."""
    return float(values[np.argmin(np.abs(ring.reduction - reduction))])


def print_table(rings: dict[float, Neutral]) -> None:
    """Print the radii at 10, 25 and 45 % as docs/verification/ring_compression.md has them."""
    names = (
        "m",
        "reduction",
        "no slip",
        "width of the zone",
        "shear changes sign",
        "averaged over the height",
        "Avitzur",
    )
    print(f"| {' | '.join(names)} |")
    print("|---" * len(names) + "|")
    for m, ring in rings.items():
        for reduction in (0.1, 0.25, 0.45):
            found = [at(ring, v, reduction) for v in (ring.by_slip, ring.stick_width, ring.by_shear, ring.of_mean_flow)]
            text = " | ".join("" if np.isnan(f) else f"{f:.3f}" for f in found)
            print(f"| {m:g} | {100 * reduction:.0f} % | {text} | {avitzur(m, np.array([reduction]))[0]:.3f} |")


def draw(path: str, rings: dict[float, Neutral]) -> None:
    """Draw the neutral radius against friction at 25 %, and against the reduction."""
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(10.4, 4.6), sharey=True, layout="constrained")
    m = np.array(list(rings))
    fine = np.linspace(0.02, 1.0, 99)
    left.plot(fine, [avitzur(v, np.array([0.25]))[0] for v in fine], "k--", lw=1.2, label="Avitzur, parallel field")
    for name, style, label in (
        ("of_mean_flow", "C0-", "flow averaged over the height"),
        ("by_shear", "C2x", "on the platen: shear changes sign"),
    ):
        left.plot(m, [at(ring, getattr(ring, name), 0.25) for ring in rings.values()], style, ms=6, label=label)
    slip, width = (np.array([at(r, getattr(r, n), 0.25) for r in rings.values()]) for n in ("by_slip", "stick_width"))
    left.errorbar(m, slip, width / 2, fmt="C1o", ms=5, capsize=3, label="on the platen: no slip, with its zone")
    left.set(xlabel="friction factor m", ylabel="neutral radius over first bore radius", xlim=(0, 1.02))
    left.set_title("at a height reduction of 25 %", fontsize=10)
    left.legend(frameon=False, fontsize=8, loc="lower right")
    colours = plt.get_cmap("viridis")(np.linspace(0, 0.88, len(CURVES)))
    reductions = np.linspace(0, 0.5, 51)
    for value, colour in zip(CURVES, colours, strict=True):
        ring = rings[value]
        right.plot(100 * reductions, avitzur(value, reductions), "--", color=colour, lw=1.1)
        right.plot(100 * ring.reduction[1:-1], ring.of_mean_flow[1:-1], "-", color=colour, lw=1.2)
        right.plot(100 * ring.reduction[1:-1], ring.by_slip[1:-1], ".", color=colour, ms=5, label=f"m = {value:g}")
    right.set(xlabel="height reduction [%]", xlim=(0, 50), ylim=(0, None))
    right.set_title("dashed Avitzur, solid averaged over the height, dots on the platen (no slip)", fontsize=9)
    right.legend(frameon=False, fontsize=8, loc="lower right")
    for ax in (left, right):
        ax.grid(True, color="0.92", lw=0.8)
        ax.spines[["top", "right"]].set_visible(False)
    figure.suptitle("Ring 6:3:2: where the flow parts", fontsize=11)
    figure.savefig(path, dpi=130)


def main() -> None:
    """Print the table; draw if asked to."""
    parser = argparse.ArgumentParser(description="Neutral radius of the ring test")
    parser.add_argument("--picture", help="PNG file to draw")
    parser.add_argument("--cells", type=int, nargs=2, default=(20, 10), help="blocks along radius and half height")
    arguments = parser.parse_args()
    rings = compress(tuple(arguments.cells))
    print_table(rings)
    if arguments.picture:
        draw(arguments.picture, rings)


if __name__ == "__main__":
    main()
