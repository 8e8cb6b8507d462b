# SPDX-License-Identifier: Apache-2.0
"""Laws that follow time take long increments in parts: against integrals over an even change of temperature."""

import numpy as np
import pytest
from scipy.integrate import quad

from presswork.evolution.contract import PointChange
from presswork.evolution.grain import GrainLaw
from presswork.evolution.in_parts import advance_in_parts
from presswork.evolution.kinetics import Kinetics
from presswork.evolution.phases import PhaseLaw
from presswork.model import Grain, GrainGrowth, PowerLaw, Recrystallisation, Transformation

GAS, DURATION, HOT, COLD = 8.314462618, 20.0, 1200.0, 900.0


def cool(start: float, end: float, dt: float) -> PointChange:
    """Return an increment in which nothing flows and a point cools evenly."""
    rest = np.zeros((1, 4))
    return PointChange(rest, rest, np.full(1, 0.3), np.full(1, 0.3), dt, np.array([start]), np.array([end]))


def kelvin(share: float) -> float:
    """Return the temperature at a share of the increment [K]."""
    return HOT + (COLD - HOT) * share + 273.15


def test_grains_grow_by_the_integral_of_their_rate() -> None:
    """d^m = d0^m + int A exp(-Q/(R T)) dt."""
    law = GrainLaw(Grain(initial=50.0, growth=GrainGrowth(A=1e23, exponent=7.0, energy=3e5)))
    values = {name: np.full(1, value) for name, value in law.at_rest().items()}
    found = advance_in_parts(law, values, cool(HOT, COLD, DURATION), 1e-3)["grain_size"][0]
    rise = DURATION * quad(lambda s: 1e23 * np.exp(-3e5 / (GAS * kelvin(s))), 0, 1)[0]
    exact = (50.0**7 + rise) ** (1 / 7)
    assert exact > 60.0
    assert found == pytest.approx(exact, rel=1e-3)


def test_metal_recrystallises_by_the_sum_of_its_times() -> None:
    """X = 1 - exp(-ln 2 (int dt/t05)^k) (Scheil 1935)."""
    half = PowerLaw(A=2e-10, energy=2.5e5)
    static = Recrystallisation(half_time=half, exponent=1.5, size=PowerLaw(A=20.0))
    law = GrainLaw(Grain(initial=50.0, static=static))
    values = {name: np.full(1, value) for name, value in law.at_rest().items()}
    values["grain_strain"], values["grain_rate"] = np.full(1, 0.3), np.full(1, 1.0)
    change = cool(HOT, COLD, 1.0)
    found = advance_in_parts(law, values, change, 1e-3)["recrystallised_fraction"][0]
    time = quad(lambda s: np.exp(-2.5e5 / (GAS * kelvin(s))) / 2e-10, 0, 1)[0]
    exact = 1 - np.exp(-np.log(2) * time**1.5)
    assert 0.2 < exact < 0.9
    assert found == pytest.approx(exact, abs=1e-3)
    assert abs(law.advance(values, change)["recrystallised_fraction"][0] - exact) > 0.02


def test_phases_follow_the_temperature_within_an_increment() -> None:
    """As in a thousand increments: one alone takes the temperature of its start for all of it."""
    steel = Transformation(
        martensite_start=400.0, composition={"C": 0.2, "Mn": 1.0, "Si": 0.3}, grain_size=7.0,
        ferrite_start=830.0, pearlite_start=720.0, bainite_start=550.0,
    )  # fmt: skip
    law, kinetics = PhaseLaw(steel), Kinetics(steel)
    values = {quantity.name: np.zeros(1) for quantity in law.quantities}
    found = advance_in_parts(law, values, cool(760.0, 640.0, 6.0), 1e-3)
    exact = kinetics.at_rest((1,))
    for k in range(1000):
        exact = kinetics.advance(exact, np.array([760.0 - 0.12 * (k + 0.5)]), 6e-3)
    assert float(exact[0, 0]) > 0.1
    assert found["ferrite"][0] == pytest.approx(float(exact[0, 0]), abs=0.01)
    assert abs(law.advance(values, cool(760.0, 640.0, 6.0))["ferrite"][0] - float(exact[0, 0])) > 0.02
