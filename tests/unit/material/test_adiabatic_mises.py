# SPDX-License-Identifier: Apache-2.0
"""Rate, softening and adiabatic heating at a point, against closed forms and an integration by scipy."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from presswork import _core

YOUNG, POISSON = 206.9e3, 0.3
SHEAR = YOUNG / (2 * (1 + POISSON))
HEATING = 0.9 / (7.83e-9 * 4.6e8)  # [K/MPa]
RATES = {
    "johnson_cook": {"C": 0.0089, "reference_rate": 1.0},
    "logarithmic": {"C": 0.02, "reference_rate": 0.5},
    "cowper_symonds": {"D": 1e5, "q": 4.0},
}


def compress(law: _core.AdiabaticMises, rate: float, end: float, steps: int) -> tuple[float, float, float]:
    """Isochoric compression along y to strain `end` at a constant rate: effective stress, plastic strain, rise."""
    de = end / steps
    strain = np.array([[0.5 * de, -de, 0.5 * de, 0.0]])
    stress, eqps, rise = np.zeros((1, 4)), np.zeros(1), np.zeros(1)
    for _ in range(steps):
        stress, eqps, rise = law.update(strain, de / rate, stress, eqps, rise)
    return float(stress[0, 0] - stress[0, 1]), float(eqps[0]), float(rise[0])


def mises(a: float, b: float, n: float) -> _core.VonMises:
    return _core.VonMises(YOUNG, POISSON, _core.HardeningLaw.ludwik, [a, b, n])


def rate_of(law: str, factor: float) -> float:
    """Plastic strain rate at which a law has a factor above 1."""
    a, b = RATES[law].values()
    if law == "cowper_symonds":
        return float(a * (factor - 1) ** b)
    rise = np.exp(min((factor - 1) / a, 100.0))
    return float(b * (rise if law == "johnson_cook" else rise - 1))


def integrate(law: str, rate: float, end: float) -> tuple[float, float, float]:
    """The same by the rate equations: dq = 3G (de - dp), dT = k q dp, dp as the flow stress asks for."""
    A, B, n, m, start, melting = 806.0, 614.0, 0.168, 1.1, 20.0, 1540.0

    def rest(p: float, rise: float) -> float:
        share = min(max(rise / (melting - start), 0.0), 1.0)
        return (A + B * max(p, 0.0) ** n) * (1 - share**m)

    def plastic_rate(e: float, p: float, rise: float) -> float:
        q = 3 * SHEAR * (e - p)
        static = rest(p, rise)
        if q <= static:
            return 0.0
        return rate_of(law, q / static)

    def slope(t: float, y: np.ndarray) -> list[float]:
        p, rise = y
        r = plastic_rate(rate * t, p, rise)
        return [r, HEATING * 3 * SHEAR * (rate * t - p) * r]

    time = end / rate
    found = solve_ivp(
        slope, (0.0, time), [0.0, 0.0], method="LSODA", max_step=1e-3 * time, rtol=1e-8, atol=[1e-11, 1e-6]
    )
    p, rise = found.y[:, -1]
    return 3 * SHEAR * (end - p), p, rise


@pytest.mark.parametrize(
    ("law", "rate"),
    [
        ("johnson_cook", 1e5),
        ("logarithmic", 10.0),
        ("logarithmic", 1e5),
        ("cowper_symonds", 10.0),
        ("cowper_symonds", 1e5),
    ],
)
def test_adiabatic_compression_follows_the_rate_equations(law: str, rate: float) -> None:
    """Strain 1 in 2,000 steps: stress to 0.05 %, plastic strain to 1e-5, temperature to 0.3 % of scipy's solution."""
    mine = _core.AdiabaticMises(
        mises(806.0, 614.0, 0.168),
        rate=_core.RateLaw[law],
        rate_parameters=RATES[law],
        start=20.0,
        reference=20.0,
        melting=1540.0,
        exponent=1.1,
        heating=HEATING,
    )
    stress, strain, rise = compress(mine, rate, 1.0, 2000)
    exact = integrate(law, rate, 1.0)
    assert stress == pytest.approx(exact[0], rel=5e-4)
    assert strain == pytest.approx(exact[1], rel=1e-5)
    assert rise == pytest.approx(exact[2], rel=3e-3)


def test_linear_softening_gives_the_exponential_of_its_closed_form() -> None:
    """m = 1, no hardening, no rate: s = A exp(-k A p/D), rise D (1 - exp(-k A p/D)); first order in the step."""
    A, D = 800.0, 1500.0
    law = _core.AdiabaticMises(mises(A, 0.0, 1.0), melting=D, exponent=1.0, heating=HEATING)
    errors = []
    for steps in (1000, 2000):
        stress, p, rise = compress(law, 1.0, 2.0, steps)
        decay = np.exp(-HEATING * A * p / D)
        assert stress == pytest.approx(A * decay, rel=1e-3)
        assert rise == pytest.approx(D * (1 - decay), rel=1e-3)
        errors.append(abs(stress / (A * decay) - 1))
    assert errors[1] == pytest.approx(0.5 * errors[0], rel=0.1)


@pytest.mark.parametrize(
    ("plain", "within"),
    [
        (_core.VonMises(YOUNG, POISSON, _core.HardeningLaw.swift, [600.0, 0.01, 0.25]), 2e-8),
        (mises(300.0, 500.0, 0.3), 2e-6),  # infinite slope at the first yield: the table's first interval is a chord
    ],
    ids=["swift", "ludwik"],
)
def test_without_rate_and_heat_it_is_the_implicit_law(plain: _core.VonMises, within: float) -> None:
    """The same stress and plastic strain as VonMises by backward Euler, over a random path; hardening is from a table.

    within: of the flow stress.
    """
    law = _core.AdiabaticMises(plain)
    random = np.random.default_rng(5)
    stress, eqps, rise = np.zeros((50, 4)), np.zeros(50), np.zeros(50)
    other, other_eqps = stress, eqps
    for _ in range(20):
        strain = random.normal(0.0, 1e-3, (50, 4))
        stress, eqps, rise = law.update(strain, 1e-6, stress, eqps, rise)
        other, other_eqps, _ = plain.update(strain, other, other_eqps)
    np.testing.assert_allclose(stress, other, atol=400.0 * within)
    np.testing.assert_allclose(eqps, other_eqps, atol=400.0 * within / (3 * SHEAR), rtol=0)
    assert (eqps > 0.001).all()
    assert (rise == 0).all()


def test_heat_is_the_plastic_work() -> None:
    """With all of it turned to heat, density times capacity times rise is the integral of stress by plastic strain."""
    law = _core.AdiabaticMises(mises(806.0, 614.0, 0.168), heating=1.0 / (7.83e-9 * 4.6e8))
    stress, p, rise = compress(law, 1.0, 1.0, 4000)
    work = 806.0 * p + 614.0 * p**1.168 / 1.168
    assert 7.83e-9 * 4.6e8 * rise == pytest.approx(work, rel=2e-4)
    assert stress == pytest.approx(806.0 + 614.0 * p**0.168, rel=1e-8)  # the table's tolerance


def test_a_molten_point_bears_no_shear_and_stays_finite() -> None:
    """At the melting point the flow stress is zero."""
    law = _core.AdiabaticMises(
        mises(806.0, 614.0, 0.168), start=1540.0, reference=20.0, melting=1540.0, exponent=0.5, heating=HEATING
    )
    stress, p, rise = compress(law, 1e4, 0.1, 10)
    assert abs(stress) < 1e-6
    assert p == pytest.approx(0.1, rel=1e-9)
    assert np.isfinite(rise)
