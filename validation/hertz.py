# SPDX-License-Identifier: Apache-2.0
"""Hertz contact of a cylinder and a sphere: computed pressure on the exact ellipse, and its error over the width a/R.

Run: python -m validation.hertz [--picture docs/img/hertz.png]
"""

from __future__ import annotations

import argparse

import numpy as np

from tests.problems.hertz import RADIUS, Hertz, press
from tests.verification.test_hertz import EDGES

SHAPES = {"plane_strain": "cylinder", "axisymmetric": "sphere"}
WIDTHS = (0.005, 0.01, 0.02, 0.05, 0.1)


def print_row(shape: str, element: str, width: float, contact: Hertz) -> None:
    """Print one line of the table in docs/verification/hertz.md."""
    half_width = contact.half_width / contact.exact_half_width - 1
    largest, fitted = (p / contact.exact_peak - 1 for p in (contact.pressure.max(), contact.peak))
    errors = f"{half_width:+.2%} | {fitted:+.2%} | {largest:+.2%}"
    print(f"| {shape} | {element} | {width:g} | {contact.nodes_across} | {errors} |")


def draw(path: str, contacts: dict[tuple[str, str], Hertz]) -> None:
    """Draw pressure over distance, both over Hertz's values."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(10.4, 4.4), sharey=True, layout="constrained")
    x = np.linspace(0, 1, 400)
    for ax, (analysis, shape) in zip(axes, SHAPES.items(), strict=True):
        ax.plot(x, np.sqrt(1 - x**2), "k-", lw=1.0, label="Hertz")
        for element, style in zip(EDGES, ("C0^", "C1s", "C2.", "C3o"), strict=True):
            contact = contacts[analysis, element]
            place = contact.place * RADIUS / contact.exact_half_width
            fill = {"mfc": "none"} if element != "quad4_fbar" else {}
            ax.plot(place, contact.pressure / contact.exact_peak, style, ms=5, label=element, **fill)
        raw = contacts[analysis, "quad8_2x2"]
        place = raw.place * RADIUS / raw.exact_half_width
        ax.plot(place, raw.nodal_pressure / raw.exact_peak, "C3+", ms=5, label="quad8_2x2, nodal force over share")
        ax.set(xlabel="distance from the axis over a", xlim=(0, 1.1), ylim=(0, 1.08))
        ax.set_title(f"elastic {shape} on a rigid plane, a/R = {raw.exact_half_width / RADIUS:.3f}", fontsize=10)
        ax.grid(True, color="0.92", lw=0.8)
        ax.spines[["top", "right"]].set_visible(False)
    axes[0].set_ylabel("contact pressure over p0")
    axes[0].legend(frameon=False, fontsize=8, loc="lower left")
    figure.savefig(path, dpi=130)


def main() -> None:
    """Print the table; draw if asked to."""
    parser = argparse.ArgumentParser(description="Hertz contact")
    parser.add_argument("--picture", help="PNG file to draw")
    arguments = parser.parse_args()
    print("| body | element | a/R | nodes across a | half-width | peak of the fitted ellipse | largest pressure |")
    print("|---|---|---|---|---|---|---|")
    contacts = {}
    for analysis, shape in SHAPES.items():
        for element, edges in EDGES.items():
            contacts[analysis, element] = press(analysis, element, edges=edges)
            print_row(shape, element, 0.02, contacts[analysis, element])
    for analysis, shape in SHAPES.items():
        for width in WIDTHS:
            print_row(shape, "quad4_fbar", width, press(analysis, "quad4_fbar", half_width=width * RADIUS))
    if arguments.picture:
        draw(arguments.picture, contacts)


if __name__ == "__main__":
    main()
