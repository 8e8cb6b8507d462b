# SPDX-License-Identifier: Apache-2.0
"""Share of contact in a cycle of the explicit loop: a sheet pressed between two tools, with them and without, in turn.

    python -m benchmarks.explicit_contact
    python -m benchmarks.explicit_contact --sizes 100 --repeats 11

The sheet of explicit_shells.py, stretched equally in both directions at 20/s (its rim slides at 1 to 3 m/s, every point
plastic), lies between a die and a holder that a force of 2 MPa presses on it: every node is near both in every cycle.
Tools are two planes (a swept profile) or plates of 20,000 triangles each, without grooves or with: every tenth row of
triangles lies lower, with a sharp ridge on both sides, where edges touch beside nodes. CPU time of one thread, the
least of the repeats, runs in turn; `share` is contact's part of the cycle with contact.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from benchmarks import explicit_shells
from benchmarks.explicit_shells import SWIFT, stretched_sheet
from presswork import _core
from presswork.explicit.shells import Device, ExplicitShells, Precision, ShellOptions

MU, THICKNESS, PRESSURE, RATE = 0.1, 0.8, 2.0, 20.0
COLUMNS = {"planes": (False, False), "20,000 triangles": (True, False), "triangles, grooves": (True, True)}


def draw_plate(size: float, up: bool, triangles: bool, grooves: bool) -> _core.ToolSurface:
    """Return a plate in z = 0 over the sheet, metal below (up) or above."""
    if not triangles:
        ends = [2 * size, 0.0, -2 * size, 0.0] if not up else [-2 * size, 0.0, 2 * size, 0.0]
        return _core.ToolSurface.swept((2 * size, np.inf), 0.0, np.array([[*ends, 0.0, 0.0, 0.0]]))
    n = 100
    x, y = np.meshgrid(np.linspace(-0.1 * size, 1.1 * size, n + 1), np.linspace(-0.1 * size, 1.1 * size, n + 1))
    depth = np.where(np.arange(n + 1) % 10 == 5, -0.02 * size, 0.0) if grooves else np.zeros(n + 1)
    points = np.stack([x.ravel(), y.ravel(), np.tile(depth if up else -depth, n + 1)], axis=1)
    a = (np.arange(n)[None, :] + (n + 1) * np.arange(n)[:, None]).ravel()
    cells = np.concatenate([np.stack([a, a + 1, a + n + 2], axis=1), np.stack([a, a + n + 2, a + n + 1], axis=1)])
    return _core.ToolSurface.triangles(points, np.ascontiguousarray(cells if up else cells[:, ::-1], dtype=np.int32))


def pressed_sheet(
    n: int, triangles: bool, grooves: bool, precision: Precision = "double", device: Device = "cpu"
) -> ExplicitShells:
    """Return n x n shells between die and holder."""
    sheet = stretched_sheet(n, SWIFT, ShellOptions(), precision, device)
    for name, up in (("die", True), ("holder", False)):
        tool = sheet.add_tool(name, draw_plate(n, up, triangles, grooves), mu=MU)
        tool.position = [0.0, 0.0, (-0.5 if up else 0.5) * THICKNESS]
    sheet.tools["holder"].push([0, 0, -1], PRESSURE * n * n)
    return sheet


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", type=int, nargs="+", default=[100, 200], help="shells along an edge")
    parser.add_argument("--repeats", type=int, default=7)
    given = parser.parse_args()
    _core.set_threads(1)
    explicit_shells.RATE = RATE
    print("microseconds per shell and cycle, one thread, and the share of contact")
    print(f"{'shells':>9} {'no tools':>9} " + " ".join(f"{name:>24}" for name in COLUMNS))
    for n in given.sizes:
        runs = [stretched_sheet(n, SWIFT, ShellOptions()), *(pressed_sheet(n, *kind) for kind in COLUMNS.values())]
        cycles = max(4, round(6e5 / n**2))
        for run in runs:
            run.advance(max(200, cycles))
        best = [np.inf] * len(runs)
        for _ in range(given.repeats):
            for i, run in enumerate(runs):
                started = time.process_time()
                run.advance(cycles)
                best[i] = min(best[i], (time.process_time() - started) / cycles / n**2 * 1e6)
        row = " ".join(f"{b:15.4f} {1 - best[0] / b:7.1%} " for b in best[1:])
        print(f"{n * n:9,} {best[0]:9.4f} {row}", flush=True)
        assert all(abs(run.energies().error_percent) < 1.0 for run in runs)


if __name__ == "__main__":
    main()
