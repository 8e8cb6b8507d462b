# SPDX-License-Identifier: Apache-2.0
"""How far the square cup of Cheng (1995) is drawn implicitly by each shell, with the Kirchhoff penalty and without.

    python -m validation.penalty_cup [element ...]

draws a quarter of the example `square_cup`, 169 nodes, towards 27 mm, and prints the depth reached, increments,
iterations and cut-backs: all twenty shells, C_p = 0 and 1, ten minutes on one core. A run ends at full depth, when an
increment of 3 um finds no equilibrium, or after twenty seconds of processor time.
"""

from __future__ import annotations

import sys
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from time import process_time
from typing import get_args

import numpy as np

from presswork.case import build_model, read_case
from presswork.examples import copy_example
from presswork.implicit.progress import Progress
from presswork.implicit.stepping import ImplicitProcedure
from presswork.mesh.shells import mesh_shell_rectangle
from presswork.model import Model, ShellElement
from presswork.outcome import GaveUpError
from presswork.process.implicit.stamping import make_shell_model

DEPTH = 27.0
SIDE = 50.0
CELLS = 12
"""Of 4 nodes along the quarter's side; half as many of 6, 8 or 9."""
SECONDS = 20.0
PENALTIES = {0.0: (6, 25), 1.0: (20, 50)}
"""With the iterations below which increments grow, and the largest number: the penalty makes them converge linearly."""


@dataclass(frozen=True)
class Draw:
    """How far a run came."""

    depth: float
    increments: int
    iterations: int
    cutbacks: int
    end: str
    """"full depth", "gave up" or "out of time"."""


def make_model(element: ShellElement, penalty: float, cells: int = CELLS) -> Model:
    """Return the cup of shells of one kind."""
    with tempfile.TemporaryDirectory() as folder:
        keys = ['procedure="implicit"', f"stages.0.tools.punch.stroke={DEPTH}", "output.steps=1"]
        stamping = build_model(read_case(copy_example("square_cup", Path(folder)), keys))
    model = make_shell_model(stamping)
    section = model.mesh.blocks[0].section
    lines = np.linspace(0.0, SIDE, (cells // 2 if element[5] in "689" else cells) + 1)
    mesh = mesh_shell_rectangle(lines, lines, element=element, section=section)
    planes = {"symmetry_x": mesh.node_sets["left"], "symmetry_y": mesh.node_sets["bottom"]}
    target, most = PENALTIES[penalty]
    solver = replace(
        model.solver, kirchhoff_penalty=penalty, target_iterations=target, max_iterations=most, min_increment=1e-4
    )
    return replace(model, mesh=replace(mesh, node_sets=planes), solver=solver)


def draw(element: ShellElement, penalty: float, seconds: float = SECONDS) -> Draw:
    """Draw until the depth is reached, nothing goes on or time is up."""
    procedure = ImplicitProcedure(make_model(element, penalty), threads=1)
    started, end = process_time(), "full depth"
    try:
        for _ in procedure.advance():
            if process_time() - started > seconds and procedure.remaining() > 0.0:
                end = "out of time"
                break
    except GaveUpError:
        end = "gave up"
    progress = procedure.state[Progress]
    depth = DEPTH * (progress.fraction + (progress.stage > 0))
    return Draw(float(depth), progress.increments, progress.iterations, progress.cutbacks, end)


def main(elements: list[str]) -> None:
    """Print the table."""
    print("element           C_p   depth [mm]  increments  iterations  cut-backs")
    for element in elements or get_args(ShellElement):
        for penalty in PENALTIES:
            found = draw(element, penalty)  # type: ignore[arg-type]
            print(
                f"{element:16s}{penalty:5g}{found.depth:13.2f}{found.increments:12d}{found.iterations:12d}"
                f"{found.cutbacks:11d}  {found.end}",
                flush=True,
            )


if __name__ == "__main__":
    main(sys.argv[1:])
