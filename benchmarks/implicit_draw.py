# SPDX-License-Identifier: Apache-2.0
"""Increments, iterations, factorisations and cut-backs of an implicit draw: the packaged square cup, a quarter.

    python -m benchmarks.implicit_draw [sizes of the shells in mm ...] [--stroke 27] [--set KEY=VALUE]

Iterations that failed attempts took are counted, too: each costs as much as one that led on.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path
from time import perf_counter, process_time

import numpy as np

from presswork.body.shell_arrays import ShellArrays
from presswork.case import build_model, read_case
from presswork.examples import copy_example
from presswork.implicit.stepping import GaveUpError, ImplicitProcedure
from presswork.process.implicit.stamping import make_shell_model


def draw(size: float, stroke: float, overrides: list[str], threads: int) -> None:
    """Draw the cup with shells of `size` [mm] and print what it took and what came out."""
    with tempfile.TemporaryDirectory() as folder:
        keys = ['procedure="implicit"', f"stages.0.tools.punch.stroke={stroke}", f"blank.element_size={size}"]
        model = make_shell_model(build_model(read_case(copy_example("square_cup", Path(folder)), [*keys, *overrides])))
    procedure = ImplicitProcedure(model, threads=threads)
    solver, factorisations = procedure.equilibrium.solver, 0
    inner = solver.factorise

    def counted(*data: object) -> None:
        nonlocal factorisations
        factorisations += 1
        inner(*data)

    solver.factorise = counted
    started, cpu = perf_counter(), process_time()
    increments = iterations = cutbacks = 0
    ended = ""
    try:
        for report in procedure.advance():
            increments, iterations = increments + 1, iterations + len(report.log) - 1
            cutbacks += len(report.cutbacks)
    except GaveUpError as error:
        ended = f"  {error}"
    cpu, wall = process_time() - cpu, perf_counter() - started
    state, points = procedure.state, model.mesh.points
    force = 4e-3 * procedure.interactions.space_tools.contact.tool_forces(state)[0, 2]
    moved = state.nodes.displacement
    side, corner = (int(np.argmax(points[:, 0] + sign * points[:, 1])) for sign in (-1, 1))
    thickness = np.concatenate([t.ravel() for t in state[ShellArrays].thickness])
    print(
        f"{len(model.cells):7d}{increments:7d}{iterations:8d}{factorisations:8d}{cutbacks:6d}{cpu:9.1f}{wall:9.1f}  "
        f"{force:7.3f} kN  draw-in {-moved[side, 0]:.3f} and {np.hypot(*moved[corner, :2]):.3f} mm  "
        f"thickness {thickness.min():.4f} to {thickness.max():.4f} mm  {procedure.timing.shares()}{ended}",
        flush=True,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sizes", nargs="*", type=float, default=[2.0])
    parser.add_argument("--stroke", type=float, default=27.0)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    arguments = parser.parse_args()
    print(" shells  incr.  solves factor.  cuts    cpu s   wall s")
    for size in arguments.sizes:
        draw(size, arguments.stroke, arguments.set, arguments.threads)


if __name__ == "__main__":
    main()
