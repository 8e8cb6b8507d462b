# SPDX-License-Identifier: Apache-2.0
"""Necking of a bar (Simo 1988) by every element that does not lock: radius of the neck, force and cost.

    python -m validation.neck_of_a_bar [ELEMENT ...]

Bar of radius 6.413 mm, 53.334 mm long, 1.8 % thinner in its middle, pulled by 14 mm. sigma_y = 715 - 265 exp(-16.93 p)
+ 129.24 p MPa, E = 206.9 GPa, nu = 0.29. A quarter is computed, on 5 x 10 cells and finer ones.
"""

from __future__ import annotations

import sys
import time
from dataclasses import replace

import numpy as np

from presswork import Case
from presswork.case import build_model
from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import Model

RADIUS, HALF, PULL, THINNER = 6.413, 26.667, 7.0, 0.018
ELEMENTS = ("tri3", "tri6_6pt", "tri6_7pt", "quad4_fbar", "quad4_1pt", "quad8_2x2", "quad9_2x2")


def flow_stress(p: np.ndarray) -> np.ndarray:
    """[MPa] after Simo (1988)."""
    return 715.0 - 265.0 * np.exp(-16.93 * p) + 129.24 * p


def build(element: str, finer: int) -> Model:
    """Return the quarter bar; finer: how many times as many cells each way as 5 x 10."""
    p = np.concatenate([np.linspace(0, 0.4, 60), np.linspace(0.45, 5, 60)])
    case = Case.model_validate(
        {
            "title": "neck of a bar",
            "analysis": "axisymmetric",
            "workpiece": {
                "material": "steel",
                "element": element,
                "mesh": {"zones_x": [[RADIUS, 5 * finer]], "zones_y": [[7.0, 6 * finer], [HALF - 7.0, 4 * finer, 4.0]]},
            },
            "materials": {
                "steel": {
                    "young": 206.9e3,
                    "poisson": 0.29,
                    "hardening": {"law": "table", "points": np.column_stack([p, flow_stress(p)]).tolist()},
                }
            },
            "boundary": {
                "axis": {"set": "left", "fix": ["x"]},
                "middle": {"set": "bottom", "fix": ["y"]},
            },
            "stages": [{"name": "pull", "displacement": [{"set": "top", "component": "y", "value": PULL}]}],
            "solver": {"initial_increment": 0.01, "max_increment": 0.02},
            "output": {"steps": 1},
        }
    )
    model = build_model(case)
    points = model.mesh.points.copy()
    taper = 1.0 - THINNER * (1.0 - points[:, 1] / HALF)
    points[:, 0] *= taper
    return replace(model, mesh=replace(model.mesh, points=points))


def pull(element: str, finer: int) -> None:
    """Pull the bar and print a row of the table."""
    model = build(element, finer)
    corner = model.mesh.node_sets["bottom_right"]
    started, largest, row = time.process_time(), 0.0, []
    procedure = ImplicitProcedure(model, threads=1)
    iterations, wanted = 0, [5.0, 6.0, 7.0]
    for report in procedure.advance():
        iterations += len(report.log)
        force = float(procedure.state.nodes.reaction[model.mesh.node_sets["top"], 1].sum())
        largest = max(largest, abs(force))
        if wanted and report.fraction * PULL >= wanted[0] - 1e-9:
            wanted.pop(0)
            radius = points_now(procedure)[corner, 0].item()
            row.append(f"{radius / RADIUS:.3f}, {abs(force) / 1e3:.1f}")
    seconds = time.process_time() - started
    columns = [element, len(model.mesh.points), f"{largest / 1e3:.1f}", *row, iterations, f"{seconds:.1f}"]
    print(f"| {' | '.join(str(c) for c in columns)} |", flush=True)


def points_now(procedure: ImplicitProcedure) -> np.ndarray:
    """Return where the nodes are (n_points, 2) [mm]."""
    return np.asarray(procedure.model.mesh.points + procedure.state.nodes.displacement)


def main() -> None:
    """Print the table."""
    for element in sys.argv[1:] or ELEMENTS:
        for finer in (1, 2, 4) if element == "tri3" else (1, 2):
            try:
                pull(element, finer)
            except Exception as error:  # the table says who gives up
                print(f"| {element} x{finer} | {error}", flush=True)


if __name__ == "__main__":
    main()
