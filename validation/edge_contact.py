# SPDX-License-Identifier: Apache-2.0
"""A strip bent over die edges as sharp as its elements are long: how deep they sink in between nodes, punch force.

    python -m validation.edge_contact

Half a strip of 80 x 4 L mm, 0.8 mm steel, is drawn 12 mm deep between a punch of 30 mm (nose radius 6 mm) and a die of
34 mm, held by 100 N per mm of width. L is the side of its shells.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.case import StampingCase, build_model
from presswork.geometry.tool_surface import make_surface
from presswork.process.explicit.stamping import ExplicitStamping


@dataclass(frozen=True)
class Drawn:
    """What a draw came to."""

    sunk: float
    """Deepest that the die got into an edge of the sheet, half the thickness counted [mm]."""
    force: float
    """Mean punch force per width over the second half of the stroke [N/mm]."""
    energy_error: float
    """Largest [%]."""


def strip(radius: float, side: float, points: str) -> StampingCase:
    """Return the case: edge radius of die and holder [mm], side of the shells [mm], "nodes" or "edges"."""
    straight = {"shape": "strip", "mu": 0.1}
    return StampingCase.model_validate({
        "title": "strip over a sharp edge",
        "analysis": "stamping",
        "blank": {"shape": "rectangle", "size": [80, 4 * side], "thickness": 0.8, "element_size": side,
                  "material": "steel", "symmetry": ["x"]},
        "materials": {"steel": {"young": "206 GPa", "poisson": 0.3,
                                "hardening": {"law": "swift", "K": 565.32, "e0": 0.007117, "n": 0.2589}}},
        "tools": {"punch": {**straight, "kind": "punch", "width": 30, "edge_radius": 6},
                  "die": {**straight, "kind": "die", "width": 34, "edge_radius": radius},
                  "holder": {**straight, "kind": "holder", "width": 36, "edge_radius": radius}},
        "stages": [{"name": "draw", "velocity": "2 m/s",
                    "tools": {"punch": {"stroke": 12}, "holder": {"force": 400 * side}}}],
        "explicit": {"contact_points": points},
        "output": {"rows": 60, "steps": 1},
    })  # fmt: skip


def draw(radius: float, side: float, points: str) -> Drawn:
    """Draw the strip."""
    model = build_model(strip(radius, side, points))
    process = ExplicitStamping(model, threads=1)
    die = model.tools[1]
    cells = model.mesh.blocks[0].connectivity
    edges = np.unique(np.sort(cells[:, [[i, (i + 1) % 4] for i in range(4)]].reshape(-1, 2), axis=1), axis=0)
    at = np.linspace(0.0, 1.0, 21)
    weights = np.stack([1.0 - at, at])
    sunk, force, error = 0.0, [], 0.0
    for report in process.advance():
        half = np.bincount(cells.ravel(), 0.5 * process.shells.thickness.repeat(4)) / np.bincount(cells.ravel())
        places = np.einsum("eik,ip->epk", process.shells.position[edges], weights).reshape(-1, 3)
        gap = make_surface(die.shape).nearest(places - np.asarray(die.position))[0]
        sunk = max(sunk, float(((half[edges] @ weights).ravel() - gap).max()))
        force.append(float(process.tools.row()["punch.force"]) / (4 * side))
        error = max(error, abs(report.energies.error_percent))
    return Drawn(sunk, float(np.mean(force[len(force) // 2 :])), error)


if __name__ == "__main__":
    print("L [mm]  radius  sunk in, nodes  edges  force [N/mm], nodes  edges  energy error, nodes  edges [%]")
    for side, radii in ((2.0, (0.5, 1.0, 2.0, 4.0)), (1.0, (0.5, 1.0, 2.0)), (0.5, (0.5, 1.0, 2.0))):
        for r in radii:
            n, e = (draw(r, side, points) for points in ("nodes", "edges"))
            print(
                f"{side:6} {r:7} {n.sunk:15.3f} {e.sunk:6.3f} {n.force:20.1f} {e.force:6.1f} "
                f"{n.energy_error:20.2f} {e.energy_error:6.2f}",
                flush=True,
            )
