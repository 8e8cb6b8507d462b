# SPDX-License-Identifier: Apache-2.0
"""Speed of the layered shells: internal force, tangent, assembly and solution, by element and number of threads.

Run: python -m benchmarks.shells [cells a side, default 100]

A square sheet with 5 points through the thickness, von Mises with Swift's hardening, all points plastic. Each time is
the least of a few; the load of the machine is printed, since it is what spoils them. With a C++ compiler at hand the
one-point shell's kernel is measured alone too (shell_kernel.cpp).
"""

from __future__ import annotations

import os
import sys
from time import perf_counter

import numpy as np

from benchmarks.machine import run_program
from presswork import _core
from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import Hardening, Material, Model
from tests.problems.shells import CLAMPED, X, Y, patch, shell_model, symmetry

REPEATS = 5


def sheet(n: int, element: str = "shell4_mitc") -> Model:
    lines = np.linspace(0, 100, n + 1)
    mesh = patch(lambda u, v: np.column_stack([u, v, 0 * u]), lines, lines, element=element, thickness=1.0, points=5)
    swift = Material("steel", 206e3, 0.3, Hardening("swift", np.array([565.32, 0.007117, 0.2589])))
    held = [("left", symmetry(X)), ("bottom", symmetry(Y)), ("right", CLAMPED), ("top", CLAMPED)]
    return shell_model(mesh, swift, held, pressures=[("all", 1.0)])


def least_seconds(work) -> float:
    """Least time of a few runs [s]."""
    times = []
    for _ in range(REPEATS):
        started = perf_counter()
        work()
        times.append(perf_counter() - started)
    return min(times)


def stretched(procedure: ImplicitProcedure) -> np.ndarray:
    """An increment that makes every point flow: 2 % biaxial stretching with a dome."""
    points = procedure.model.mesh.points
    increment = np.zeros((len(points), 6))
    increment[:, :2] = 0.02 * points[:, :2]
    increment[:, 2] = 1.0 * np.cos(points[:, 0] * np.pi / 200) * np.cos(points[:, 1] * np.pi / 200)
    return increment


def evaluation_seconds(procedure: ImplicitProcedure) -> tuple[float, float]:
    """Time of one evaluation without and with the tangent [s]."""
    state, increment = procedure.state, stretched(procedure)
    trial = state.duplicate()

    def evaluate(with_stiffness: bool) -> None:
        procedure.mechanics.evaluate(state, trial, increment, with_stiffness=with_stiffness)

    return least_seconds(lambda: evaluate(False)), least_seconds(lambda: evaluate(True))


def main(n: int) -> None:
    """Print microseconds per cell, and the share of assembly in an iteration."""
    print(f"load of the machine: {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores; packs of {_core.pack_width}")
    print_kernel()
    for element in (
        "shell4_mitc", "shell4_mitc_plus", "shell4_1pt", "shell4_reduced",
        "shell3_mitc", "shell3_mitc_plus", "shell6_mitc",
        "shell9_mitc",
    ):  # fmt: skip
        size = n if element[5] == "4" else n // 2
        model = sheet(size, element)
        procedure = ImplicitProcedure(model, threads=1)
        cells = sum(len(b.connectivity) for b in model.mesh.blocks)
        for threads in (1, 2):
            _core.set_threads(threads)
            force, both = evaluation_seconds(procedure)
            line = f"{element:15s} {cells:6d} cells, {threads} thread{'s' * (threads > 1)}: "
            line += f"force {1e6 * force / cells:6.2f}, force and tangent {1e6 * both / cells:6.2f} us per cell"
            if element == "shell4_mitc":
                line += share_of_assembly(procedure, both)
            print(line, flush=True)


def print_kernel() -> None:
    """Build and run the benchmark of the one-point shell alone."""
    printed = run_program("shell_kernel.cpp")
    print(printed or "no C++ compiler: the one-point shell alone is left out\n", end="", flush=True)


def share_of_assembly(procedure: ImplicitProcedure, evaluation: float) -> str:
    """What force, tangent and assembly take of an iteration."""
    mechanics, solver = procedure.mechanics, procedure.equilibrium.solver
    state = procedure.state
    constraints = procedure.interactions.supports.prescribe(state, 0, 1.0, np.zeros_like(state.nodes.displacement))
    data = np.zeros(len(mechanics.assembler.indices))
    gather = least_seconds(lambda: mechanics.assemble_stiffness(constraints.turned, constraints.frames, data))
    rhs = np.zeros(6 * len(constraints.mask))
    mask, value = constraints.mask.reshape(-1), constraints.value.reshape(-1)
    mechanics.assembler.constrain(mask, value, float(data.max()), data, rhs)

    def solve() -> None:
        solver.factorise(data)
        solver.solve(rhs)

    solution = least_seconds(solve)
    share = (evaluation + gather) / (evaluation + gather + solution)
    return f"; gather {1e3 * gather:.0f} ms, {solver.name} {1e3 * solution:.0f} ms: assembly is {100 * share:.0f} %"


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 100)
