# SPDX-License-Identifier: Apache-2.0
"""How far the square cup's answer moves with friction, holder, mesh, element, material, speed, procedure and punch.

    python -m validation.cup_influence OUT [name ...] [--processes N]

Draws the cup of Cheng (1995), chapter 4, once as chosen and then with one thing changed at a time, and prints for each:
draw-in at mid-side and along the diagonal at the four strokes of figure 4.9, where that is closer to the experiment
than the thesis's own, largest punch force and the extremes of thickness strain. A minute of one core a row with shells
of 1 mm.
"""

from __future__ import annotations

import argparse
import multiprocessing
from pathlib import Path

import numpy as np

from validation.square_cup import EXPERIMENT, STROKE, THESIS, draw_cup, draw_in

R_VALUES = 'materials.steel.yield_function={law="hill1948", r00=1.79, r45=1.51, r90=2.27}'


def friction(value: float, *tools: str) -> list[str]:
    """Return the keys for a coefficient of friction on some tools, or all."""
    return [f"tools.{tool}.mu={value}" for tool in tools or ("punch", "die", "holder")]


def round_punch() -> list[str]:
    """Return the keys of the thesis's second process: a cylindrical punch of 50 mm, the die's shoulder 9 mm."""
    punch, opening = 'kind="{}", shape="round", diameter={}, edge_radius={}, mu=0.144', 54
    return [
        f"tools.punch={{{punch.format('punch', 50, 4)}}}",
        f"tools.die={{{punch.format('die', opening, 9)}}}",
        f"tools.holder={{{punch.format('holder', opening, 1)}}}",
    ]


# name, size of the shells [mm], what differs from the choice
VARIANTS: dict[str, tuple[float, list[str]]] = {
    "as chosen": (1.0, []),
    "holder 10 kN": (1.0, ['stages.0.tools.holder.force="10 kN"']),
    "holder 20 kN": (1.0, ['stages.0.tools.holder.force="20 kN"']),
    "holder 40 kN": (1.0, ['stages.0.tools.holder.force="40 kN"']),
    "friction 0.10": (1.0, friction(0.10)),
    "friction 0.20": (1.0, friction(0.20)),
    "friction of the punch 0.30": (1.0, friction(0.30, "punch")),
    "shells of 2 mm": (2.0, []),
    "shells of 0.5 mm": (0.5, []),
    "r = 1.79, 1.51, 2.27": (1.0, [R_VALUES]),
    "punch speed 1 m/s": (1.0, ['stages.0.velocity="1 m/s"']),
    "punch 50 mm, gap 2 mm": (1.0, ["tools.punch.size=[50, 50]"]),
    "cylindrical punch": (1.0, round_punch()),
    "implicit, 2 mm": (2.0, ['procedure="implicit"']),
}


def compute(work: tuple[str, str]) -> str:
    """Draw one variant, given its name and the folder; return its rows."""
    name, folder = work
    size, keys = VARIANTS[name]
    cup = draw_cup(Path(folder) / name.replace(" ", "_").replace(",", "").replace("/", "_"), size, *keys)
    rows = [name]
    for angle, measured in EXPERIMENT.items():
        values, theirs = draw_in(cup, angle), THESIS[angle]
        closer = "".join("+" if c else "-" for c in np.abs(values - measured) < np.abs(theirs - measured))
        rows.append(f"   {angle:3.0f} degrees  " + " ".join(f"{v:6.2f}" for v in values) + f"   {closer}")
    low, high = cup.summary["extremes"]["thickness_strain"]
    rows.append(
        f"   punch at most {cup.history['punch.force'].max() / 1e3:.1f} kN, thickness strain {low:.3f} to {high:.3f}"
    )
    return "\n".join(rows)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("names", nargs="*", help=f"some of: {'; '.join(VARIANTS)}")
    parser.add_argument("--processes", type=int, default=multiprocessing.cpu_count())
    given = parser.parse_args()
    print(
        "stroke          " + " ".join(f"{s:6.2f}" for s in STROKE) + " mm; + closer to the experiment than the thesis"
    )
    for name, table in (("experiment", EXPERIMENT), ("thesis", THESIS)):
        print(name)
        for angle, row in table.items():
            print(f"   {angle:3.0f} degrees  " + " ".join(f"{v:6.2f}" for v in row))
    with multiprocessing.get_context("spawn").Pool(given.processes) as pool:
        work = [(name, given.folder) for name in given.names or VARIANTS]
        for text in pool.imap(compute, work):
            print(text, flush=True)


if __name__ == "__main__":
    main()
