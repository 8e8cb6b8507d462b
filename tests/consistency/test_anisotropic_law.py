# SPDX-License-Identifier: Apache-2.0
"""Every yield function with every hardening, kinematic and rate law: tangent, yield, work, rotation, robustness."""

import itertools
import json
from pathlib import Path

import numpy as np
import pytest

from presswork import _core
from presswork.case.material.yield_function import Barlat1989, Hill1948

SETS = json.loads((Path(__file__).parents[1] / "data" / "yld2000.json").read_text())
YOUNG, POISSON = 70e3, 0.33
YIELDS = {
    "von_mises": _core.YieldFunction.hill1948([0.5, 0.5, 0.5, 1.5, 1.5, 1.5]),
    "hill1948": Hill1948(r00=1.79, r45=1.51, r90=2.27).build(),
    "barlat1989_6": Barlat1989(r00=0.8, r45=0.37, r90=0.54, exponent=6).build(),
    "barlat1989_8": Barlat1989(r00=0.8, r45=0.37, r90=0.54, exponent=8).build(),
    "yld2000_6": _core.YieldFunction.yld2000(SETS["EDDQ"]["alpha"], 6),
    "yld2000_8": _core.YieldFunction.yld2000(SETS["AA2090-T3"]["alpha"], 8),
}
HARDENINGS = {
    "linear": [200.0, 300.0],
    "swift": [565.0, 0.007, 0.26],
    "ludwik": [150.0, 400.0, 0.3],
    "voce": [140.0, 330.0, 12.4],
    "hockett_sherby": [200.0, 400.0, 5.0, 0.7],
    "table": [0.0, 200.0, 0.05, 300.0, 0.5, 400.0],
    "linear_voce": [140.0, 330.0, 12.4, 80.0],
    "swift_voce": [0.4, 565.0, 0.007, 0.26, 200.0, 400.0, 10.0],
    "monotone_table": [0.0, 200.0, 3000.0, 0.05, 300.0, 500.0, 0.5, 400.0, 100.0],
}
CHABOCHE = _core.Chaboche([3000.0, 800.0], [60.0, 0.0])
YOSHIDA_UEMORI = _core.YoshidaUemori(Y=150.0, B=190.0, C=200.0, m=12.0, b=40.0, Rsat=190.0, h=0.4)
KINEMATICS = {
    "none": {},
    "chaboche": {"chaboche": CHABOCHE},
    "yoshida_uemori": {"yoshida_uemori": YOSHIDA_UEMORI, "young_saturated": 60e3, "young_rate": 50.0},
}
RATES = {
    "none": {},
    "cowper_symonds": {"D": 40.0, "q": 5.0},
    "johnson_cook": {"C": 0.02, "reference_rate": 1e-3},
    "logarithmic": {"C": 0.02, "reference_rate": 1e-3},
}
DT = 0.01


def make_law(yields="von_mises", hardening="voce", kinematic="none", rate="none") -> _core.SheetLaw:
    name, parameters = (hardening, HARDENINGS[hardening]) if kinematic != "yoshida_uemori" else ("linear", [150.0, 0.0])
    return _core.SheetLaw(
        YOUNG,
        POISSON,
        YIELDS[yields],
        _core.HardeningLaw[name],
        parameters,
        rate=_core.RateLaw[rate],
        rate_parameters=RATES[rate],
        **KINEMATICS[kinematic],
    )


COMBINATIONS = [
    *((y, h, "none", "none") for y, h in itertools.product(YIELDS, HARDENINGS)),
    *((y, "voce", k, "none") for y, k in itertools.product(YIELDS, ("chaboche", "yoshida_uemori"))),
    *(("yld2000_8", "swift", k, r) for k, r in itertools.product(("none", "chaboche"), list(RATES)[1:])),
]
laws = pytest.mark.parametrize("names", COMBINATIONS, ids="-".join)


def elastic_strain(stress: np.ndarray) -> np.ndarray:
    xx, yy, xy = stress.T
    return np.stack([xx - POISSON * yy, yy - POISSON * xx, 2 * (1 + POISSON) * xy], axis=1) / YOUNG


def prepared_points(law: _core.SheetLaw, n: int, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Stress and history of points that two different increments have hardened."""
    rng = np.random.default_rng(seed)
    stress, history = np.zeros((n, 3)), np.zeros((n, law.history_size))
    for _ in range(2):
        stress, history, _, _, failed = law.update(0.01 * rng.standard_normal((n, 3)), stress, history, dt=DT)
        assert not failed.any()
    return stress, history


@laws
def test_tangent_is_the_derivative_of_the_stress(names) -> None:
    law = make_law(*names)
    n = 200
    rng = np.random.default_rng(2)
    stress, history = prepared_points(law, n)
    strain = rng.standard_normal((n, 3)) * np.geomspace(1e-4, 0.1, n)[:, None]
    _, new_history, _, tangent, failed = law.update(strain, stress, history, dt=DT)
    assert not failed.any()
    assert 5 < (new_history[:, 0] > history[:, 0]).sum() < n, "both sides of yield must be there"
    by_duals = law.differentiate(strain, stress, history, dt=DT)
    np.testing.assert_allclose(tangent, by_duals, atol=1e-6 * YOUNG)
    step = 2e-8
    for j in range(3):
        move = np.zeros(3)
        move[j] = step
        ahead, behind = (law.update(strain + s * move, stress, history, dt=DT)[0] for s in (1, -1))
        error = np.abs(tangent[:, :, j] - (ahead - behind) / (2 * step)).max(axis=1) / YOUNG
        assert np.median(error) < 1e-7
        assert np.sort(error)[-3] < 1e-6, "two points may pass yield within the difference"


CORNERS = [(1, 0, 0), (0, 1, 0), (1, 1, 0), (1, -1, 0), (0, 0, 1), (1, 1, 1), (1, 1, 1e-9), (1, 1e-9, 0), (2, 1, 0)]


@pytest.mark.parametrize("yields", YIELDS)
def test_tangent_is_the_derivative_at_the_corners(yields) -> None:
    """Stresses with equal principal values, or none of one: where functions of principal values are delicate."""
    law = make_law(yields)
    zero, history = np.zeros((len(CORNERS), 3)), np.zeros((len(CORNERS), 1))
    strain = elastic_strain(np.array(CORNERS, dtype=float)) * 3000.0
    tangent, step = law.update(strain, zero, history)[3], 1e-8
    np.testing.assert_allclose(tangent, law.differentiate(strain, zero, history), atol=1e-7 * YOUNG)
    for j, move in enumerate(step * np.eye(3)):
        ahead, behind = (law.update(strain + s * move, zero, history)[0] for s in (1, -1))
        np.testing.assert_allclose(tangent[:, :, j], (ahead - behind) / (2 * step), atol=1e-6 * YOUNG)


@laws
def test_stress_ends_on_the_yield_surface_and_plastic_work_is_positive(names) -> None:
    """stress - back stress on the surface; (stress - back) : plastic strain = flow stress dp."""
    law = make_law(*names)
    rng = np.random.default_rng(3)
    n = 200
    strain = 0.02 * rng.standard_normal((n, 3))
    zero, start = np.zeros((n, 3)), np.zeros((n, law.history_size))
    stress, history, _, _, failed = law.update(strain, zero, start, dt=DT)
    assert not failed.any()
    assert (history[:, 0] > 0).all()
    back = history[:, 1:7].reshape(n, 2, 3).sum(axis=1) if names[2] != "none" else np.zeros((n, 3))
    value = YIELDS[names[0]].evaluate(stress - back)[0]
    plastic = strain - elastic_strain(stress)
    np.testing.assert_allclose(((stress - back) * plastic).sum(axis=1), value * history[:, 0], rtol=1e-7)
    if names[3] == "none":
        np.testing.assert_allclose(value, law.flow_stress(history[:, 0])[0], rtol=1e-9)
    else:
        assert (value > law.flow_stress(history[:, 0])[0]).all()


@laws
@pytest.mark.parametrize("times", [20.0, 200.0])
def test_no_trial_stress_is_too_large(names, times) -> None:
    """Directions everywhere, the trial stress 20 and 200 times the yield stress; plane stress to the last point."""
    law = make_law(*names)
    n = 3000
    stress = np.random.default_rng(4).standard_normal((n, 3))
    stress *= (times * 200.0 / YIELDS[names[0]].evaluate(stress)[0])[:, None]
    _, history, _, _, failed = law.update(elastic_strain(stress), 0 * stress, np.zeros((n, law.history_size)), dt=DT)
    assert not failed.any()
    assert np.isfinite(history).all()


@laws
def test_packs_and_single_points_give_the_same(names) -> None:
    law = make_law(*names)
    stress, history = prepared_points(law, 37)
    strain = np.random.default_rng(5).standard_normal((37, 3)) * np.geomspace(1e-4, 0.3, 37)[:, None]
    by_packs, by_points = (law.update(strain, stress, history, dt=DT, packed=p) for p in (True, False))
    for a, b in zip(by_packs, by_points, strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-6, atol=1e-6)


@laws
def test_a_failed_point_keeps_its_state(names) -> None:
    law = make_law(*names)
    stress, history = prepared_points(law, 3)
    strain = np.array([[np.nan, 0, 0], [0.01, 0, 0], [0, np.inf, 0]])
    new_stress, new_history, _, _, failed = law.update(strain, stress, history, dt=DT)
    np.testing.assert_array_equal(failed, [1, 0, 1])
    np.testing.assert_array_equal(new_stress[[0, 2]], stress[[0, 2]])
    np.testing.assert_array_equal(new_history[[0, 2]], history[[0, 2]])
    assert np.isfinite(new_stress).all()


def turn(stress: np.ndarray, angle: float, shear_factor: float = 1.0) -> np.ndarray:
    """Components of a plane tensor in axes turned by the angle; shear_factor 2 for engineering shear."""
    c, s = np.cos(angle), np.sin(angle)
    xx, yy, xy = stress[:, 0], stress[:, 1], stress[:, 2] / shear_factor
    return np.stack(
        [
            c * c * xx + s * s * yy + 2 * s * c * xy,
            s * s * xx + c * c * yy - 2 * s * c * xy,
            shear_factor * (s * c * (yy - xx) + (c * c - s * s) * xy),
        ],
        axis=1,
    )


@pytest.mark.parametrize("kinematic", KINEMATICS)
@pytest.mark.parametrize("which", ["von_mises", "barlat1989", "yld2000"])
def test_isotropic_laws_do_not_know_where_x_points(which, kinematic) -> None:
    functions = {
        "von_mises": YIELDS["von_mises"],
        "barlat1989": Barlat1989(r00=1.0, r45=1.0, r90=1.0, exponent=8).build(),
        "yld2000": _core.YieldFunction.yld2000([1.0] * 8, 8),
    }
    hardening = ("linear", [150.0, 0.0]) if kinematic == "yoshida_uemori" else ("voce", HARDENINGS["voce"])
    law = _core.SheetLaw(
        YOUNG, POISSON, functions[which], _core.HardeningLaw[hardening[0]], hardening[1], **KINEMATICS[kinematic]
    )
    rng = np.random.default_rng(6)
    stress, turned, angle = np.zeros((50, 3)), np.zeros((50, 3)), 0.7
    history = turned_history = np.zeros((50, law.history_size))
    for _ in range(4):
        strain = 0.01 * rng.standard_normal((50, 3))
        stress, history, *_ = law.update(strain, stress, history)
        turned, turned_history, *_ = law.update(turn(strain, angle, 2.0), turned, turned_history)
    np.testing.assert_allclose(turned, turn(stress, angle), atol=1e-6)
    np.testing.assert_allclose(turned_history[:, 0], history[:, 0], rtol=1e-8)


@pytest.mark.parametrize("law", ["hill1948", "barlat1989"])
def test_exchanging_r00_and_r90_turns_the_sheet_by_90_degrees(law) -> None:
    def build(r00, r90):
        if law == "hill1948":
            return Hill1948(r00=r00, r45=1.2, r90=r90)
        return Barlat1989(r00=r00, r45=1.2, r90=r90, exponent=8)

    one, other = build(0.7, 1.9).build(), build(1.9, 0.7).build()
    scale = other.evaluate(np.array([[0.0, 1.0, 0.0]]))[0]  # the flow stress belongs to the rolling direction
    stress = np.random.default_rng(7).standard_normal((50, 3))
    np.testing.assert_allclose(one.evaluate(turn(stress, np.pi / 2))[0] * scale, other.evaluate(stress)[0], rtol=1e-9)


def test_in_no_time_a_law_with_a_rate_answers_elastically() -> None:
    """So that a converged state can be evaluated again, without the relaxation that time would bring."""
    strain = np.array([[0.05, 0.01, 0.02]])
    stress, history = np.zeros((1, 3)), np.zeros((1, 1))
    law = make_law(rate="cowper_symonds")
    answer, kept, *_, failed = law.update(strain, stress, history, dt=0.0)
    np.testing.assert_allclose(elastic_strain(answer), strain, rtol=1e-12)
    assert not kept.any()
    assert not failed.any()


@pytest.mark.parametrize("hardening", HARDENINGS)
def test_the_first_plastic_strain_is_found_however_small(hardening) -> None:
    """Trial stresses past the first yield by 1e-9 to 1e-1 of it, where Ludwik's curve rises without bound."""
    law = make_law(hardening=hardening)
    first = law.flow_stress(np.zeros(1))[0][0]
    strain = elastic_strain(np.outer(first * (1 + np.geomspace(1e-9, 1e-1, 400)), [1.0, 0.0, 0.0]))
    stress, history, _, _, failed = law.update(strain, np.zeros_like(strain), np.zeros((400, law.history_size)))
    assert not failed.any()
    assert (history[:, 0] > 0).all()
    effective = np.sqrt(stress[:, 0] ** 2 - stress[:, 0] * stress[:, 1] + stress[:, 1] ** 2)
    np.testing.assert_allclose(effective, law.flow_stress(history[:, 0])[0], rtol=1e-9)
