# SPDX-License-Identifier: Apache-2.0
"""Meshes, materials and runs that the tests of explicit solids share."""

import numpy as np

from presswork.explicit.solid_material import SolidMaterial
from presswork.explicit.solids import ExplicitSolids
from presswork.mesh.make.structured import mesh_rectangle
from presswork.model import Hardening, Heating, Mesh, Rate

YOUNG, POISSON, DENSITY = 210e3, 0.3, 7.85e-9
FLOOR = ((-1.0, 0.0, 1e3, 0.0, 0.0, 0.0, 0.0),)
"""A wall along y = 0 below the solid."""


def elastic(poisson: float = POISSON) -> SolidMaterial:
    return SolidMaterial(young=YOUNG, poisson=poisson, density=DENSITY)


def rectangle(element: str, nx: int, ny: int, width: float, height: float, *, x0: float = 0.0, distort: float = 0.0):
    """Mesh of nx x ny quads (or as many crossed ones), inner nodes moved at random by `distort` of a cell."""
    mesh = mesh_rectangle(np.linspace(x0, x0 + width, nx + 1), np.linspace(0.0, height, ny + 1), element=element)
    if distort == 0.0:
        return mesh
    inner = np.setdiff1d(np.arange(len(mesh.points)), np.unique(mesh.boundary_edges))
    points = mesh.points.copy()
    move = np.random.default_rng(3).uniform(-1, 1, (len(inner), 2)) * [width / nx, height / ny]
    points[inner] += 0.5 * distort * move if element == "tri3" else distort * move
    return Mesh(points, mesh.blocks, mesh.node_sets, mesh.edge_sets, mesh.boundary_edges)


def taylor_bar(
    element: str, n_radial: int, n_axial: int, *, tied: bool = True, fraction: float = 0.05
) -> ExplicitSolids:
    """Taylor bar of 42CrMo4 after Pantale (2020), 6.4 x 32.4 mm at 287 m/s; the foot is tied axially, or on a wall."""
    material = SolidMaterial(
        young=206.9e3,
        poisson=0.3,
        density=7.83e-9,
        hardening=Hardening("ludwik", np.array([806.0, 614.0, 0.168])),
        rate=Rate("johnson_cook", {"C": 0.0089, "reference_rate": 1.0}),
        heating=Heating(melting=1540.0, exponent=1.1, heat_capacity=4.6e8, plastic_fraction=0.9),
    )
    mesh = rectangle(element, n_radial, n_axial, 3.2, 32.4)
    run = ExplicitSolids(mesh, [material], axisymmetric=True, hourglass_fraction=fraction)
    run.fix("left", "u")
    run.set_velocity("all", (0.0, -287e3))
    if tied:
        run.fix("bottom", "v")
    else:
        run.add_wall("anvil", FLOOR)
    return run


def measure_taylor_bar(run: ExplicitSolids) -> dict[str, float]:
    """Length, foot diameter [mm]; plastic strain and temperature of the cell at the foot's centre."""
    x, cells = run.position, run.mesh.blocks[0].connectivity
    centre = np.argmin((run.mesh.points[cells].mean(axis=1) ** 2).sum(axis=1))
    return {
        "length": float(np.ptp(x[:, 1])),
        "diameter": 2.0 * float(x[run.mesh.node_sets["bottom_right"][0], 0]),
        "strain": float(run.equivalent_plastic_strain[centre]),
        "temperature": float(run.temperature[centre]),
    }
