# SPDX-License-Identifier: Apache-2.0
"""Upsetting to 60 % with every element that does not lock: forces, volume change, and their convergence as a picture.

The thesis's case (Cheng 1995, chapter 2, section 12-1) from the shipped example, on n x n blocks.
Run: python -m validation.upsetting [--picture docs/img/upsetting_convergence.png]
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from time import perf_counter

import numpy as np

from presswork.case import Case, build_model
from presswork.implicit.stepping import GaveUpError, ImplicitProcedure

REDUCTIONS = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
ELEMENTS = ("tri3", "tri6_6pt", "tri6_7pt", "quad4_fbar", "quad4_1pt", "quad8_2x2", "quad9_2x2")
REFINED = ("tri3", "quad4_fbar", "quad4_1pt")
EXAMPLE = files("presswork.examples") / "upsetting_4cst.toml"


@dataclass(frozen=True)
class Upsetting:
    """What one run gives."""

    element: str
    blocks: int
    reduction: np.ndarray
    """At every increment."""
    force: np.ndarray
    """On the whole punch [kN], at every increment."""
    volume_change: float
    """At the end [%]."""
    elastic_volume_change: float
    """Of it, what the hydrostatic stress explains [%]."""
    energy_error: float
    """External work less elastic energy less plastic work, over external work [%]."""
    seconds: float

    def forces(self) -> np.ndarray:
        """Force [kN] at REDUCTIONS, where increments end."""
        at = [int(np.argmin(np.abs(self.reduction - r))) for r in REDUCTIONS]
        assert np.allclose(self.reduction[at], REDUCTIONS, atol=1e-9)
        return self.force[at]


@cache
def upset(element: str, blocks: int) -> Upsetting:
    """Run the upsetting to 60 % on blocks x blocks; raises GaveUpError if it stops short."""
    started = perf_counter()
    changes = [
        f'workpiece.element="{element}"',
        f'workpiece.mesh.pattern="{"crossed" if element.startswith("tri") else "quad"}"',
        f"workpiece.mesh.cells=[{blocks},{blocks}]",
        "output.every=1000000",
        f"output.at={[float(r) for r in REDUCTIONS / 0.6]}",
    ]
    model = build_model(Case.from_toml(EXAMPLE, changes))
    procedure = ImplicitProcedure(model, threads=1)
    reduction, force = [0.0], [0.0]
    for report in procedure.advance():
        reduction.append(0.6 * report.fraction)
        force.append(procedure.state.nodes.reaction[model.mesh.node_sets["bottom"], 1].sum() / 1e3)
    state, material = procedure.state, model.materials[0]
    compliance = (1 - 2 * material.poisson) / material.young
    elastic = sum(
        float((s[..., :3].sum(axis=-1) * compliance * v).sum())
        for s, v in zip(state.cells.stress, state.cells.volume, strict=True)
    )
    return Upsetting(
        element,
        blocks,
        np.array(reduction),
        np.array(force),
        100 * (procedure.volume() / procedure.initial_volume - 1),
        100 * elastic / procedure.initial_volume,
        procedure.energy_balance()["error_percent"],
        perf_counter() - started,
    )


def draw(path: str, runs: list[Upsetting]) -> None:
    """Draw force against reduction, and each mesh's difference from the finest of 4CST."""
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.2))
    finest = max((r for r in runs if r.element == "tri3"), key=lambda r: r.blocks)
    for run in runs:
        label = f"{run.element.replace('tri3', '4CST')}, {run.blocks} x {run.blocks}"
        style = {15: ":", 30: "--", 60: "-"}[run.blocks]
        colour = f"C{ELEMENTS.index(run.element)}"
        left.plot(100 * run.reduction, run.force, style, lw=1.0, color=colour)
        difference = 100 * (run.forces() / finest.forces() - 1)
        right.plot(100 * REDUCTIONS, difference, style, lw=1.0, color=colour, marker="o", ms=3, label=label)
    left.set(xlabel="reduction [%]", ylabel="punch force [kN]", ylim=(0, None), xlim=(0, 60))
    right.set(xlabel="reduction [%]", ylabel=f"force over that of 4CST {finest.blocks} x {finest.blocks}, less 1 [%]")
    right.axhline(0, color="0.6", lw=0.8)
    right.legend(fontsize=6, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    figure.tight_layout()
    figure.savefig(path, dpi=130)


def main() -> None:
    """Print the tables; draw if asked to."""
    parser = argparse.ArgumentParser(description="Upsetting with every element that does not lock")
    parser.add_argument("--picture", help="PNG file to draw")
    parser.add_argument("--finest", type=int, default=60, help="blocks of the finest meshes: 15, 30 or 60")
    arguments = parser.parse_args()
    reductions = " ".join(f"{100 * r:6.0f} %" for r in REDUCTIONS)
    print(f"element      blocks {reductions}  volume  elastic energy [%]     s")
    runs = []
    for blocks in (15, 30, 60):
        for element in {15: ELEMENTS, 30: ELEMENTS, 60: REFINED}[blocks]:
            if blocks > arguments.finest:
                continue
            try:
                run = upset(element, blocks)
            except GaveUpError as error:
                print(f"{element:12s} {blocks:6d} {error}", flush=True)
                continue
            runs.append(run)
            forces = " ".join(f"{f:8.1f}" for f in run.forces())
            print(
                f"{element:12s} {blocks:6d} {forces} {run.volume_change:7.3f} {run.elastic_volume_change:8.3f} "
                f"{run.energy_error:10.3f} {run.seconds:5.0f}",
                flush=True,
            )
    if arguments.picture:
        draw(arguments.picture, runs)


if __name__ == "__main__":
    main()
