# SPDX-License-Identifier: Apache-2.0
"""Microseconds per cell and cycle of explicit solids, against element, law, size and threads.

An axisymmetric bar that flows everywhere; its top is driven down at a steady speed. Least of 60 runs
of 10 cycles, short enough for some to be left alone on a busy machine.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from presswork import _core
from presswork.explicit.solid_material import SolidMaterial
from presswork.explicit.solids import ExplicitSolids
from presswork.mesh.make.structured import mesh_rectangle
from presswork.model import Hardening, Heating, Rate

SWIFT = SolidMaterial(
    young=206.9e3, poisson=0.3, density=7.83e-9, hardening=Hardening("swift", np.array([565.0, 0.007, 0.26]))
)
JOHNSON_COOK = SolidMaterial(
    young=206.9e3,
    poisson=0.3,
    density=7.83e-9,
    hardening=Hardening("ludwik", np.array([806.0, 614.0, 0.168])),
    rate=Rate("johnson_cook", {"C": 0.0089, "reference_rate": 1.0}),
    heating=Heating(melting=1540.0, exponent=1.1, heat_capacity=4.6e8),
)


def cost(element: str, n: int, material: SolidMaterial, cycles: int = 10) -> tuple[float, float]:
    """Microseconds per cell and cycle, and the share of cells that have flowed."""
    mesh = mesh_rectangle(np.linspace(0, 10, n + 1), np.linspace(0, 10, n + 1), element=element)
    run = ExplicitSolids(mesh, [material], axisymmetric=True)
    run.fix("left", "u")
    # a homogeneous compression, so that every cell flows from the start
    run.velocity = np.column_stack([0.5e5 * mesh.points[:, 0] / 10, -1e5 * mesh.points[:, 1] / 10])
    run.fix("bottom", "v")
    run.fix("top", "v", -1e5)
    run.advance(round(0.02 * 10 / 1e5 / run.dt) if n <= 50 else 400)
    n_cells = len(run.equivalent_plastic_strain)
    least = np.inf
    for _ in range(60):
        start = time.perf_counter()
        run.advance(cycles)
        least = min(least, time.perf_counter() - start)
    return least / cycles / n_cells * 1e6, float((run.equivalent_plastic_strain > 0).mean())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sizes", type=int, nargs="+", default=[50, 100, 200])
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    given = parser.parse_args()
    print("element      law            cells  threads  us/cell/cycle  flowing")
    for element in ("quad4_1pt", "tri3"):
        for name, material in (("swift", SWIFT), ("johnson_cook", JOHNSON_COOK)):
            for n in given.sizes:
                for threads in given.threads:
                    _core.set_threads(threads)
                    per_cell, flowing = cost(element, n, material)
                    cells = n * n * (4 if element == "tri3" else 1)
                    print(f"{element:12} {name:14} {cells:6} {threads:6} {per_cell:12.3f} {flowing:12.2f}", flush=True)


if __name__ == "__main__":
    main()
