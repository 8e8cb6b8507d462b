# SPDX-License-Identifier: Apache-2.0
"""The six integrators against the exact von Mises perfectly plastic answer (Krieg & Krieg 1977).

A stress on the yield surface at angle psi0 to a constant strain rate, both deviatoric. Over an increment of size
q = 2G |de| / R, R the yield radius, the exact angle follows tan(psi/2) = tan(psi0/2) exp(-q).
Table: tests/data/krieg_exact.csv.
"""

from __future__ import annotations

import numpy as np
import pytest

from presswork import _core
from tests.problems.plane_solids import DATA, fit_rate

YOUNG, POISSON, YIELD = 200e3, 0.3, 700.0
G = YOUNG / (2 * (1 + POISSON))
RADIUS = np.sqrt(2.0 / 3.0) * YIELD
TABLE = np.loadtxt(DATA / "krieg_exact.csv", delimiter=",", skiprows=2)
INTEGRATORS = ("backward_euler", "radial_return", "direct", "tangent_radial_return", "secant", "substepping")


def angle_after(integrator, psi0, q, substeps=10, length=1.0):
    """Angle [deg] between stress and strain rate after one increment, and the stress's length over the radius.

    length: of the stress before, over the radius.
    """
    law = _core.VonMises(
        YOUNG,
        POISSON,
        _core.HardeningLaw.linear,
        [YIELD, 0.0],
        integrator=_core.Integrator[integrator],
        substeps=substeps,
    )
    along = np.array([1.0, -1.0, 0.0, 0.0]) / np.sqrt(2.0)  # unit deviators in xx, yy, zz, xy (tensor component)
    across = np.array([0.0, 0.0, 0.0, 1.0]) / np.sqrt(2.0)
    psi0, q = np.radians(np.atleast_1d(psi0)), np.atleast_1d(np.asarray(q, dtype=float))
    stress = length * RADIUS * (np.cos(psi0)[:, None] * along + np.sin(psi0)[:, None] * across)
    strain = (q * RADIUS / (2 * G))[:, None] * along  # no shear: engineering equals tensor
    result, _, _ = law.update(strain, stress, np.zeros(len(q)))
    x, y = result @ along, 2 * (result @ across)
    return np.degrees(np.arctan2(y, x)), np.hypot(x, y) / RADIUS


def exact_angle(psi0, q):
    return 2 * np.degrees(np.arctan(np.tan(np.radians(psi0) / 2) * np.exp(-np.asarray(q))))


def test_closed_form_is_that_of_the_table():
    np.testing.assert_allclose(exact_angle(TABLE[:, 0], TABLE[:, 1]), TABLE[:, 2], atol=1e-6)


@pytest.mark.parametrize("integrator", ["backward_euler", "radial_return"])
def test_radial_returns_give_the_tabulated_radial_return(integrator):
    """Without hardening, Wilkins's and backward Euler's return are the same."""
    angle, length = angle_after(integrator, TABLE[:, 0], TABLE[:, 1])
    np.testing.assert_allclose(angle, TABLE[:, 3], atol=1e-6)
    np.testing.assert_allclose(length, 1.0, atol=1e-12)


def test_tangent_and_secant_give_their_closed_forms():
    """Marcal: project the strain on the tangent, return radially. Rice & Tracey: the chord from psi0 reflected.

    With t = q sin(psi0), the tangent result turns by atan(t). The secant normal is that of (S_t + S_c)/2, angle psi_m
    with tan psi_m = sin psi0 / (cos psi0 + q/2); the end lies on the surface at 2 psi_m - psi0.
    """
    psi0, q = TABLE[:, 0], TABLE[:, 1]
    sine, cosine = np.sin(np.radians(psi0)), np.cos(np.radians(psi0))
    angle, length = angle_after("tangent_radial_return", psi0, q)
    np.testing.assert_allclose(angle, psi0 - np.degrees(np.arctan(q * sine)), atol=1e-8)
    np.testing.assert_allclose(length, 1.0, atol=1e-12)
    angle, length = angle_after("secant", psi0, q)
    np.testing.assert_allclose(angle, 2 * np.degrees(np.arctan2(sine, cosine + q / 2)) - psi0, atol=1e-8)
    np.testing.assert_allclose(length, 1.0, atol=1e-12)


def test_direct_integrator_leaves_the_yield_surface_by_the_second_order_term():
    """Without a correction the stress runs out along the tangent to length sqrt(1 + (q sin psi0)^2)."""
    psi0, q = TABLE[:, 0], TABLE[:, 1]
    _, length = angle_after("direct", psi0, q)
    np.testing.assert_allclose(length, np.hypot(1.0, q * np.sin(np.radians(psi0))), rtol=1e-10)


@pytest.mark.parametrize("off", [-2e-15, 2e-15])
def test_a_stress_that_rounding_keeps_off_the_surface_lies_on_it(off):
    """Along the surface (psi0 = 90 degrees) the elastic part is a double root: an error e becomes sqrt(e)."""
    psi0, q = np.full(5, 90.0), np.array([0.1, 0.5, 1.0, 2.0, 5.0])
    _, length = angle_after("direct", psi0, q, length=1.0 + off)
    np.testing.assert_allclose(length, np.hypot(1.0, q), rtol=1e-10)


@pytest.mark.parametrize(
    ("integrator", "order"), [("backward_euler", 2), ("tangent_radial_return", 2), ("secant", 3), ("substepping", 2)]
)
def test_error_of_one_increment_falls_with_the_integrators_order(integrator, order):
    """Local truncation error: backward and forward Euler are of first order (local 2), the secant of second (3)."""
    sizes = np.array([0.2, 0.1, 0.05, 0.025])
    psi0 = np.full(4, 60.0)
    errors = angle_after(integrator, psi0, sizes)[0] - exact_angle(psi0, sizes)
    assert fit_rate(sizes, errors).rate == pytest.approx(order, abs=0.15)


def test_substepping_converges_to_the_exact_answer():
    """Global order 1 in the number of sub-increments, over every row of the table."""
    counts = np.array([10, 20, 40, 80, 160])
    errors = [np.abs(angle_after("substepping", TABLE[:, 0], TABLE[:, 1], n)[0] - TABLE[:, 2]).max() for n in counts]
    assert fit_rate(1 / counts[1:], errors[1:]).rate == pytest.approx(1.0, abs=0.1)
    assert errors[-1] < 0.5


def test_integrators_rank_as_krieg_and_krieg_found():
    """Krieg & Krieg: secant is best for small increments, radial return for large ones; tangent is worst when large."""
    psi0 = np.arange(5.0, 91.0, 5.0)  # beyond 90 degrees the stress first goes inside the yield surface

    def mean_error(integrator, size):
        q = np.full(psi0.shape, size)
        return np.abs(angle_after(integrator, psi0, q)[0] - exact_angle(psi0, q)).mean()

    small = {i: mean_error(i, 0.2) for i in INTEGRATORS}
    assert small["secant"] < 0.25 * min(small["radial_return"], small["tangent_radial_return"])
    assert small["substepping"] < 0.25 * small["tangent_radial_return"]
    large = {i: mean_error(i, 5.0) for i in INTEGRATORS}
    assert large["radial_return"] < large["secant"]
    assert large["radial_return"] < large["tangent_radial_return"]
