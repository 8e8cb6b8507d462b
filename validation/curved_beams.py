# SPDX-License-Identifier: Apache-2.0
"""Two curved beams that slide over each other with friction, beside Neto et al. (2016): forces, increments, picture.

Run: python -m validation.curved_beams [--picture docs/img/curved_beams.png]
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from presswork.implicit.progress import Progress
from presswork.model import FloatArray, SolverSettings
from tests.problems.sliding_arches import beams, slide

FRICTION = (0.0, 0.3, 0.6)
DATA = Path(__file__).parents[1] / "tests" / "data" / "curved_beams_neto.csv"


@dataclass(frozen=True)
class Slide:
    """One run: way and forces of the feet by increment (n, 3), counts, and the error of the energy balance [%]."""

    rows: FloatArray
    increments: int
    iterations: int
    cutbacks: int
    energy: dict[str, float]

    @property
    def largest(self) -> tuple[float, float, float]:
        """Smallest and largest force along x, largest along y [N]."""
        return float(self.rows[:, 1].min()), float(self.rows[:, 1].max()), float(self.rows[:, 2].max())


def read_reference(mu: float, direction: str) -> FloatArray:
    """Return way [mm] and force [N] of the reference (n, 2)."""
    table = np.genfromtxt(DATA, delimiter=",", skip_header=2, dtype=None, encoding="utf-8")
    return np.array([[row[2], row[3]] for row in table if row[0] == mu and row[1] == direction])


def run(mu: float) -> Slide:
    """Slide with the default increments."""
    rows, procedure = slide(beams(mu, SolverSettings(symmetric=False)))
    progress = procedure.state[Progress]
    counts = [progress.increments, progress.iterations, progress.cutbacks]
    return Slide(np.vstack([np.zeros(3), rows[:, :3]]), *counts, procedure.energy_balance())


def draw(path: str, runs: dict[float, Slide]) -> None:
    """Draw both forces over the way, the reference as dots."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(10.4, 4.4), layout="constrained")
    for number, (mu, found) in enumerate(runs.items()):
        for ax, column, direction in zip(axes, (1, 2), "xy", strict=True):
            ax.plot(found.rows[:, 0], found.rows[:, column], f"C{number}-", label=f"presswork, μ = {mu:g}")
            ax.plot(*read_reference(mu, direction).T, f"C{number}o", ms=3.5, mfc="none", label="Neto et al. 2016")
            ax.set(
                xlabel="way of the upper beam [mm]", ylabel=f"force on the feet along {direction} [N]", xlim=(0, 31.5)
            )
    for ax in axes:
        ax.grid(alpha=0.3)
    axes[1].legend(fontsize=8)
    figure.savefig(path, dpi=110)


def main() -> None:
    """Print the table of docs/verification/curved_beams.md."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--picture")
    options = parser.parse_args()
    print(
        "| μ | Fx presswork | Neto et al. | Fy presswork | Neto et al. | increments | iterations | cut-backs | energy |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    runs = {}
    for mu in FRICTION:
        found = runs[mu] = run(mu)
        low, high, up = found.largest
        x, y = (read_reference(mu, d)[:, 1] for d in "xy")
        forces = f"{low:.2f}, {high:.2f} | {x.min():.2f}, {x.max():.2f} | {up:.2f} | {y.max():.2f}"
        counts = f"{found.increments} | {found.iterations} | {found.cutbacks}"
        print(f"| {mu:g} | {forces} | {counts} | {found.energy['error_percent']:+.2f} % |")
    if options.picture:
        draw(options.picture, runs)


if __name__ == "__main__":
    main()
