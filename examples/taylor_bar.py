# SPDX-License-Identifier: Apache-2.0
"""Taylor bar: a steel cylinder, 6.4 x 32.4 mm, strikes a rigid wall at 287 m/s; ends in a picture.

Run: python examples/taylor_bar.py [taylor_bar.png]. Johnson-Cook steel 42CrMo4 after Pantale (2020).
"""

from __future__ import annotations

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

from presswork.mesh.structured import mesh_rectangle
from presswork.model import Hardening, Heating, Rate
from presswork.procedure.explicit_solids import ExplicitSolids
from presswork.procedure.solid_material import SolidMaterial

STEEL = SolidMaterial(
    young=206.9e3,
    poisson=0.3,
    density=7.83e-9,
    hardening=Hardening("ludwik", np.array([806.0, 614.0, 0.168])),
    rate=Rate("johnson_cook", (0.0089, 1.0)),
    heating=Heating(melting=1540.0, exponent=1.1, heat_capacity=4.6e8),
)
WALL = [[-1.0, 0.0, 20.0, 0.0, 0.0, 0.0, 0.0]]


def main() -> None:
    """Run the impact, print the shape, draw four moments."""
    target = sys.argv[1] if len(sys.argv) > 1 else "taylor_bar.png"
    mesh = mesh_rectangle(np.linspace(0, 3.2, 11), np.linspace(0, 32.4, 101), element="quad4_1pt")
    run = ExplicitSolids(mesh, [STEEL], axisymmetric=True)
    run.fix("left", "u")
    run.set_velocity("all", (0.0, -287e3))
    run.add_wall("anvil", WALL)
    cells = mesh.blocks[0].connectivity
    figure, axes = plt.subplots(1, 4, figsize=(9, 5), sharey=True, layout="constrained")
    for axis, end in zip(axes, (5e-6, 15e-6, 30e-6, 80e-6), strict=True):
        run.run_to(end)
        x = run.position
        # the strain on the right, the temperature on the left of the axis
        for sign, values, top, colours in (
            (1.0, run.equivalent_plastic_strain, 2.0, "viridis"),
            (-1.0, run.temperature, 650.0, "inferno"),
        ):
            shape = PolyCollection(
                (x * [sign, 1.0])[cells], array=values, cmap=colours, linewidth=0.4, edgecolor="face"
            )
            shape.set_clim(0.0 if sign > 0 else 20.0, top)
            axis.add_collection(shape)
            if end == 80e-6:
                name = "equivalent plastic strain" if sign > 0 else "temperature [C]"
                figure.colorbar(shape, ax=axes, location="right" if sign > 0 else "left", label=name, shrink=0.6)
        axis.axhline(0.0, color="black")
        axis.set(title=f"{end * 1e6:g} us", xlim=(-6.5, 6.5), ylim=(-0.5, 33.0), aspect="equal", xlabel="r [mm]")
    figure.savefig(target, dpi=110, bbox_inches="tight")
    balance = run.energies()
    print(f"length {np.ptp(x[:, 1]):.2f} mm, foot {2 * x[mesh.node_sets['bottom'], 0].max():.2f} mm")
    print(f"strain {run.equivalent_plastic_strain.max():.2f}, temperature {run.temperature.max():.0f} C")
    print(f"cycles {run.cycle}, energy error {balance.error_percent:.4f} %")
    print(f"wrote {target}")


if __name__ == "__main__":
    main()
