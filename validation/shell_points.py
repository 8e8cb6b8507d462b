# SPDX-License-Identifier: Apache-2.0
"""How many points through the thickness: moment and springback of a bent strip by rule and number of points.

Run: python -m validation.shell_points [picture.png]; 1 s.

The strip of tests/verification/bent_strip.py, linear hardening, bent to one to twenty times the curvature of first
yield. Every layer is in uniaxial tension or compression, so the section can be summed without a mesh; that shells give
these sums is tested (test_shell_plastic.py). Springback is M/EI: its error is the moment's.
"""

from __future__ import annotations

import sys

import numpy as np

from presswork.mesh.thickness_rule import thickness_rule
from presswork.model import Section
from tests.problems.bent_strip import FIRST_YIELD, MODULUS, THICKNESS, YIELD, YOUNG, moment_of

NUMBERS = (2, 3, 4, 5, 7, 9, 11, 15, 21, 31, 51)
CURVATURES = np.geomspace(1.0, 20.0, 2001) * FIRST_YIELD


def moment_by_rule(rule: str, points: int, curvatures: np.ndarray) -> np.ndarray:
    """Moment per width [N] at curvatures [1/mm], summed over the section's points."""
    position, weight = thickness_rule(Section(THICKNESS, points, rule))  # type: ignore[arg-type]
    z = 0.5 * THICKNESS * position
    strain = curvatures[:, None] * z
    tangent = YOUNG * MODULUS / (YOUNG + MODULUS)
    beyond = np.maximum(np.abs(strain) - YIELD / YOUNG, 0.0)
    stress = np.sign(strain) * (np.minimum(np.abs(strain) * YOUNG, YIELD) + tangent * beyond)
    return (stress * z * weight).sum(axis=1) * 0.5 * THICKNESS


def main(picture: str | None) -> None:
    """Print the table, and draw it."""
    exact = np.array([moment_of(k) for k in CURVATURES])
    tables: dict[str, list[tuple[int, float, float]]] = {}
    for rule in ("gauss", "lobatto", "simpson"):
        print(f"{rule}: points, mean and largest error of moment and springback")
        for n in NUMBERS:
            if rule == "simpson" and n % 2 == 0:
                continue
            wrong = np.abs(moment_by_rule(rule, n, CURVATURES) / exact - 1)
            tables.setdefault(rule, []).append((n, wrong.mean(), wrong.max()))
            print(f"  {n:3d} {100 * wrong.mean():8.2f} % {100 * wrong.max():8.2f} %")
    if picture:
        draw({rule: np.array(rows) for rule, rows in tables.items()}, picture)


def draw(tables: dict[str, np.ndarray], path: str) -> None:
    """Mean and largest error against the number of points."""
    from matplotlib import pyplot as plt

    figure, ax = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
    for colour, (rule, table) in enumerate(tables.items()):
        ax.plot(table[:, 0], 100 * table[:, 1], "o-", ms=4, color=f"C{colour}", label=f"{rule}, mean")
        ax.plot(table[:, 0], 100 * table[:, 2], "o:", ms=3, color=f"C{colour}", label=f"{rule}, largest")
    ax.set(
        xscale="log", yscale="log", xlabel="points through the thickness", ylabel="error of moment and springback [%]"
    )
    ax.set_xticks(NUMBERS, [str(n) for n in NUMBERS])
    ax.minorticks_off()
    ax.grid(color="0.9")
    ax.legend(fontsize="small")
    figure.savefig(path, dpi=130)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else None)
