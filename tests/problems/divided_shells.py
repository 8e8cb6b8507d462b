# SPDX-License-Identifier: Apache-2.0
"""Implicit runs of shells that ranks share, beside the same runs whole on each rank: how far their states are apart.

    mpiexec -n 3 python -m tests.problems.divided_shells [names of runs]

Rank 0 prints a line of JSON: by run, the largest difference of each array of its state over that array's size, the
first number that of a run beside one process, the second beside a repeated one.
"""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from presswork.model import Model, PrescribedDisplacement, Stage, Support
from presswork.process.begin import choose
from presswork.ranks.world import World, find_world, start_petsc
from tests.problems.divided_loops import describe_formed, describe_line, heat_up, read
from tests.problems.shells import RX, RY, RZ, X, Y, Z, fixing
from tests.problems.square_cup import BEAD, describe_cup
from tests.problems.stacked_plates import GAP, SIDE, stack

ROOF = Path(__file__).parents[2] / "src" / "presswork" / "examples" / "scordelis_lo_roof.toml"
EXACT = "\n[implicit]\nforce_tolerance = 1e-7\n"
"""What two linear solvers leave apart is below what Newton's method leaves."""
SHORT = EXACT + "initial_increment = 0.05\nmax_increment = 0.1\n"
SMALL = 1e-5
"""Size of an array, in its own unit, below which it is nothing but round-off."""
RELEASED = """
[trim.flange]
shape = "rectangle"
size = [80, 80]
corner_radius = 8
[springback]
"""


def describe_implicit_cup(size: float = 12, stroke: float = 1.0) -> str:
    """Return the text of a cup that is drawn a little by increments, between pushed tools. size: of shells [mm]."""
    text = describe_cup(size).replace('procedure = "explicit"', 'procedure = "implicit"')
    return text.replace("stroke = 2", f"stroke = {stroke}").replace("rows = 10", "rows = 2")


def describe_hot_cup() -> str:
    """Return the text of a hot cup that its tools cool."""
    return heat_up(describe_implicit_cup()).replace("velocity =", "process_time = 1\nvelocity =")


def pull_plate() -> Model:
    """Return the model of two plates in one mesh: one is pressed on the other, and pulled along it by its end."""
    stages = (
        Stage("close", prescribed=(PrescribedDisplacement("upper", Z, -GAP - 0.01),)),
        Stage("pull", prescribed=(PrescribedDisplacement("end", X, 0.02),)),
    )
    model = stack(stages, (Support("upper", fixing(Y, Z, RX, RY, RZ)), Support("end", fixing(X))), 0.2, upper=5)
    upper = model.mesh.node_sets["upper"]
    ends = {"end": upper[model.mesh.points[upper, 0] == SIDE]}
    solver = replace(model.solver, initial_increment=0.2, max_increment=0.2)
    return replace(model, mesh=replace(model.mesh, node_sets={**model.mesh.node_sets, **ends}), solver=solver)


def bend_roof() -> Model:
    """Return the model of a shell under its weight, whose matrix is symmetric."""
    return read(ROOF.read_text().replace("cells = [16, 16]", "cells = [6, 5]"))


def draw_formed() -> Model:
    """Return the model of a cup that begins with a part formed by the explicit procedure, which its mass holds."""
    with tempfile.TemporaryDirectory() as folder:
        text = describe_formed(Path(folder)).replace('"explicit"', '"implicit"')
        return read(f"{text}{EXACT}inertia = 1e-2\n")


def list_runs() -> dict[str, tuple[Callable[[], Model], int]]:
    """Return by name what makes the model of a run, and after how many increments it ends; 0: at its end."""
    cup = describe_implicit_cup()
    torn = cup.replace("poisson = 0.3", 'poisson = 0.3\ndamage = {criterion = "cockcroft_latham", critical = 0.5}')
    return {
        "beads": (lambda: read(cup + BEAD + EXACT), 6),
        "triangles": (lambda: read(torn.replace("[blank]", '[blank]\ncells = "triangles"') + EXACT), 6),
        "released": (lambda: read(cup + RELEASED + SHORT), 0),
        "line": (lambda: read(describe_line().replace('"explicit"', '"implicit"') + SHORT), 10),
        "hot": (lambda: read(describe_hot_cup() + EXACT), 6),
        "formed": (draw_formed, 4),
        "plates": (pull_plate, 0),
        "roof": (bend_roof, 0),
    }


def compute(model: Model, world: World | None, increments: int) -> dict[str, Any]:
    """Compute increments of a model, 0: all; return its state."""
    run = choose(model, 1, world)
    for number, _ in enumerate(run.advance()):
        if number + 1 == increments:
            break
    return dict(run.to_arrays())


def measure(one: dict[str, Any], other: dict[str, Any]) -> dict[str, float]:
    """Return by array how far two states are apart, over the array's size."""
    assert set(one) == set(other)
    apart = {}
    for name, values in one.items():
        first, second = (np.nan_to_num(np.asarray(v, dtype=float), posinf=0.0) for v in (values, other[name]))
        size = max(float(np.abs(first).max(initial=0.0)), SMALL)
        apart[name] = float(np.abs(first - second).max(initial=0.0)) / size
    return apart


def main(names: list[str]) -> None:
    """Compute runs, all if none are named."""
    world = find_world()
    assert world is not None
    start_petsc(world)
    runs = {}
    for name, (make, increments) in list_runs().items():
        if names and name not in names:
            continue
        whole, shared, again = (compute(make(), each, increments) for each in (None, world, world))
        runs[name] = measure(whole, shared), measure(shared, again)
    if world.rank == 0:
        print(json.dumps(runs))


if __name__ == "__main__":
    main(sys.argv[1:])
