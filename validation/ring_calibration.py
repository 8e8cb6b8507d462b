# SPDX-License-Identifier: Apache-2.0
"""Ring 6:3:2 to 50 %: calibration curves on top of Avitzur's upper bound and a published finite-element table.

The shipped example, 10 x 5 blocks of 4CST, as the thesis (Cheng 1995, chapter 3). Avitzur's ring is rigid and does not
bulge; the table's (virtual-labs metal forming laboratory, tests/data/ring_6_3_2_fe.csv) is of another material.
Run: python -m validation.ring_calibration [--picture docs/img/ring_calibration.png]
"""

from __future__ import annotations

import argparse
import csv
import tempfile
from functools import cache
from importlib.resources import files
from pathlib import Path

import numpy as np

from presswork.study import RingMeasures, integrate_ring, measure_ring, run_sweep

FRICTION = (0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 1.0)
EXAMPLE = Path(str(files("presswork.examples") / "ring_compression.toml"))
TABLE = Path(__file__).parents[1] / "tests" / "data" / "ring_6_3_2_fe.csv"
FIRST_BORE = 30.0
"""Of the published table [mm]."""


@cache
def compress(cells: tuple[int, int] = (10, 5), element: str = "tri3") -> dict[float | str, RingMeasures]:
    """Run the curves; the keys are m and "sticking"."""
    settings = [
        f"workpiece.mesh.cells=[{cells[0]},{cells[1]}]",
        f'workpiece.element="{element}"',
        f'workpiece.mesh.pattern="{"crossed" if element.startswith("tri") else "quad"}"',
    ]
    with tempfile.TemporaryDirectory() as folder:
        shear = run_sweep(EXAMPLE, {"tools.punch.m": FRICTION}, Path(folder) / "shear", settings=settings)
        platen = {"profile": [[0, 6], [60, 6]], "contact": "sticking"}
        stick = run_sweep(EXAMPLE, {"tools.punch": [platen]}, Path(folder) / "stick", settings=settings)
        rings: dict[float | str, RingMeasures] = {}
        for member in (*shear.members, *stick.members):
            if member.status != "completed":
                print(f"{member.values}: {member.status}, {member.reason}")
                continue
            rings[member.values.get("tools.punch.m", "sticking")] = measure_ring(member.result)
    return rings


def read_published() -> dict[float, float]:
    """Return the table's bore ratios at 50 %, the mean over materials and speeds, by m."""
    lines = [line for line in TABLE.read_text("utf-8").splitlines() if not line.startswith("#")]
    rows = list(csv.DictReader(lines))
    return {
        m: float(np.mean([float(row["bore_mm"]) for row in rows if float(row["m"]) == m])) / FIRST_BORE
        for m in sorted({float(row["m"]) for row in rows})
    }


def avitzur_at_half(m: float) -> float:
    """Return Avitzur's bore ratio at 50 %."""
    return float(integrate_ring(m, 0.5)[0][0])


def print_table(rings: dict[float | str, RingMeasures]) -> None:
    """Print the bore ratios at 50 % as docs/verification/ring_compression.md has them."""
    published = read_published()
    print("| m | presswork, mean | mid-height | Avitzur | mean less Avitzur | published FE | R_n / R_i at 25 % |")
    print("|---|---|---|---|---|---|---|")
    for name, ring in rings.items():
        m = 1.0 if name == "sticking" else float(name)
        exact = avitzur_at_half(m)
        table = f"{published[m]:.3f}" if m in published and name != "sticking" else ""
        at = int(np.argmin(np.abs(ring.height_reduction - 0.25)))
        parting = 2 * ring.neutral_radius[at] / (ring.initial_bore * ring.bore_mean[at])
        print(
            f"| {name if name == 'sticking' else f'{m:g}'} | {ring.bore_mean[-1]:.3f} | {ring.bore_mid[-1]:.3f} | "
            f"{exact:.3f} | {ring.bore_mean[-1] - exact:+.3f} | {table} | {parting:.3f} |"
        )


def draw(path: str, rings: dict[float | str, RingMeasures]) -> None:
    """Draw the change of the bore against height reduction."""
    import matplotlib.pyplot as plt

    figure, ax = plt.subplots(figsize=(7.6, 5.4), layout="constrained")
    colours = plt.get_cmap("viridis")(np.linspace(0, 0.9, len(FRICTION)))
    reductions = np.linspace(0, 0.5, 101)
    for m, colour in zip(FRICTION, colours, strict=True):
        bore, _ = integrate_ring(m, reductions)
        ax.plot(100 * reductions, 100 * (bore - 1), "--", color=colour, lw=1.0)
        if m in rings:
            ring = rings[m]
            change = 100 * (ring.bore_mean - 1)
            ax.plot(100 * ring.height_reduction, change, "-", color=colour, lw=1.8)
            ax.annotate(f"m = {m:g}", (50, change[-1]), (12, 0), textcoords="offset points", va="center", fontsize=8)
    if "sticking" in rings:
        ring = rings["sticking"]
        change = 100 * (ring.bore_mean - 1)
        ax.plot(100 * ring.height_reduction, change, "k:", lw=1.8)
        ax.annotate("sticking", (50, change[-1]), (12, -8), textcoords="offset points", va="center", fontsize=8)
    published = read_published()
    ax.plot([], [], "-", color="0.3", lw=1.8, label="presswork, mean over the height (10 x 5 blocks of 4CST)")
    ax.plot([], [], "--", color="0.3", lw=1.0, label="Avitzur's upper bound, parallel field")
    for m, ratio in published.items():
        colour = colours[FRICTION.index(m)] if m in FRICTION else "white"
        ax.plot(50, 100 * (ratio - 1), "s", mfc=colour, mec="C3", mew=1.3, ms=6, clip_on=False, zorder=5)
    names = ", ".join(f"{m:g}" for m in published)
    label = f"published FE, other material; from the top m = {names}"
    ax.plot([], [], "s", mfc="white", mec="C3", mew=1.3, ms=6, label=label)
    ax.axhline(0, color="0.6", lw=0.8)
    ax.set(xlabel="height reduction [%]", ylabel="change of the bore [%]", xlim=(0, 50))
    ax.set_title("Compression of a ring 6:3:2", fontsize=10)
    ax.legend(frameon=False, fontsize=8, loc="lower left")
    ax.grid(True, color="0.92", lw=0.8)
    ax.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, dpi=130)


def main() -> None:
    """Print the table; draw if asked to."""
    parser = argparse.ArgumentParser(description="Calibration curves of the ring test")
    parser.add_argument("--picture", help="PNG file to draw")
    parser.add_argument("--cells", type=int, nargs=2, default=(10, 5), help="blocks along radius and half height")
    parser.add_argument("--element", default="tri3")
    arguments = parser.parse_args()
    rings = compress(tuple(arguments.cells), arguments.element)
    print_table(rings)
    if arguments.picture:
        draw(arguments.picture, rings)


if __name__ == "__main__":
    main()
