# SPDX-License-Identifier: Apache-2.0
"""Forming limits against closed forms and tests/data/mk_flc_mises.csv, an independent integration of the M-K theory."""

from __future__ import annotations

import json

import numpy as np
import pytest
from scipy.optimize import brentq

from presswork import _core
from presswork.case.material.forming_limit.curves import keeler_curve, swift_hill_curve
from presswork.case.material.forming_limit.marciniak import marciniak_kuczynski_curve
from presswork.case.material.forming_limit.proportional import find_stress, turn_stress
from presswork.case.material.yield_function import Barlat1989, Hill1948
from presswork.material.stress_limit import find_stress_limit
from tests.problems.plane_solids import DATA
from tests.problems.sheet_paths import VON_MISES

TABLE = np.loadtxt(DATA / "mk_flc_mises.csv", delimiter=",", skiprows=2)
SETS = json.loads((DATA / "yld2000.json").read_text())
ACROSS = np.array([0.0])
YIELDS = {
    "von_mises": VON_MISES,
    "hill1948": Hill1948(r00=1.79, r45=1.51, r90=2.27).build(),
    "barlat1989": Barlat1989(r00=0.8, r45=0.37, r90=0.54, exponent=8).build(),
    "yld2000": _core.YieldFunction.yld2000(SETS["AA2090-T3"]["alpha"], 8),
}


def swift(n, e0=1e-8, function=VON_MISES, **options):
    return _core.SheetLaw(70e3, 0.33, function, _core.HardeningLaw.swift, [500.0, max(e0, 1e-8), n], **options)


@pytest.mark.parametrize(("n", "f0", "e0"), sorted({tuple(row[:3]) for row in TABLE}))
def test_marciniak_kuczynski_meets_the_table_for_von_mises(n, f0, e0):
    rows = TABLE[(TABLE[:, 0] == n) & (TABLE[:, 1] == f0) & (TABLE[:, 2] == e0)]
    for row in rows:
        curve = marciniak_kuczynski_curve(
            VON_MISES, swift(n, e0), imperfection=f0, ratios=row[3:4], groove_angles=ACROSS
        )
        assert curve.major[0] == pytest.approx(row[4], abs=1e-4)
        assert curve.minor[0] == pytest.approx(row[5], abs=1e-4)


@pytest.mark.parametrize("name", YIELDS)
@pytest.mark.parametrize(("n", "f0"), [(0.2, 0.99), (0.25, 0.996)])
def test_marciniak_kuczynski_at_plane_strain_is_its_closed_form(name, n, f0):
    """e^n exp(-e) = f0 n^n exp(-n), whatever the yield function."""
    exact = brentq(lambda e: e**n * np.exp(-e) - f0 * n**n * np.exp(-n), 1e-6, n)
    # e is the major strain; for other yield functions the flow curve along it is the same power law scaled
    curve = marciniak_kuczynski_curve(
        YIELDS[name], swift(n), imperfection=f0, ratios=np.array([0.0]), groove_angles=ACROSS
    )
    assert curve.major[0] == pytest.approx(exact, abs=1e-5)


@pytest.mark.parametrize("f0", [0.98, 0.999])
@pytest.mark.parametrize(
    ("kind", "parameters"),
    [
        ("linear", [200.0, 900.0]),
        ("ludwik", [265.0, 426.0, 0.34]),
        ("ludwik", [792.0, 510.0, 0.26]),
        ("voce", [140.0, 330.0, 12.4]),
        ("hockett_sherby", [200.0, 400.0, 5.0, 0.7]),
        ("swift_voce", [0.4, 565.0, 0.007, 0.26, 200.0, 400.0, 10.0]),
        ("table", [0.0, 200.0, 0.05, 300.0, 0.5, 450.0]),
    ],
)
def test_marciniak_kuczynski_at_plane_strain_is_the_force_balance_for_every_hardening_law(kind, parameters, f0):
    """Y(k e) exp(-e) = f0 max over e of the same, k = 2/sqrt(3) for von Mises."""
    law = _core.SheetLaw(70e3, 0.33, VON_MISES, _core.HardeningLaw[kind], parameters)

    def force(e):
        return law.flow_stress(np.atleast_1d(2 / np.sqrt(3) * e))[0] * np.exp(-np.atleast_1d(e))

    strain = np.linspace(0.0, 2.0, 200001)
    top = int(np.argmax(force(strain)))
    exact = brentq(lambda e: force(e)[0] - f0 * force(strain[top : top + 1])[0], 0.0, strain[top])
    curve = marciniak_kuczynski_curve(VON_MISES, law, imperfection=f0, ratios=np.array([0.0]), groove_angles=ACROSS)
    assert curve.major[0] == pytest.approx(exact, abs=1e-4)


def test_an_oblique_groove_is_the_worst_left_of_plane_strain_and_gives_nearly_hills_line():
    """Hill 1952: the zero-extension direction; with a vanishing groove the M-K limit goes to n/(1+rho)."""
    ratios = np.array([-0.3])
    law = swift(0.2)
    worst = marciniak_kuczynski_curve(VON_MISES, law, imperfection=0.99999, ratios=ratios).major[0]
    across = marciniak_kuczynski_curve(VON_MISES, law, imperfection=0.99999, ratios=ratios, groove_angles=ACROSS).major[
        0
    ]
    assert worst < 0.95 * across
    assert worst == pytest.approx(0.2 / 0.7, rel=0.02)


def test_a_groove_that_stays_at_its_angle_would_be_another_limit():
    """The groove turns towards the major direction: one that starts at 10 degrees soon lies worse than one across."""
    law = swift(0.2)
    limits = [
        marciniak_kuczynski_curve(
            VON_MISES, law, imperfection=0.99, ratios=np.array([-0.3]), groove_angles=np.array([a])
        ).major[0]
        for a in (0.0, 10.0)
    ]
    assert limits[1] < limits[0] - 0.01


def test_rate_sensitivity_raises_the_limit_as_hutchinson_and_neale_found():
    """At plane strain a rate factor r^m gives f^(1/m) integrals (Hutchinson & Neale 1978): the limit grows with m."""
    ratios = np.array([0.0])
    limits = [
        marciniak_kuczynski_curve(
            VON_MISES,
            swift(0.2, rate=_core.RateLaw.logarithmic, rate_parameters={"C": C, "reference_rate": 1e-4}),
            imperfection=0.99,
            ratios=ratios,
            groove_angles=ACROSS,
        ).major[0]
        for C in (0.0, 0.01, 0.03)
    ]
    assert limits[0] < limits[1] < limits[2]
    exact = integrate_plane_strain_rate(0.2, 0.99, 0.03, 1e-4, 1e-3)
    assert limits[2] == pytest.approx(exact, rel=2e-3)


def integrate_plane_strain_rate(n, f0, C, r0, rate):
    """Limit major strain at plane strain with the factor 1 + C ln(1 + r/r0), by small explicit steps of the groove.

    One equation: Y(eA) F(rA) exp(-eA) = f0 Y(eB) F(rB) exp(-eB), in equivalent strains 2/sqrt(3) of the major ones.
    """
    k = 2 / np.sqrt(3)
    sheet = groove = 1e-8
    step = 1e-4

    def factor(r):
        return 1 + C * np.log1p(r / r0)

    while groove < 5:
        ratio = (k * sheet + 1e-8) ** n * np.exp(-sheet) / (f0 * (k * groove + 1e-8) ** n * np.exp(-groove))
        needed = ratio * factor(k * rate)  # F(rB)
        faster = np.expm1((needed - 1) / C) * r0 / (k * rate)  # d eB/d eA
        if faster > 1e4:
            break
        increment = min(step, 0.01 * groove + 1e-9)
        groove += increment
        sheet += increment / max(faster, 1e-3)
    return sheet


def test_off_axis_limits_of_an_isotropic_sheet_are_those_along_the_axes():
    ratios = np.array([-0.2, 0.3])
    one, other = (
        marciniak_kuczynski_curve(VON_MISES, swift(0.2), imperfection=0.99, ratios=ratios, angle=a) for a in (0.0, 37.0)
    )
    np.testing.assert_allclose(other.major, one.major, atol=1e-4)


@pytest.mark.parametrize("n", [0.15, 0.25])
def test_swift_hill_is_the_closed_form_for_von_mises_and_a_power_law(n):
    """Swift e1 = 2n(1 + rho + rho²)/((1 + rho)(2rho² - rho + 2)); Hill e1 = n/(1 + rho)."""
    ratios = np.array([-0.5, -0.25, 0.0, 0.3, 0.6, 1.0])
    curve = swift_hill_curve(VON_MISES, swift(n), ratios)
    swift_limit = 2 * n * (1 + ratios + ratios**2) / ((1 + ratios) * (2 * ratios**2 - ratios + 2))
    exact = np.where(ratios < 0, n / (1 + ratios), swift_limit)
    np.testing.assert_allclose(curve.major, exact, rtol=1e-6)
    np.testing.assert_allclose(curve.minor, ratios * exact, atol=1e-7)


def test_hills_line_is_n_of_thickness_strain_for_every_yield_function():
    for function in YIELDS.values():
        curve = swift_hill_curve(function, swift(0.2), np.array([-0.4, -0.2]))
        np.testing.assert_allclose(curve.major + curve.minor, 0.2, rtol=1e-6)


def test_keelers_lowest_point_is_its_formula():
    minor, major = keeler_curve(1.0, 0.21).lowest()
    assert minor == 0.0
    assert np.expm1(major) == pytest.approx(0.233 + 0.1413, rel=1e-12)
    curve = keeler_curve(1.0, 0.21)
    np.testing.assert_allclose(curve.limit(np.array([-0.2])) - 0.2, major, rtol=1e-12)
    assert np.expm1(curve.limit(np.array([0.1])))[0] == pytest.approx(0.3743 + 0.6 * np.expm1(0.1), rel=1e-4)


def test_keelers_branches_agree_with_the_polynomials_in_use():
    """In per cent: FLD0 + e2 (0.784854 - 0.008565 e2) on the right, FLD0 + e2 (0.027254 e2 - 1.1965) on the left."""
    curve = keeler_curve(1.0, 0.21)
    for e2, slope in ((np.linspace(0, 25, 26), [0.784854, -0.008565]), (np.linspace(-20, 0, 21), [-1.1965, 0.027254])):
        polynomial = 37.43 + e2 * (slope[0] + slope[1] * e2)
        mine = 100 * np.expm1(curve.limit(np.log1p(e2 / 100)))
        assert np.abs(mine - polynomial).max() < 1.05


@pytest.mark.parametrize("name", YIELDS)
@pytest.mark.parametrize("angle", [0.0, 30.0, 90.0])
def test_proportional_straining_has_the_strain_ratio_asked_for(name, angle):
    ratios = np.linspace(-0.6, 1.0, 17)
    path = find_stress(YIELDS[name], ratios, angle)
    value, normal, _ = YIELDS[name].evaluate(turn_stress(path.stress, -path.angle))
    strain = turn_stress(normal * [1, 1, 0.5], path.angle)
    np.testing.assert_allclose(value, 1.0, rtol=1e-10)
    np.testing.assert_allclose(strain[:, 2], 0.0, atol=1e-10)
    np.testing.assert_allclose(strain[:, 1], ratios * strain[:, 0], atol=1e-10)
    np.testing.assert_allclose(path.rate, strain[:, :2], atol=1e-10)


def test_stress_limit_gives_the_strain_limit_back_and_moves_with_a_prestrain():
    """After balanced stretching by p the plane strain limit is what is left of p: e1 = e + (p_limit - p) sqrt(3)/2."""
    curve = keeler_curve(1.0, 0.2)
    law = swift(0.2, 0.002)
    ratios = np.linspace(-0.4, 0.9, 27)
    limit = find_stress_limit(curve, VON_MISES, law, ratios)
    strain = limit.p[:, None] * limit.path.rate
    np.testing.assert_allclose(strain[:, 0], np.interp(strain[:, 1], curve.minor, curve.major), rtol=1e-9)
    np.testing.assert_allclose(VON_MISES.evaluate(np.column_stack([limit.stresses(), 0 * ratios]))[0], limit.flow)
    np.testing.assert_allclose(limit.limit_of_p(limit.stresses()), limit.p)
    plane = int(np.argmin(np.abs(ratios)))
    after = limit.curve_after(0.1, 0.05, 0.05)  # balanced: p = 2 e
    expected = 0.05 + (limit.p[plane] - 0.1) * np.sqrt(3) / 2
    assert np.interp(0.05, after.minor, after.major) == pytest.approx(expected, rel=1e-9)
