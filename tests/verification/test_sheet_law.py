# SPDX-License-Identifier: Apache-2.0
"""The return mapping and the hardening laws of sheets against closed forms and independent integrations."""

from __future__ import annotations

import json

import numpy as np
import pytest

from presswork import _core
from presswork.case.material.yield_function import Barlat1989, Hill1948
from presswork.case.material.yld2000_fit import tension
from tests.problems.plane_solids import DATA, fit_rate
from tests.problems.sheet_paths import VON_MISES, follow, integrate_rates, integrate_yoshida_uemori, pull

SETS = json.loads((DATA / "yld2000.json").read_text())
YOUNG, POISSON = 70e3, 0.33
VOCE = [140.0, 330.0, 12.4]
YIELDS = {
    "von_mises": VON_MISES,
    "hill1948": Hill1948(r00=1.79, r45=1.51, r90=2.27).build(),
    "barlat1989": Barlat1989(r00=0.8, r45=0.37, r90=0.54, exponent=8).build(),
    "yld2000": _core.YieldFunction.yld2000(SETS["AA2090-T3"]["alpha"], 8),
}
BACK = {"none": ((), ()), "chaboche": ((3000.0, 800.0), (60.0, 0.0))}
YOSHIDA = {"Y": 150.0, "B": 190.0, "C": 200.0, "m": 12.0, "b": 40.0, "Rsat": 190.0, "h": 0.4, "Ea": 60e3, "xi": 50.0}


def make_law(function=VON_MISES, hardening="voce", parameters=VOCE, **options) -> _core.SheetLaw:
    return _core.SheetLaw(YOUNG, POISSON, function, _core.HardeningLaw[hardening], parameters, **options)


@pytest.mark.parametrize("back", BACK)
@pytest.mark.parametrize("name", YIELDS)
def test_increments_converge_to_the_rate_equations_on_paths_that_turn(name, back):
    """Three random turns of 2 % strain at 20 points; first order, as backward Euler has it."""
    C, gamma = BACK[back]
    law = make_law(YIELDS[name], chaboche=_core.Chaboche(C, gamma) if C else None)
    path = 0.02 * np.random.default_rng(0).standard_normal((3, 20, 3))
    exact, _ = integrate_rates(YIELDS[name], law.flow_stress, YOUNG, POISSON, path, 2000, C, gamma)
    counts = np.array([4, 16, 64])
    errors = np.array([np.abs(follow(law, path, n)[0] - exact).max() for n in counts])
    assert fit_rate(1 / counts, errors).rate == pytest.approx(1.0, abs=0.1)
    assert errors[-1] < 0.01 * np.abs(exact).max()


@pytest.mark.parametrize("angle", [0.0, 30.0, 45.0, 90.0])
@pytest.mark.parametrize("p", [0.003, 0.3])
@pytest.mark.parametrize("name", YIELDS)
def test_tension_across_the_sheet_meets_the_closed_form_in_one_increment(name, p, angle):
    """Elastic strain and p times the gradient: the stress is flow(p) / f(unit tension) along, nothing else."""
    function = YIELDS[name]
    law = make_law(function)
    along = tension(np.radians([angle]))
    value, gradient, _ = function.evaluate(along)
    sigma = law.flow_stress(np.array([p]))[0][0] / value[0]
    stress = sigma * along
    compliance = np.array([[1, -POISSON, 0], [-POISSON, 1, 0], [0, 0, 2 * (1 + POISSON)]]) / YOUNG
    strain = stress @ compliance + p * gradient
    end, history = follow(law, strain[None], 1)
    np.testing.assert_allclose(end, stress, atol=1e-6)
    assert history[0, 0] == pytest.approx(p, rel=1e-9)


def test_thickness_keeps_the_volume_but_for_the_elastic_part():
    law = make_law(YIELDS["yld2000"])
    stress, p, strain = pull(law, np.linspace(0.02, 0.2, 10))
    volume = strain[:, 0] + strain[:, 1] + strain[:, 3]
    np.testing.assert_allclose(volume, (1 - 2 * POISSON) / YOUNG * stress, rtol=1e-9)
    r = YIELDS["yld2000"].evaluate(tension(np.zeros(1)))[1][0]
    plastic = p * -(r[0] + r[1])
    np.testing.assert_allclose(strain[:, 3], plastic - POISSON * stress / YOUNG, rtol=1e-6)


def test_cyclic_shear_with_a_linear_back_stress_is_bilinear():
    """Prager: tau = k + (H + C)/3 gamma_p going up, less 2k when the load turns; k = flow/sqrt(3). Any increments."""
    C, flow = 900.0, 150.0
    law = make_law(hardening="linear", parameters=[flow, 0.0], chaboche=_core.Chaboche([C], [0.0]))
    G, k = YOUNG / 2 / (1 + POISSON), flow / np.sqrt(3)
    slope = C / 3 / (1 + C / 3 / G)  # d tau/d gamma with the elastic part
    stress, history = np.zeros((1, 3)), np.zeros((1, law.history_size))
    gamma, tau = 0.0, 0.0
    for target in (0.05, -0.08, 0.03):
        sign = np.sign(target - gamma)
        yielded = sign * k + history[0, 3]  # centre of the surface, and the strain to get to its edge
        gamma_yield = gamma + (yielded - tau) / G
        expected = yielded + slope * (target - gamma_yield)
        for _ in range(3):
            strain = np.array([[0.0, 0.0, (target - gamma) / 3]])
            stress, history, *_ = law.update(strain, stress, history)
        assert stress[0, 2] == pytest.approx(expected, rel=1e-9)
        gamma, tau = target, expected


def test_tension_and_compression_with_chaboche_meet_the_closed_form():
    """a = s C/g + (a0 - s C/g) exp(-g |p - p0|); stress = s flow(p) + a. First order in the increment."""
    C, gamma = 6000.0, 40.0
    law = make_law(chaboche=_core.Chaboche([C], [gamma]))
    errors, counts = [], np.array([100, 200, 400])
    for n in counts:
        turns = [0.05, -0.04, 0.06]
        strains = np.concatenate([np.linspace(a, b, n + 1)[1:] for a, b in zip([0.0, *turns], turns, strict=False)])
        stress, p, _ = pull(law, strains)
        a0, p0, worst = 0.0, 0.0, 0.0
        for i in range(3):
            sign = (1, -1, 1)[i]
            part = slice(i * n + n // 2, (i + 1) * n)
            # the closed form starts where plastic flow starts again: the eqps at the turn
            a = sign * C / gamma + (a0 - sign * C / gamma) * np.exp(-gamma * (p[part] - p0))
            exact = sign * law.flow_stress(p[part])[0] + a
            worst = max(worst, np.abs(stress[part] - exact).max())
            a0, p0 = a[-1], p[(i + 1) * n - 1]
        errors.append(worst)
    assert fit_rate(1 / counts, np.array(errors)).rate == pytest.approx(1.0, abs=0.1)
    assert errors[-1] < 0.5, "MPa, of stresses to 450"


def test_chaboche_back_stresses_add_up():
    """Two halves are one; a third that saturates at once raises the stress at the same plastic strain by C/g."""
    strains = np.linspace(0.001, 0.05, 40)
    whole, p, _ = pull(make_law(chaboche=_core.Chaboche([6000.0], [40.0])), strains)
    halves = pull(make_law(chaboche=_core.Chaboche([3000.0, 3000.0], [40.0, 40.0])), strains)[0]
    np.testing.assert_allclose(halves, whole, rtol=1e-9)
    three, p3, _ = pull(make_law(chaboche=_core.Chaboche([6000.0, 0.0, 30e6], [40.0, 1.0, 1e6])), strains)
    np.testing.assert_allclose(three[9:-1] - np.interp(p3[9:-1], p, whole), 30.0, rtol=1e-2)


@pytest.mark.parametrize("change", [{}, {"h": 0.9}, {"C": 400.0}, {"xi": 0.0}, {"b": 80.0}])
def test_yoshida_uemori_converges_to_the_independent_integration(change):
    """Tension to 5 %, compression to -5 %, tension to 8 %: Bauschinger, transient, stagnation, falling modulus."""
    data = YOSHIDA | change
    surfaces = _core.YoshidaUemori(**{k: data[k] for k in ("Y", "B", "C", "m", "b", "Rsat", "h")})
    law = make_law(
        hardening="linear",
        parameters=[data["Y"], 0.0],
        yoshida_uemori=surfaces,
        young_saturated=data["Ea"],
        young_rate=data["xi"],
    )
    turns = [0.05, -0.05, 0.08]
    reference = integrate_yoshida_uemori(data, YOUNG, turns, dp=2e-6)
    turned = np.flatnonzero(np.diff(np.sign(np.diff(reference[:, 0])))) + 1
    exact = np.split(reference, turned)
    errors, counts = [], np.array([100, 200, 400])
    for n in counts:
        strains = np.concatenate([np.linspace(a, b, n + 1)[1:] for a, b in zip([0.0, *turns], turns, strict=False)])
        stress = pull(law, strains)[0].reshape(3, n)
        worst = 0.0
        for branch, mine, there in zip(exact, stress, strains.reshape(3, n), strict=True):
            order = np.argsort(branch[:, 0])
            late = slice(n // 5, None)
            expected = np.interp(there[late], branch[order, 0], branch[order, 1])
            worst = max(worst, np.abs(mine[late] - expected).max())
        errors.append(worst)
    assert fit_rate(1 / counts, np.array(errors)).rate == pytest.approx(1.0, abs=0.2)
    assert errors[-1] < 1.5, "MPa, of stresses to 400"


def test_young_modulus_falls_with_plastic_strain_as_measured_on_unloading():
    law = make_law(young_saturated=60e3, young_rate=50.0)
    stress, p, _ = pull(law, np.array([0.02, 0.0199]))
    slope = (stress[0] - stress[1]) / 1e-4
    assert slope == pytest.approx(60e3 + 10e3 * np.exp(-50 * p[0]), rel=1e-9)


@pytest.mark.parametrize("rate", [1e-4, 1.0, 100.0])
@pytest.mark.parametrize(
    ("law", "parameters", "factor"),
    [
        ("cowper_symonds", {"D": 40.0, "q": 5.0}, lambda r: 1 + (r / 40) ** 0.2),
        ("johnson_cook", {"C": 0.02, "reference_rate": 0.01}, lambda r: 1 + 0.02 * np.log(max(r / 0.01, 1.0))),
        ("logarithmic", {"C": 0.02, "reference_rate": 0.01}, lambda r: 1 + 0.02 * np.log(1 + r / 0.01)),
    ],
)
def test_rate_laws_meet_their_formula_at_constant_rate(law, parameters, factor, rate):
    """Without hardening the stress stands still, so that the plastic rate is the total one."""
    sheet = make_law(hardening="linear", parameters=[150.0, 0.0], rate=_core.RateLaw[law], rate_parameters=parameters)
    stress, _, _ = pull(sheet, np.linspace(0.01, 0.1, 10), dt=0.01 / rate)
    assert stress[-1] == pytest.approx(150 * factor(rate), rel=1e-8)


def test_temperature_softens_the_flow_stress_by_johnson_and_cooks_factor():
    thermal = _core.Thermal(start=20.0, reference=20.0, melting=1020.0, exponent=1.0, heating=0.0)
    law = make_law(thermal=thermal)
    strain, zero, start = np.array([[0.02, -0.01, 0.0]]), np.zeros((1, 3)), np.zeros((1, 1))
    stress, history, *_ = law.update(strain, zero, start, temperature=np.array([110.0]))
    value = VON_MISES.evaluate(stress)[0]
    assert value[0] == pytest.approx((1 - 0.09) * law.flow_stress(history[:, 0])[0][0], rel=1e-9)


@pytest.mark.parametrize("chaboche", [None, _core.Chaboche([3000.0], [60.0])])
@pytest.mark.parametrize("hill", [[0.5, 0.5, 0.5, 1.5, 1.5, 1.5], [0.28, 0.36, 0.64, 1.5, 1.5, 1.29]])
def test_three_dimensional_law_gives_the_sheets_answer_where_the_thickness_stress_is_zero(hill, chaboche):
    sheet = make_law(_core.YieldFunction.hill1948(hill), chaboche=chaboche)
    solid = _core.SolidLaw(
        YOUNG, POISSON, _core.YieldFunction.hill1948(hill), _core.HardeningLaw.voce, VOCE, chaboche=chaboche
    )
    path = 0.02 * np.random.default_rng(8).standard_normal((4, 30, 3))
    stress, history = np.zeros((30, 3)), np.zeros((30, sheet.history_size))
    stress3, history3 = np.zeros((30, 6)), np.zeros((30, solid.history_size))
    for change in path:
        stress, history, thickness, _, _ = sheet.update(change, stress, history)
        strain = np.zeros((30, 6))
        strain[:, :2], strain[:, 2], strain[:, 3] = change[:, :2], thickness, change[:, 2]
        stress3, history3, _, _, failed = solid.update(strain, stress3, history3)
        assert not failed.any()
        np.testing.assert_allclose(stress3[:, [0, 1, 3]], stress, atol=1e-5)
        np.testing.assert_allclose(stress3[:, [2, 4, 5]], 0.0, atol=1e-5)
    np.testing.assert_allclose(history3[:, 0], history[:, 0], rtol=1e-8)


def test_three_dimensional_law_is_the_von_mises_law_of_solids():
    rng = np.random.default_rng(9)
    solid = _core.SolidLaw(YOUNG, POISSON, VON_MISES, _core.HardeningLaw.voce, VOCE)
    plain = _core.VonMises(YOUNG, POISSON, _core.HardeningLaw.voce, VOCE)
    strain = np.zeros((40, 6))
    strain[:, :4] = 0.02 * rng.standard_normal((40, 4))
    stress, history, _, tangent, _ = solid.update(strain, np.zeros((40, 6)), np.zeros((40, 1)))
    expected, eqps, matrix = plain.update(strain[:, :4], np.zeros((40, 4)), np.zeros(40))
    np.testing.assert_allclose(stress[:, :4], expected, rtol=1e-8, atol=1e-5)
    np.testing.assert_allclose(history[:, 0], eqps, rtol=1e-8)
    np.testing.assert_allclose(tangent[:, :4, :4], matrix, atol=1e-6 * YOUNG)


SENSITIVE = {
    "cowper_symonds": {"D": 40.0, "q": 5.0},
    "johnson_cook": {"C": 0.02, "reference_rate": 1.0},
    "logarithmic": {"C": 0.02, "reference_rate": 1.0},
}


@pytest.mark.parametrize("rate", SENSITIVE)
@pytest.mark.parametrize("dt", [2e-7, 1e-3, 1.0])
def test_no_point_fails_at_a_rate_whatever_the_step(rate, dt):
    """Strain increments of 1e-8 to 3e-4 that turn now and then, 120 of 400 points: the slope is steep near rest."""
    law = make_law(rate=_core.RateLaw[rate], rate_parameters=SENSITIVE[rate])
    rng = np.random.default_rng(0)
    stress, history = np.zeros((400, 3)), np.zeros((400, law.history_size))
    for step in range(120):
        if step % 40 == 0:
            direction = rng.standard_normal((400, 3))
        strain = direction * 10 ** rng.uniform(-8, -3.5, (400, 1))
        stress, history, _, _, failed = law.update(strain, stress, history, dt=dt)
        assert not failed.any()
    assert (history[:, 0] > 0).mean() > 0.5


def test_cowper_and_symonds_factor_rises_from_one_without_a_jump():
    law = make_law(rate=_core.RateLaw.cowper_symonds, rate_parameters={"D": 40.0, "q": 5.0})
    factor, slope = law.rate_factor(np.array([0.0, 2e-11, 4e-11 * (1 - 1e-9), 4e-11 * (1 + 1e-9), 40.0]))
    rise = 1e-12**0.2
    np.testing.assert_allclose(factor, [1.0, 1 + rise / 2, 1 + rise, 1 + rise, 2.0], rtol=1e-9)
    np.testing.assert_allclose(slope[:3], rise / 4e-11, rtol=1e-9)


def test_johnson_and_cooks_kink_is_rounded_and_nothing_else():
    """Outside 0.76 to 1.2 of the reference rate the formula holds; inside it is off by at most 0.054 C."""
    law = make_law(rate=_core.RateLaw.johnson_cook, rate_parameters={"C": 0.02, "reference_rate": 3.0})
    share = np.linspace(0.0, 2.0, 2001)
    factor, slope = law.rate_factor(3.0 * share)
    off = factor - 1 - 0.02 * np.log(np.maximum(share, 1.0))
    outside = (share < 0.762) | (share > 1.2)
    np.testing.assert_allclose(off[outside], 0.0, atol=1e-14)
    assert off.min() + 1e-14 >= 0.0
    assert off.max() < 0.054 * 0.02
    np.testing.assert_allclose(np.cumsum(slope[:-1] + slope[1:]) * 0.0015, factor[1:] - 1, atol=1e-7)
