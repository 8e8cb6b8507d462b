# SPDX-License-Identifier: Apache-2.0
"""What the Kirchhoff penalty K_p in the tangent does to the iteration, element by element.

Run: python -m benchmarks.kirchhoff_penalty [picture.png], a quarter of an hour on two cores

Two problems: a cantilever of slenderness 100 bent elastically by an end force to two thirds of its length, and a
clamped plate of slenderness 100 pressed far into plasticity. For each C_p: iterations over ten equal increments, and
the largest part of the load that one increment from rest can take. The answers are the same for every C_p.
"""

from __future__ import annotations

import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from typing import get_args

import numpy as np

from presswork.implicit.stepping import GaveUpError, ImplicitProcedure
from presswork.model import ElementName, Material, Model, ShellElement
from tests.problems.plane_solids import elastic, linear_hardening
from tests.problems.shells import CLAMPED, X, Y, patch, shell_model, symmetry

ELEMENTS: tuple[ElementName, ...] = get_args(ShellElement)
PENALTIES = (0.0, 0.01, 0.1, 1.0, 10.0, 100.0)
PARTS = (1.0, 0.7, 0.5, 0.35, 0.25, 0.18, 0.125, 0.09, 0.0625, 0.03, 0.015)


def cantilever(element: ElementName) -> Model:
    n = 8 if element[5] in "689" else 16
    mesh = patch(lambda u, v: np.column_stack([u, v, 0 * u]), np.linspace(0, 10, n + 1), np.array([0.0, 1.0]),
                 element=element, thickness=0.1)  # fmt: skip
    return shell_model(mesh, elastic(1.2e6, 0.0), [("left", CLAMPED)], edges=[("right", (0, 0, 4.0))])


def plate(element: ElementName) -> Model:
    n = 4 if element[5] in "689" else 8
    lines = np.linspace(0, 50, n + 1)
    mesh = patch(lambda u, v: np.column_stack([u, v, 0 * u]), lines, lines, element=element, thickness=1.0, points=5)
    steel = Material("steel", 2e5, 0.3, linear_hardening(200.0, 500.0))
    held = [("left", symmetry(X)), ("bottom", symmetry(Y)), ("right", CLAMPED), ("top", CLAMPED)]
    return shell_model(mesh, steel, held, pressures=[("all", 2.0)])


def count(model: Model, penalty: float) -> int | None:
    """Iterations of ten increments; None if it gives up, counting the cut-backs' too."""
    settings = replace(model.solver, initial_increment=0.1, max_increment=0.1, kirchhoff_penalty=penalty,
                       max_iterations=60, min_increment=0.005)  # fmt: skip
    procedure = ImplicitProcedure(replace(model, solver=settings), threads=1)
    try:
        reports = list(procedure.advance())
    except GaveUpError:
        return None
    return sum(len(r.log) for r in reports) if not any(r.cutbacks for r in reports) else None


def largest_step(model: Model, penalty: float) -> float:
    """Largest part of the load that one increment from rest can take."""
    for part in PARTS:
        settings = replace(model.solver, initial_increment=part, max_increment=part, min_increment=part,
                           kirchhoff_penalty=penalty, max_iterations=60)  # fmt: skip
        procedure = ImplicitProcedure(replace(model, solver=settings), threads=1)
        try:
            next(procedure.advance())
            return part
        except GaveUpError:
            continue
    return 0.0


def study(task: tuple[str, ElementName, float]) -> tuple[int | None, float]:
    """Return the iterations of ten increments and the largest step of one problem, element and C_p."""
    name, element, penalty = task
    model = PROBLEMS[name](element)
    return count(model, penalty), largest_step(model, penalty)


PROBLEMS = {"cantilever": cantilever, "plastic plate": plate}


def main(picture: str | None) -> None:
    """Print both tables, and draw them."""
    tables = {}
    with ProcessPoolExecutor() as pool:
        for name in PROBLEMS:
            print(f"{name:16s}" + "".join(f"C_p = {p:<10g}" for p in PENALTIES) + "  (iterations / largest step)")
            rows = pool.map(study, [(name, element, p) for element in ELEMENTS for p in PENALTIES])
            for element in ELEMENTS:
                row = [next(rows) for _ in PENALTIES]
                tables[name, element] = row
                cells = "".join(f"{'-' if i is None else i:>5} / {s:<8g}" for i, s in row)
                print(f"{element:16s}{cells}", flush=True)
    if picture:
        draw(tables, picture)


def draw(tables: dict[tuple[str, str], list[tuple[int | None, float]]], path: str) -> None:
    """Iterations and largest step against C_p."""
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(2, 2, figsize=(10, 6.5), sharex=True, layout="constrained")
    x = [p or 0.001 for p in PENALTIES]
    styles = ("o-", "s--", "^:")
    for column, name in enumerate(("cantilever", "plastic plate")):
        for number, element in enumerate(ELEMENTS):
            row, style = tables[name, element], styles[number // 10 % 3]
            axes[0, column].plot(x, [np.nan if i is None else i for i, _ in row], style, ms=3, label=element)
            axes[1, column].plot(x, [s for _, s in row], style, ms=3)
        axes[0, column].set(title=name, xscale="log", yscale="log", ylabel="iterations, ten increments")
        axes[1, column].set(xlabel="C_p (0 drawn at 0.001)", ylabel="largest step, part of the load")
    axes[0, 0].legend(fontsize="xx-small", ncols=2)
    figure.savefig(path, dpi=130)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else None)
