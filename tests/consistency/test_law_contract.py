# SPDX-License-Identifier: Apache-2.0
"""The closed forms are the general law where that is von Mises, and a law turns with its point."""

from __future__ import annotations

import numpy as np
import pytest

from presswork import _core
from presswork.law.at_rest import history_at_rest
from presswork.law.history import AXES, EQPS, list_history

YOUNG, POISSON = 200e3, 0.3
MISES = _core.YieldFunction.hill1948([0.5, 0.5, 0.5, 1.5, 1.5, 1.5])
HILL = _core.YieldFunction.hill1948([0.28, 0.36, 0.64, 1.5, 1.7, 1.29])
SWIFT = (_core.HardeningLaw.swift, [565.0, 0.007, 0.26])
THERMAL = {"start": 100.0, "reference": 20.0, "melting": 1520.0, "exponent": 1.1, "heating": 0.25}
LAWS = {4: _core.PlaneLaw, 6: _core.SolidLaw}


def strains(n: int, components: int, size: float, seed: int = 1) -> np.ndarray:
    return size * np.random.default_rng(seed).standard_normal((n, components))


@pytest.mark.parametrize("components", [4, 6])
def test_the_closed_form_of_von_mises_is_the_general_law(components) -> None:
    plain = _core.VonMises(YOUNG, POISSON, *SWIFT)
    general = LAWS[components](YOUNG, POISSON, MISES, *SWIFT)
    stress, eqps, history = np.zeros((50, components)), np.zeros(50), np.zeros((50, 1))
    for seed in range(4):
        change = strains(50, components, 0.01, seed)
        end, history, _, tangent, failed = general.update(change, stress, history)
        assert not failed.any()
        stress, eqps, matrix = plain.update(change, stress, eqps)
        np.testing.assert_allclose(end, stress, atol=1e-6)
        np.testing.assert_allclose(history[:, 0], eqps, rtol=1e-8)
        np.testing.assert_allclose(tangent, matrix, atol=1e-6 * YOUNG)


@pytest.mark.parametrize(
    ("rate", "parameters"),
    [
        ("none", {}),
        ("cowper_symonds", {"D": 40.0, "q": 5.0}),
        ("johnson_cook", {"C": 0.02, "reference_rate": 1e-3}),
        ("logarithmic", {"C": 0.02, "reference_rate": 1e-3}),
    ],
)
def test_the_closed_form_with_rate_and_heat_is_the_general_law(rate, parameters) -> None:
    """Both solve stress, rate and temperature of the end at once; the closed form's hardening is from a table."""
    plain = _core.VonMises(YOUNG, POISSON, *SWIFT)
    closed = _core.AdiabaticMises(plain, rate=_core.RateLaw[rate], rate_parameters=parameters, **THERMAL)
    general = _core.PlaneLaw(
        YOUNG, POISSON, MISES, *SWIFT, rate=_core.RateLaw[rate], rate_parameters=parameters,
        thermal=_core.Thermal(**THERMAL),
    )  # fmt: skip
    stress, eqps, rise, history = np.zeros((50, 4)), np.zeros(50), np.zeros(50), np.zeros((50, 2))
    for seed in range(4):
        change = strains(50, 4, 0.01, seed)
        end, history, _, _, failed = general.update(change, stress, history, dt=0.02)
        assert not failed.any()
        stress, eqps, rise = closed.update(change, 0.02, stress, eqps, rise)
        np.testing.assert_allclose(end, stress, atol=1e-4)
        np.testing.assert_allclose(history, np.column_stack([eqps, rise]), rtol=1e-6)
    assert rise.min() > 1.0


@pytest.mark.parametrize("components", [4, 6])
@pytest.mark.parametrize("yields", [MISES, HILL], ids=["von_mises", "hill1948"])
def test_tangent_with_everything_is_the_derivative(yields, components) -> None:
    law = LAWS[components](
        YOUNG, POISSON, yields, *SWIFT, rate=_core.RateLaw.cowper_symonds, rate_parameters={"D": 40.0, "q": 5.0},
        chaboche=_core.Chaboche([8000.0, 900.0], [60.0, 0.0]), thermal=_core.Thermal(**THERMAL),
        young_saturated=180e3, young_rate=30.0,
    )  # fmt: skip
    stress, history = np.zeros((60, components)), np.zeros((60, law.history_size))
    for seed in range(2):
        stress, history, *_ = law.update(strains(60, components, 0.01, seed), stress, history, dt=0.02)
    change = strains(60, components, 0.01, 5)
    tangent = law.update(change, stress, history, dt=0.02)[3]
    np.testing.assert_allclose(tangent, law.differentiate(change, stress, history, dt=0.02), atol=1e-8 * YOUNG)


def evaluate(law, points, increment, history, element="quad4"):
    """One cell over an increment; return its nodal forces (4, 2) and what its law keeps."""
    width, q = _core.pack_width, 4
    force, after, fault = np.zeros((1, 8, width)), np.zeros_like(history), _core.LawFault()
    stress, eqps = np.zeros((1, q, 4)), np.zeros((1, q))
    failed = _core.evaluate_block(
        element, np.arange(4, dtype=np.int32)[None], points, increment, law, _core.PointSettings(),
        axisymmetric=False, depth=1.0, hourglass_fraction=0.05, stress_n=np.zeros((1, q, 4)), eqps_n=np.zeros((1, q)),
        hourglass_n=np.zeros((1, 2)), stress=stress, eqps=eqps, hourglass=np.zeros((1, 2)), volume=np.zeros((1, q)),
        force=force, stiffness=None, history_n=history, history=after, when=_core.UmatPlace(), fault=fault,
    )  # fmt: skip
    assert failed == -1
    assert fault.status == _core.LawStatus.done
    return force[0, :, 0].reshape(4, 2), after


def test_an_anisotropic_solid_turns_with_its_axes() -> None:
    """Cell, axes and increment turned by an angle give turned forces; the same increment with other axes does not."""
    law = _core.PlaneLaw(YOUNG, POISSON, HILL, *SWIFT, chaboche=_core.Chaboche([8000.0], [60.0]))
    points = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]) + 0.1 * np.random.default_rng(1).standard_normal((4, 2))
    increment = 0.05 * np.random.default_rng(2).standard_normal((4, 2))
    history = history_at_rest(law, (1, 4), 4)
    force, after = evaluate(law, points, increment, history)
    c, s = np.cos(0.7), np.sin(0.7)
    turn = np.array([[c, -s], [s, c]])
    turned = history.copy()
    axes = list_history(law, 4).without(EQPS)[AXES]
    turned[..., axes] = (c, s)
    other, turned_after = evaluate(law, points @ turn.T, increment @ turn.T, turned)
    np.testing.assert_allclose(other, force @ turn.T, atol=1e-8 * np.abs(force).max())
    np.testing.assert_allclose(turned_after[..., : axes.start], after[..., : axes.start], atol=1e-7)
    np.testing.assert_allclose(turned_after[..., axes], after[..., axes] @ turn.T, atol=1e-12)
    unturned, _ = evaluate(law, points @ turn.T, increment @ turn.T, history)
    assert np.abs(unturned - other).max() > 1e-4 * np.abs(force).max()


def test_a_turn_of_the_increment_turns_the_axes_along() -> None:
    law = _core.PlaneLaw(YOUNG, POISSON, HILL, *SWIFT)
    points = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    history = history_at_rest(law, (1, 4), 4)
    c, s = np.cos(0.5), np.sin(0.5)
    _, after = evaluate(law, points, points @ np.array([[c, s], [-s, c]]) - points, history)
    axes = list_history(law, 4).without(EQPS)[AXES]
    np.testing.assert_allclose(after[..., axes], np.broadcast_to((c, s), (1, 4, 2)), atol=1e-12)


@pytest.mark.parametrize("law", [{"rate": "johnson_cook", "rate_parameters": {"C": 0.0089, "reference_rate": 1.0}}, {}])
def test_the_general_law_returns_from_any_distance_in_short_steps(law) -> None:
    """Near first flow a step of 1e-9 s begins where the rate does not count yet, and ends where it does."""
    chosen = law | ({"rate": _core.RateLaw[law["rate"]]} if law else {})
    general = _core.SolidLaw(
        206.9e3,
        0.3,
        MISES,
        _core.HardeningLaw.ludwik,
        [806.0, 614.0, 0.168],
        thermal=_core.Thermal(**THERMAL),
        **chosen,
    )
    rng, n = np.random.default_rng(0), 40_000
    history = np.column_stack([rng.uniform(0.0, 1.5, n), rng.uniform(0.0, 200.0, n)])
    flow, _ = general.flow_stress(history[:, 0].copy(), None, 100.0 + history[:, 1])
    deviator = rng.standard_normal((n, 6))
    deviator[:, :3] -= deviator[:, :3].mean(axis=1, keepdims=True)
    size = np.sqrt(1.5 * (deviator[:, :3] ** 2).sum(axis=1) + 3.0 * (deviator[:, 3:] ** 2).sum(axis=1))
    near = 1.0 + 10.0 ** rng.uniform(-12, -1, n) * rng.choice([-1.0, 1.0], n)
    stress = deviator * (flow * near / size)[:, None]
    strain = 1e-4 * rng.standard_normal((n, 6)) * 10.0 ** rng.uniform(-6, 2, (n, 1))
    for dt in (1e-9, 1.6e-8, 1e-6):
        given = np.full(n, 100.0)
        *_, failed = general.update(strain, stress, history, dt=dt, temperature=given, tangent=False)
        assert not failed.any()
