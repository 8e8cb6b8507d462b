# SPDX-License-Identifier: Apache-2.0
"""Thick cylinder (plane strain) and sphere (axisymmetric) under internal pressure, a = 100, b = 200 mm.

Elastic: Lame. Perfectly plastic with the front at c (tests/data/thick_cylinder_sphere.csv):
  sphere    p = 2 s0 [ln(c/a) + (1 - c^3/b^3)/3], exact for von Mises and any nu;
  cylinder  p = Y [ln(c/a) + (1 - c^2/b^2)/2], Y = 2 s0/sqrt(3) (Hill 1950). Hill's answer is Tresca's; von Mises gives
            the same as nu -> 1/2, where sigma_zz lies midway: nu = 0.499 is used for rates, nu = 0.3 for the table.
The yield stress is 2.4 MPa for E = 210 GPa, a hundredth of the table's, so that what is of second order in the strains,
which the closed forms leave out, is of order 1e-5 of the answer; the table is scaled by the same factor.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from presswork.mesh import mesh_rectangle
from presswork.model import Material, PrescribedDisplacement, Pressure, SolverSettings, Support
from tests.problems.plane_solids import DATA, fit_rate, linear_hardening, make_model, map_points, run

A, B, YOUNG, SCALE = 100.0, 200.0, 210e3, 1e-2
YIELD = 240.0 * SCALE  # [MPa]
ELEMENTS = ("tri3", "tri6_7pt", "quad4_fbar", "quad8_2x2")  # tri3 crossed: 4CST
TABLE = {
    shape: np.array([row[1:] for row in rows], dtype=float)
    for shape, rows in {
        name: [
            r.split(",") for r in (DATA / "thick_cylinder_sphere.csv").read_text().splitlines() if r.startswith(name)
        ]
        for name in ("cylinder", "sphere")
    }.items()
}  # c, p, u_outer, u_inner in mm and kN/mm2


def quarter_ring(element, n):
    """n x n cells between the radii a and b over 90 degrees; mid-side nodes on the arcs."""
    pattern = "crossed" if element.startswith("tri") else "quad"
    flat = mesh_rectangle(
        np.linspace(A, B, n + 1), np.linspace(0.0, 0.5 * np.pi, n + 1), element=element, pattern=pattern
    )
    r, angle = flat.points.T
    points = np.column_stack([r * np.cos(angle), r * np.sin(angle)])
    points[flat.node_sets["top"], 0] = 0.0
    return map_points(flat, points)


@cache
def expand(shape, element, n, pressure, poisson):
    """Return the mean radial displacement [mm] of the outer and of the inner surface."""
    mesh = quarter_ring(element, n)
    solver = SolverSettings(
        initial_increment=0.25, max_increment=0.25, force_tolerance=1e-6, displacement_tolerance=1e-6, symmetric=False
    )
    model = make_model(
        mesh,
        Material("perfectly plastic", YOUNG, poisson, linear_hardening(YIELD)),
        analysis="plane_strain" if shape == "cylinder" else "axisymmetric",
        supports=(Support("bottom", (False, True)), Support("top", (True, False))),
        pressures=(Pressure("left", pressure),),
        solver=solver,
    )
    state = run(model)[0].state
    radial = np.einsum("ni,ni->n", state.nodes.displacement, mesh.points) / np.linalg.norm(mesh.points, axis=1)
    return radial[mesh.node_sets["right"]].mean(), radial[mesh.node_sets["left"]].mean()


def lame(shape, pressure, poisson):
    """Elastic displacement of the outer and of the inner surface."""
    if shape == "cylinder":
        f = pressure * A**2 / (B**2 - A**2) * (1 + poisson) / YOUNG
        return tuple(f * ((1 - 2 * poisson) * r + B**2 / r) for r in (B, A))
    f = pressure * A**3 / (B**3 - A**3) / YOUNG
    return tuple(f * ((1 - 2 * poisson) * r + (1 + poisson) * B**3 / (2 * r**2)) for r in (B, A))


def hill(shape, c, poisson):
    """Pressure and displacements of the outer and of the inner surface with the plastic front at c."""
    if shape == "cylinder":
        y = 2 * YIELD / np.sqrt(3)
        pressure = y * (np.log(c / A) + 0.5 * (1 - (c / B) ** 2))
        outer = y * c**2 / (YOUNG * B) * (1 - poisson**2)
        inner = (1 - poisson**2) * y * c**2 / (YOUNG * A) - (1 + poisson) * (1 - 2 * poisson) * pressure * A / YOUNG
        return pressure, outer, inner
    pressure = 2 * YIELD * (np.log(c / A) + (1 - (c / B) ** 3) / 3)
    outer = YIELD * c**3 * (1 - poisson) / (YOUNG * B**2)
    inner = (1 - poisson) * YIELD * c**3 / (YOUNG * A**2) - (1 - 2 * poisson) * pressure * A / YOUNG
    return pressure, outer, inner


@pytest.mark.parametrize("shape", ["cylinder", "sphere"])
def test_closed_forms_are_those_of_the_table(shape):
    for c, *row in TABLE[shape]:
        pressure, outer, inner = hill(shape, c, 0.3)
        np.testing.assert_allclose([pressure / 1e3, outer, inner], SCALE * np.array(row), rtol=1e-10)


@pytest.mark.parametrize("shape", ["cylinder", "sphere"])
@pytest.mark.parametrize(("element", "order"), [("tri3", 2), ("quad4_fbar", 2), ("tri6_7pt", 3), ("quad8_2x2", 3)])
def test_elastic_displacement_converges_with_the_elements_order(shape, element, order):
    """One more than the degree of the shape functions, as for the error in the mean square."""
    pressure, poisson = 50.0 * SCALE, 0.3
    sizes = [2, 4, 8] if order == 3 else [4, 8, 16]
    exact = np.array(lame(shape, pressure, poisson))
    errors = [np.abs(np.array(expand(shape, element, n, pressure, poisson)) / exact - 1).max() for n in sizes]
    assert fit_rate([1 / n for n in sizes], errors).rate > order - 0.3
    assert errors[-1] < (5e-3 if order == 2 else 1e-4)


@pytest.mark.parametrize("shape", ["cylinder", "sphere"])
@pytest.mark.parametrize("element", ELEMENTS)
def test_elastic_plastic_displacement_converges_to_the_closed_form(shape, element):
    """Front at 1.5 a, across which the stress has a kink: at best second order, whatever the element."""
    poisson = 0.499 if shape == "cylinder" else 0.3
    pressure, *exact = hill(shape, 150.0, poisson)
    sizes = [5, 10, 20] if element in ("tri3", "quad4_fbar") else [3, 6, 12]
    errors = [np.abs(np.array(expand(shape, element, n, pressure, poisson)) / exact - 1).max() for n in sizes]
    assert fit_rate([1 / n for n in sizes], errors).rate > 1.5
    assert errors[-1] < 1e-2


@pytest.mark.parametrize("front", [120.0, 150.0, 180.0])
def test_sphere_meets_the_table_at_every_front(front):
    row = TABLE["sphere"][TABLE["sphere"][:, 0] == front][0]
    actual = expand("sphere", "quad8_2x2", 10, 1e3 * SCALE * row[1], 0.3)
    np.testing.assert_allclose(actual, SCALE * row[2:], rtol=5e-3)


@pytest.mark.parametrize("front", [120.0, 150.0, 180.0])
def test_cylinder_of_von_mises_metal_is_near_the_tresca_table(front):
    """nu = 0.3: between the two laws lies what sigma_zz does near the front, 1 to 2 % in displacement."""
    row = TABLE["cylinder"][TABLE["cylinder"][:, 0] == front][0]
    actual = expand("cylinder", "quad8_2x2", 10, 1e3 * SCALE * row[1], 0.3)
    np.testing.assert_allclose(actual, SCALE * row[2:], rtol=3e-2)


@pytest.mark.parametrize(
    "element", ["tri3", "tri6_6pt", "tri6_7pt", "quad4_fbar", "quad4_1pt", "quad8_2x2", "quad9_2x2"]
)
def test_large_expansion_meets_the_rigid_plastic_cylinder(element):
    """Bore 10 to 20 mm, outside 20 mm: p = (s0/sqrt(3)) ln{[(b0/a0)^2 + g]/(1 + g)}, g = (a/a0)^2 - 1; E = 1e5 s0."""
    a0, b0, a, yield_stress = 10.0, 20.0, 20.0, 1.0
    n, height = 12, 1.0
    lines = a0 * (b0 / a0) ** (np.arange(n + 1) / n)
    pattern = "crossed" if element.startswith("tri") else "quad"
    mesh = mesh_rectangle(lines, np.array([0.0, height]), element=element, pattern=pattern)
    solver = SolverSettings(initial_increment=0.01, max_increment=0.02, symmetric=False, force_tolerance=1e-6)
    model = make_model(
        mesh,
        Material("rigid-plastic", 1e5 * yield_stress, 0.49, linear_hardening(yield_stress)),
        analysis="axisymmetric",
        supports=(Support("bottom", (False, True)), Support("top", (False, True))),
        prescribed=(PrescribedDisplacement("left", 0, a - a0),),
        solver=solver,
    )
    state = run(model)[0].state
    pressure = state.nodes.reaction[mesh.node_sets["left"], 0].sum() / (2 * np.pi * a * height)
    growth = (a / a0) ** 2 - 1
    exact = yield_stress / np.sqrt(3) * np.log(((b0 / a0) ** 2 + growth) / (1 + growth))
    assert pressure == pytest.approx(exact, rel=5e-3)
