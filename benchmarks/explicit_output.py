# SPDX-License-Identifier: Apache-2.0
"""What an explicit stamping pays for its rows and saved steps, beside its cycles.

`python -m benchmarks.explicit_output [SIZE ...]` prints CPU milliseconds of one thread, the least of the repeats in
turn, of the packaged square cup with shells of each size [mm], after its first row, or `--rows` of 200 at 40 m/s: a
hundred cycles; a look at the state, which follows every row, and what it would take by all fields of the sheet; a step
to save, and to write. The sheet has places to look for folds only where it has been drawn.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Callable
from pathlib import Path
from time import process_time

import numpy as np

from presswork.case import build_model, read_case
from presswork.examples import copy_example
from presswork.process.explicit.stamping import ExplicitStamping
from presswork.step_writer import append_snapshot


def measure(size: float, folder: Path, repeats: int, rows: int) -> dict[str, float]:
    """Return milliseconds of each task."""
    keys = ["explicit.target_step=1e-6"] if rows == 1 else ["stages.0.velocity=40000"]
    case = read_case(copy_example("square_cup", folder), [f"blank.element_size={size}", *keys])
    run = ExplicitStamping(build_model(case), threads=1)
    advance = run.advance()
    for _ in range(rows):
        next(advance)
    snapshot, file = run.snapshot(), folder / f"{size}.vtkhdf"
    tasks: dict[str, Callable[[], object]] = {
        "cycles": lambda: run.shells.advance(100, velocity_scale=0.0),
        "look": run.watch,
        "all": lambda: run.judge_fields(run._fields.find()),
        "save": run.snapshot,
        "write": lambda: append_snapshot(file, run.mesh, snapshot),
    }
    least = dict.fromkeys(tasks, np.inf)
    for _ in range(repeats):
        for name, task in tasks.items():
            started = process_time()
            task()
            least[name] = min(least[name], 1e3 * (process_time() - started))
    return {"shells": len(run.model.cells), **least}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sizes", type=float, nargs="*", default=[2.0, 1.0, 0.5])
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--rows", type=int, default=1, help="to compute before")
    given = parser.parse_args()
    print("| shells | 100 cycles | look at a row | by all fields | a step to save | to write |")
    with tempfile.TemporaryDirectory() as folder:
        for size in given.sizes:
            place = Path(folder) / str(size)
            place.mkdir()
            shells, *times = measure(size, place, given.repeats, given.rows).values()
            print(f"| {shells:,.0f} | {' | '.join(f'{t:.1f}' for t in times)} |", flush=True)


if __name__ == "__main__":
    main()
