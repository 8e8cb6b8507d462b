# SPDX-License-Identifier: Apache-2.0
"""Where a cycle of the square cup's explicit draw goes, and what its whole stroke costs.

    python -m benchmarks.explicit_draw                  10,000 shells of 0.5 mm, a quarter of the cup, one thread
    python -m benchmarks.explicit_draw 1 --set explicit.precision=single

The cup of validation/square_cup.py is drawn at 10 m/s and, at five depths, at 2 m/s over a window of 0.25 mm, in which
CPU time is measured: nanoseconds a shell and cycle, shared out by the loop's wall clock, and the time step. Cycles and
CPU time of 24.53 mm at 2 m/s follow from them by interpolation over the depth. Rows and saved steps are not counted
(explicit_output.py).
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path
from time import process_time

import numpy as np

from presswork.case import build_model, read_case
from presswork.examples import copy_example
from presswork.process.explicit.stamping import ExplicitStamping

DEPTHS, WINDOW, STROKE = (1.0, 6.0, 12.0, 18.0, 24.0), 0.25, 24.53
SLOW, FAST, ROWS = 2000.0, 10_000.0, 10
PHASES = ("elements", "contact", "nodes", "waiting")


def write_case(folder: Path) -> Path:
    """Write the example with a stage to each depth, and one through the window there."""
    case = copy_example("square_cup", folder)
    text, reached = case.read_text().partition("[[stages]]")[0], 0.0
    for depth in DEPTHS:
        for name, to, speed in (("to", depth, FAST), ("window", depth + WINDOW, SLOW)):
            text += f'[[stages]]\nname = "{name}_{depth:g}"\nvelocity = {speed}\n'
            text += f'tools.punch = {{stroke = {to - reached}}}\ntools.holder = {{force = "15 kN"}}\n'
            reached = to
    case.write_text(text + f"[output]\nrows = {ROWS}\nsteps = 1\n")
    return case


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("size", type=float, nargs="?", default=0.5, help="of the shells [mm]")
    parser.add_argument("--set", nargs="*", default=[], dest="keys", metavar="KEY=VALUE", help="of the case")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        keys = [f"blank.element_size={given.size}", "explicit.ironing=false", *given.keys]
        run = ExplicitStamping(build_model(read_case(write_case(Path(folder)), keys)), threads=1)
    n = len(run.model.cells)
    print(
        f"{n:,} shells; ns of CPU a shell and cycle\ndepth [mm]   step [s]    all "
        + " ".join(f"{p:>9}" for p in PHASES)
    )
    steps, costs = [], []
    rows = run.advance()
    for depth in DEPTHS:
        for _ in range(ROWS + 2):  # the window's speed rises in its first rows
            next(rows)
        cycles, started, before = 0, process_time(), run.shells.seconds
        for _ in range(ROWS - 4):
            cycles += next(rows).cycles
        spent, after = (process_time() - started) / cycles / n * 1e9, run.shells.seconds
        for _ in range(2):
            next(rows)
        share = np.array([after[p] - before[p] for p in PHASES])
        steps.append(run.shells.dt)
        costs.append(spent)
        parts = " ".join(f"{x:9.1f}" for x in spent * share / share.sum())
        print(f"{depth:10g} {run.shells.dt:10.3g} {spent:6.1f} {parts}", flush=True)
    at = np.linspace(0.0, STROKE, 1000)
    rate = STROKE / len(at) / SLOW / np.interp(at, DEPTHS, steps)
    spent = float((rate * np.interp(at, DEPTHS, costs)).sum()) * n / 1e9
    print(f"{STROKE} mm at 2 m/s: {rate.sum():,.0f} cycles, {spent:.0f} s of CPU")


if __name__ == "__main__":
    main()
