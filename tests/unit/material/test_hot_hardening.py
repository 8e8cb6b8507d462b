# SPDX-License-Identifier: Apache-2.0
"""Flow stresses of strain, rate and temperature together, against their formulas written anew here."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from presswork import _core, model
from presswork.law.elastic_plastic import make_plane_law, make_sheet_law, make_solid_law
from presswork.model import FloatArray

STRAIN, RATE, DEGREES = (0.02, 0.9), (0.01, 100.0), (800.0, 1250.0)
WINDOW = (*STRAIN, *RATE, *DEGREES)
GAS = 8.31446261815324


def hensel_spittel(e: FloatArray, r: FloatArray, t: FloatArray) -> FloatArray:
    A, m1, m2, m3, m4, m5, m7, m8, m9 = PARAMETERS["hensel_spittel"]
    by_strain = e**m2 * np.exp(m4 / e) * (1 + e) ** (m5 * t) * np.exp(m7 * e)
    return np.asarray(A * np.exp(m1 * t) * t**m9 * by_strain * r**m3 * r ** (m8 * t))


def norton_hoff(e: FloatArray, r: FloatArray, t: FloatArray) -> FloatArray:
    K, e0, n, m, beta = PARAMETERS["norton_hoff"]
    return np.asarray(K * (e0 + e) ** n * r**m * np.exp(beta / (t + 273.15)))


def sinh_arrhenius(e: FloatArray, r: FloatArray, t: FloatArray) -> FloatArray:
    A, alpha, n, Q = PARAMETERS["sinh_arrhenius"]
    Z = r * np.exp(Q / (GAS * (t + 273.15)))
    return np.asarray(np.arcsinh((Z / A) ** (1 / n)) / alpha)


def johnson_cook(e: FloatArray, r: FloatArray, t: FloatArray) -> FloatArray:
    A, B, n, C, reference_rate, m, reference, melting = PARAMETERS["johnson_cook"]
    share = (t - reference) / (melting - reference)
    return np.asarray((A + B * e**n) * (1 + C * np.log(r / reference_rate)) * (1 - share**m))


FORMULAS: dict[str, Callable[[FloatArray, FloatArray, FloatArray], FloatArray]] = {
    f.__name__: f for f in (hensel_spittel, norton_hoff, sinh_arrhenius, johnson_cook)
}
PARAMETERS = {
    "hensel_spittel": (1500.0, -0.0027, -0.13, 0.14, -0.05, 1e-4, -0.1, 1e-5, 0.05),
    "norton_hoff": (0.8, 0.02, 0.15, 0.15, 6000.0),
    "sinh_arrhenius": (1e12, 0.012, 5.0, 3.1e5),
    "johnson_cook": (300.0, 400.0, 0.3, 0.05, 1.0, 0.9, 20.0, 1480.0),
}
"""Of the size of steel's."""
MAKERS = {3: make_sheet_law, 4: make_plane_law, 6: make_solid_law}


def hot_table(e: FloatArray, r: FloatArray, t: FloatArray) -> FloatArray:
    """Norton and Hoff's law at the points of a table, and scipy's interpolation between them."""
    values = norton_hoff(*np.meshgrid(*AXES, indexing="ij"))
    between = RegularGridInterpolator((AXES[0], np.log(AXES[1]), AXES[2]), values)
    return np.asarray(between(np.column_stack([e, np.log(r), t])))


AXES = np.linspace(*STRAIN, 5), np.geomspace(*RATE, 4), np.linspace(*DEGREES, 3)
FORMULAS["hot_table"] = hot_table


def make_material(law: str, *, heat_capacity: float | None = None) -> model.Material:
    heating = model.Heating(start=1000.0, heat_capacity=heat_capacity)
    if law == "hot_table":
        values = norton_hoff(*np.meshgrid(*AXES, indexing="ij")).ravel()
        parameters = np.concatenate([[len(axis) for axis in AXES], *AXES, values])
    else:
        parameters = np.array([*PARAMETERS[law], *WINDOW])
    hardening = model.Hardening(law, parameters)
    return model.Material("hot", 1e5, 0.3, hardening, heating=heating, density=7.8e-9)


def grid(n: int = 7) -> tuple[FloatArray, FloatArray, FloatArray]:
    axes = np.linspace(*STRAIN, n), np.geomspace(*RATE, n), np.linspace(*DEGREES, n)
    e, r, t = np.array(list(itertools.product(*axes))).T
    return np.ascontiguousarray(e), np.ascontiguousarray(r), np.ascontiguousarray(t)


@pytest.mark.parametrize("law", FORMULAS)
def test_flow_stress_is_that_of_the_formula_over_the_window(law: str) -> None:
    e, r, t = grid()
    np.testing.assert_allclose(
        make_plane_law(make_material(law)).flow_stress(e, r, t)[0], FORMULAS[law](e, r, t), rtol=1e-10
    )


@pytest.mark.parametrize("law", FORMULAS)
def test_slope_by_strain_is_that_of_the_formula(law: str) -> None:
    e, r, t = grid(6)  # between the rows of the table
    inside = (e > STRAIN[0]) & (e < STRAIN[1])
    e, r, t = e[inside], r[inside], t[inside]
    h = 1e-6
    slope = (FORMULAS[law](e + h, r, t) - FORMULAS[law](e - h, r, t)) / (2 * h)
    found = make_plane_law(make_material(law)).flow_stress(e, r, t)
    np.testing.assert_allclose(found[1], slope, rtol=1e-6, atol=1e-6 * found[0].max())


@pytest.mark.parametrize("law", FORMULAS)
def test_beyond_the_window_the_flow_stress_stays_as_at_its_end(law: str) -> None:
    compiled = make_plane_law(make_material(law))

    def flow(e: float, r: float, t: float) -> tuple[float, float]:
        stress, slope = compiled.flow_stress(np.array([e]), np.array([r]), np.array([t]))
        return float(stress[0]), float(slope[0])

    for outside, end in [
        ((0.0, 1.0, 1000.0), (STRAIN[0], 1.0, 1000.0)),
        ((3.0, 1.0, 1000.0), (STRAIN[1], 1.0, 1000.0)),
        ((0.3, 0.0, 1000.0), (0.3, RATE[0], 1000.0)),
        ((0.3, 1e5, 1000.0), (0.3, RATE[1], 1000.0)),
        ((0.3, 1.0, 20.0), (0.3, 1.0, DEGREES[0])),
        ((0.3, 1.0, 1400.0), (0.3, 1.0, DEGREES[1])),
    ]:
        assert flow(*outside)[0] == flow(*end)[0]
    assert flow(0.0, 1.0, 1000.0)[1] == flow(3.0, 1.0, 1000.0)[1] == 0.0


@pytest.mark.parametrize("components", MAKERS)
@pytest.mark.parametrize("law", FORMULAS)
def test_tangent_is_the_derivative_by_dual_numbers(law: str, components: int) -> None:
    compiled = MAKERS[components](make_material(law, heat_capacity=6e8))
    rng = np.random.default_rng(2)
    n = 60
    history = np.zeros((n, compiled.history_size))
    history[:, 0] = rng.uniform(0.03, 0.6, n)
    stress, strain = 30 * rng.standard_normal((n, components)), 0.01 * rng.standard_normal((n, components))
    degrees = rng.uniform(820, 1200, n)
    _, after, _, tangent, failed = compiled.update(strain, stress, history, dt=5e-3, temperature=degrees)
    exact = compiled.differentiate(strain, stress, history, dt=5e-3, temperature=degrees)
    assert not failed.any()
    assert (after[:, 0] > history[:, 0] + 1e-4).sum() > 50
    # the dual numbers stop with Newton's method, one step behind the values
    assert np.abs(tangent - exact).max() < 1e-7 * np.abs(exact).max()


@pytest.mark.parametrize("components", MAKERS)
@pytest.mark.parametrize("law", FORMULAS)
def test_stress_ends_on_the_flow_stress_of_the_rate_and_temperature_at_the_end(law: str, components: int) -> None:
    compiled = MAKERS[components](make_material(law, heat_capacity=6e8))
    dt, n = 0.02, 40
    history = np.zeros((n, compiled.history_size))
    history[:, 0] = np.linspace(0.03, 0.5, n)
    strain = np.zeros((n, components))
    strain[:, 1] = np.linspace(0.02, 0.1, n)
    degrees = np.linspace(850, 1150, n)
    stress, after, *_ = compiled.update(strain, np.zeros_like(strain), history, dt=dt, temperature=degrees)
    rate = (after[:, 0] - history[:, 0]) / dt
    normal = np.zeros((n, 3))
    normal[:, : min(components, 3)] = stress[:, :3] if components > 3 else np.c_[stress[:, :2], np.zeros(n)]
    deviator = normal - normal.mean(axis=1, keepdims=True)
    effective = np.sqrt(1.5 * (deviator**2).sum(axis=1))
    flow = FORMULAS[law](after[:, 0], rate, degrees + after[:, 1])
    assert (after[:, 1] > 0.1).all()
    np.testing.assert_allclose(effective, flow, rtol=1e-9)


def test_a_jump_of_the_rate_changes_the_flow_stress_by_the_exponent() -> None:
    law = make_plane_law(make_material("norton_hoff"))
    m = PARAMETERS["norton_hoff"][3]
    stress, history = np.zeros((1, 4)), np.zeros((1, law.history_size))
    effective = []
    for dt in [1e-3] * 40 + [1e-4] * 20:
        strain = np.array([[-0.5e-3, 1e-3, -0.5e-3, 0.0]])
        stress, history, *_ = law.update(strain, stress, history, dt=dt, temperature=np.array([1100.0]))
        effective.append(float(stress[0, 1] - stress[0, 0]))
    e = float(history[0, 0])
    grown = ((0.02 + e) / (0.02 + e - 20e-3)) ** PARAMETERS["norton_hoff"][2]
    assert effective[-1] / effective[39] == pytest.approx(10**m * grown, rel=1e-3)


def test_in_no_time_nothing_flows() -> None:
    law = make_plane_law(make_material("sinh_arrhenius"))
    strain = np.array([[0.0, 0.05, 0.0, 0.0]])
    _, history, *_ = law.update(strain, np.zeros((1, 4)), np.zeros((1, law.history_size)), dt=0.0)
    assert history[0, 0] == 0.0


def test_a_wrong_number_of_parameters_is_refused() -> None:
    function = _core.YieldFunction.hill1948((0.5, 0.5, 0.5, 1.5, 1.5, 1.5))
    with pytest.raises(ValueError, match="parameters"):
        _core.PlaneLaw(1e5, 0.3, function, _core.HardeningLaw.norton_hoff, [1.0, 2.0])
    with pytest.raises(ValueError, match="parameters"):
        _core.VonMises(1e5, 0.3, _core.HardeningLaw.norton_hoff, [*PARAMETERS["norton_hoff"], *WINDOW])
