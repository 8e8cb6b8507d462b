# SPDX-License-Identifier: Apache-2.0
"""Uniaxial tension and compression to +-100 % logarithmic strain (axisymmetric bar) against the closed form.

The axes of stretch do not turn, so the increments' ln U add up to the logarithmic strain e = ln(h/h0) for increments of
any size, and the return is along a direction that never changes. Hence exactly, for Cauchy stress s:
    e = s/E + sign(e) p,   |s| = flow(p),   radius R = R0 exp(-nu s/E - sign(e) p/2),   force pi R^2 s.
With U - 1 the strain that the law sees is the sum of the increments' (h_k/h_(k-1) - 1) instead.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline
from scipy.optimize import brentq

from presswork.model import Hardening, Material, PrescribedDisplacement, SolverSettings, Support
from tests.problems.plane_solids import ELEMENTS, block_mesh, distort, fit_rate, fixed_increments, make_model, run

YOUNG, POISSON = 200e3, 0.3
R0, H0 = 10.0, 15.0

LAWS = {
    "linear": ([700.0, 300.0], lambda p: 700 + 300 * p),
    "swift": ([565.32, 0.007117, 0.2589], lambda p: 565.32 * (0.007117 + p) ** 0.2589),
    "ludwik": ([250.0, 400.0, 0.5], lambda p: 250 + 400 * p**0.5),
    "voce": ([200.0, 500.0, 4.0], lambda p: 500 - 300 * np.exp(-4 * p)),
    "linear_voce": ([200.0, 400.0, 8.0, 90.0], lambda p: 200 + 90 * p + 200 * (1 - np.exp(-8 * p))),
    "hockett_sherby": ([200.0, 500.0, 3.0, 0.8], lambda p: 500 - 300 * np.exp(-3 * p**0.8)),
    "swift_voce": (
        [0.4, 565.32, 0.007117, 0.2589, 200.0, 500.0, 4.0],
        lambda p: 0.6 * 565.32 * (0.007117 + p) ** 0.2589 + 0.4 * (500 - 300 * np.exp(-4 * p)),
    ),
    "monotone_table": (
        [0.0, 300.0, 1600.0, 0.1, 420.0, 400.0, 1.5, 560.0, 50.0],
        CubicHermiteSpline([0.0, 0.1, 1.5], [300.0, 420.0, 560.0], [1600.0, 400.0, 50.0]),
    ),
    "table": (
        [0.0, 300.0, 0.1, 420.0, 0.4, 500.0, 1.5, 560.0],
        lambda p: np.interp(p, [0.0, 0.1, 0.4, 1.5], [300.0, 420.0, 500.0, 560.0]),
    ),
}


def pull(law, log_strain, solver, mesh=None):
    """Stretch a quarter bar to h0 exp(log_strain); return the procedure."""
    mesh = mesh or block_mesh("quad4", (1, 1), origin=(0.0, 0.0), size=(R0, H0))
    material = Material(law, YOUNG, POISSON, Hardening(law, np.array(LAWS[law][0])))
    supports = (Support("left", (True, False)), Support("bottom", (False, True)))
    motion = PrescribedDisplacement("top", 1, H0 * np.expm1(log_strain))
    model = make_model(mesh, material, analysis="axisymmetric", supports=supports, prescribed=[motion], solver=solver)
    return run(model)


def exact(law, strain):
    """Stress, equivalent plastic strain and radius of the closed form."""
    flow, sign = LAWS[law][1], np.sign(strain)
    p = brentq(lambda p: abs(strain) - flow(p) / YOUNG - p, 0.0, abs(strain), xtol=1e-16, rtol=1e-15)
    stress = sign * flow(p)
    return stress, p, R0 * np.exp(-POISSON * stress / YOUNG - 0.5 * sign * p)


def assert_exact(procedure, law, strain, rtol=1e-6):
    stress, p, radius = exact(law, strain)
    state, mesh = procedure.state, procedure.model.mesh
    assert np.allclose(state.cells.stress[0], np.array([0.0, stress, 0.0, 0.0]), rtol=0, atol=rtol * abs(stress))
    assert np.allclose(state.cells.eqps[0], p, rtol=rtol)
    right, top = mesh.node_sets["right"], mesh.node_sets["top"]
    assert np.allclose(mesh.points[right, 0] + state.nodes.displacement[right, 0], radius, rtol=rtol)
    assert state.nodes.reaction[top, 1].sum() == pytest.approx(np.pi * radius**2 * stress, rel=rtol)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("strain", [1.0, -1.0])
def test_ten_increments_to_100_percent_meet_the_closed_form_for_every_hardening_law(law, strain):
    procedure, reports = pull(law, strain, fixed_increments(10))
    assert len(reports) == 10
    assert_exact(procedure, law, strain)


@pytest.mark.parametrize("strain", [1.0, -1.0])
def test_thousand_increments_are_no_more_accurate_than_ten(strain):
    procedure, _ = pull("swift", strain, fixed_increments(1000))
    assert_exact(procedure, "swift", strain)


@pytest.mark.parametrize("strain", [1.0, -1.0])
@pytest.mark.parametrize("element", ELEMENTS)
def test_every_element_meets_the_closed_form_with_automatic_increments(element, strain):
    """A mesh of 2 x 3 cells, with its inner nodes moved but for the element that needs rectangles.

    Beyond the largest force the homogeneous bar is unstable (Considere, here at 25 %): rounding grows, hence 1e-5.
    """
    mesh = block_mesh(element, (2, 3), origin=(0.0, 0.0), size=(R0, H0))
    if element != "quad4_1pt":
        mesh = distort(mesh, 0.8)
    solver = SolverSettings(max_increment=0.05, force_tolerance=1e-9, displacement_tolerance=1e-8)
    procedure, _ = pull("swift", strain, solver, mesh)
    assert_exact(procedure, "swift", strain, rtol=1e-5)


def seen_by_stretch(strain, n):
    """Sum of h_k/h_(k-1) - 1 over n equal steps of displacement."""
    h = 1 + np.expm1(strain) * np.arange(n + 1) / n
    return (h[1:] / h[:-1] - 1).sum()


@pytest.mark.parametrize("strain", [1.0, -1.0])
def test_stretch_measure_sees_the_sum_of_engineering_increments(strain):
    """Its error is that of the measure and nothing else."""
    procedure, _ = pull("linear", strain, fixed_increments(10, strain_measure="stretch"))
    stress, p, _ = exact("linear", seen_by_stretch(strain, 10))
    np.testing.assert_allclose(procedure.state.cells.stress[0][..., 1], stress, rtol=1e-6)
    np.testing.assert_allclose(procedure.state.cells.eqps[0], p, rtol=1e-6)


@pytest.mark.parametrize("strain", [1.0, -1.0])
def test_stretch_measure_converges_with_first_order_only(strain):
    counts = [20, 40, 80, 160]
    errors = []
    for n in counts:
        procedure, _ = pull("linear", strain, fixed_increments(n, strain_measure="stretch"))
        errors.append(procedure.state.cells.eqps[0][0, 0] - exact("linear", strain)[1])
    assert fit_rate([1 / n for n in counts], errors).rate == pytest.approx(1.0, abs=0.05)
