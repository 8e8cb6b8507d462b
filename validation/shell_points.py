# SPDX-License-Identifier: Apache-2.0
"""How many points through the thickness: moment and springback of a bent strip by rule and number of points.

Run: python validation/shell_points.py [picture.png]; about a minute.

The strip of tests/verification/bent_strip.py, linear hardening by 1000 MPa, bent to
twelve times the curvature of first yield in as many increments and let go; against the closed form.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "verification"))

from bent_strip import FIRST_YIELD, INERTIA, YOUNG, bend, moment_of, steel, strip

RULES = {"gauss": (2, 3, 4, 5, 7, 9, 11, 15, 21, 31, 51), "lobatto": (2, 3, 4, 5, 7, 9, 11, 15, 21, 31, 51),
         "simpson": (3, 5, 7, 9, 11, 15, 21, 31, 51)}  # fmt: skip
MODULUS = 1000.0
LARGEST = 12


def errors(rule: str, points: int) -> tuple[float, float, float]:
    """Mean and largest error of the moment over the curvatures beyond first yield, and that of the springback."""
    found, _ = bend(strip(points, rule), steel(modulus=MODULUS), [LARGEST * FIRST_YIELD], increments=LARGEST,
                    release=True)  # fmt: skip
    bent = [(k, m) for k, m, stage in found if stage != "release"][1:]
    wrong = np.array([m / moment_of(k, MODULUS) - 1 for k, m in bent])
    last = bent[-1][0]
    wanted = moment_of(last, MODULUS) / (YOUNG * INERTIA)
    return float(np.abs(wrong).mean()), float(np.abs(wrong).max()), (last - found[-1][0]) / wanted - 1


def main(picture: str | None) -> None:
    """Print the table, and draw it."""
    tables = {}
    for rule, numbers in RULES.items():
        tables[rule] = np.array([(n, *errors(rule, n)) for n in numbers])
        print(f"{rule}: points, mean and largest error of the moment, error of the springback")
        for n, mean, most, spring in tables[rule]:
            print(f"  {n:3.0f} {100 * mean:8.2f} % {100 * most:8.2f} % {100 * spring:+8.2f} %", flush=True)
    if picture:
        draw(tables, picture)


def draw(tables: dict[str, np.ndarray], path: str) -> None:
    """Mean and largest error against the number of points."""
    from matplotlib import pyplot as plt

    figure, ax = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
    for colour, (rule, table) in enumerate(tables.items()):
        ax.plot(table[:, 0], 100 * table[:, 1], "o-", ms=4, color=f"C{colour}", label=f"{rule}, mean")
        ax.plot(table[:, 0], 100 * table[:, 2], "o:", ms=3, color=f"C{colour}", label=f"{rule}, largest")
    ax.set(xscale="log", yscale="log", xlabel="points through the thickness", ylabel="error of the moment [%]")
    ticks = RULES["gauss"]
    ax.set_xticks(ticks, [str(n) for n in ticks])
    ax.minorticks_off()
    ax.grid(color="0.9")
    ax.legend(fontsize="small")
    figure.savefig(path, dpi=130)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else None)
