# SPDX-License-Identifier: Apache-2.0
"""Microseconds per cell and cycle of explicit hexahedra on one core, against element and law.

A block that flows everywhere; its top is driven down at a steady speed. Least of 40 runs of 10 cycles, short enough for
some to be left alone on a busy machine.
"""

from __future__ import annotations

import time

import numpy as np

from presswork import _core
from presswork.body.laws_of_solids import make_law
from presswork.explicit.device import Device
from presswork.explicit.space_material import SpaceMaterial
from presswork.explicit.space_solids import ExplicitSpaceSolids
from presswork.mesh.make.box import mesh_box
from presswork.model import Hardening, Material, SolverSettings

LAWS = {
    "linear": Hardening("linear", np.array([400.0, 500.0])),
    "swift": Hardening("swift", np.array([565.0, 0.007, 0.26])),
}


def upset_cube(n: int, element: str, hardening: Hardening, device: Device = "cpu") -> ExplicitSpaceSolids:
    """Return a cube of n cells along an edge, or of six tetrahedra in each, that flows uniformly at 1e4/s."""
    lines = np.linspace(0.0, 10.0, n + 1)
    mesh = mesh_box(lines, lines, lines, element=element)
    material = Material("steel", 206.9e3, 0.3, hardening)
    made = SpaceMaterial(make_law(material, SolverSettings(), 6), 7.83e-9)  # type: ignore[arg-type]
    run = ExplicitSpaceSolids(mesh, [made], device=device)
    run.velocity = mesh.points * [5e3, 5e3, -1e4]
    run.fix("back", "w")
    run.fix("front", "w", -1e5)
    return run


def cost(element: str, hardening: Hardening, n: int = 20) -> tuple[float, float]:
    """Return microseconds per cell and cycle, and the share of cells that have flowed."""
    run = upset_cube(n, element, hardening)
    run.advance(100)
    least = np.inf
    for _ in range(40):
        started = time.perf_counter()
        run.advance(10)
        least = min(least, time.perf_counter() - started)
    return least / 10 / n**3 * 1e6, float((run.equivalent_plastic_strain > 0).mean())


def main() -> None:
    _core.set_threads(1)
    print("element      law        us/cell/cycle  flowing")
    for element in ("hex8_1pt", "hex8_fbar"):
        for name, hardening in LAWS.items():
            per_cell, flowing = cost(element, hardening)
            print(f"{element:12} {name:10} {per_cell:12.3f} {flowing:9.2f}", flush=True)


if __name__ == "__main__":
    main()
