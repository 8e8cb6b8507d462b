# SPDX-License-Identifier: Apache-2.0
"""Austenite on cooling: martensite, diffusion with additivity, hardness."""

import numpy as np
import pytest

from presswork.case.material.transformation import Transformation
from presswork.evolution.hardness import find_hardness
from presswork.evolution.kinetics import Kinetics
from presswork.model import Transformation as Steel


def boron_steel() -> Steel:
    return Transformation(steel="22MnB5").to_model()


def cool(steel: Steel, rate: float, start: float = 900.0, end: float = 20.0, width: float = 2.0) -> np.ndarray:
    """Return the fractions after cooling at a constant rate [K/s] in steps of `width` [K]."""
    kinetics, fractions, temperature = Kinetics(steel), np.zeros((4, 1)), start
    while temperature > end:
        temperature = max(temperature - width, end)
        now = np.array([temperature])
        fractions = kinetics.advance(fractions, now, width / rate)
        fractions[3] = kinetics.martensite(fractions, now)[0]
    return fractions[:, 0]


def test_martensite_at_room_temperature_is_that_of_koistinen_and_marburger() -> None:
    kinetics = Kinetics(Steel(martensite_start=410.0))
    fraction, slope = kinetics.martensite(np.zeros((4, 3)), np.array([500.0, 410.0, 20.0]))
    assert fraction == pytest.approx([0.0, 0.0, 0.98630], abs=5e-6)
    assert slope[2] == pytest.approx(-0.011 * (1 - 0.98630), rel=1e-3)


def test_martensite_stays_when_it_is_heated_again() -> None:
    kinetics = Kinetics(Steel(martensite_start=410.0))
    fractions = np.array([0.0, 0.0, 0.0, 0.5]).reshape(4, 1)
    assert kinetics.martensite(fractions, np.array([390.0]))[0] == pytest.approx([0.5])


def test_isothermal_diffusion_is_exact_in_one_step_as_in_many() -> None:
    kinetics, now = Kinetics(boron_steel()), np.array([500.0])
    once = kinetics.advance(np.zeros((4, 1)), now, 30.0)
    often = np.zeros((4, 1))
    for _ in range(300):
        often = kinetics.advance(often, now, 0.1)
    assert 0.2 < once[2, 0] < 0.95
    assert often == pytest.approx(once, abs=2e-5)


def test_time_to_half_bainite_follows_the_formula() -> None:
    """t = delay C exp(Q/RT) / (2^(0.29 G) (Bs - T)^2) S(0.5), S(0.5) = 1.0259 by quadrature."""
    steel = Steel(
        martensite_start=400.0, composition={"C": 0.2}, ferrite_start=800, pearlite_start=720, bainite_start=600
    )
    factor = np.exp(-10.23 + 10.18 * 0.2) / 2 ** (0.29 * 8.0)
    time = factor * np.exp(27500 / (1.987 * 773.15)) / 100.0**2 * 1.025899
    found = Kinetics(steel).advance(np.zeros((4, 1)), np.array([500.0]), time)
    assert found[2, 0] == pytest.approx(0.5, abs=1e-4)


@pytest.mark.parametrize("rate", [27.0, 30.0, 60.0, 200.0])
def test_22mnb5_is_martensite_from_its_critical_rate_on(rate) -> None:
    """27 K/s (Karbasian & Tekkaya 2010); fully martensite at 30 K/s (Zhang, Wan & Li 2015)."""
    fractions = cool(boron_steel(), rate)
    assert fractions[3] / fractions.sum() > 0.95
    assert 440 < find_hardness(boron_steel().composition, fractions, np.array(rate)) < 510


def test_22mnb5_cooled_slowly_is_bainite_with_ferrite() -> None:
    middle, slow = cool(boron_steel(), 5.0), cool(boron_steel(), 1.0)
    assert middle[2] > 0.5
    assert middle[0] < 0.05
    assert slow[0] > 0.2
    assert slow[2] > 0.4
    assert slow[3] < 0.05
    assert find_hardness(boron_steel().composition, slow, np.array(1.0)) < 230


def test_cooling_in_steps_converges() -> None:
    found = [cool(boron_steel(), 10.0, width=width)[2] for width in (8.0, 4.0, 2.0, 0.25)]
    errors = np.abs(np.array(found[:3]) - found[3])
    assert errors.max() < 0.003


def test_ferrite_leaves_the_carbon_to_pearlite() -> None:
    steel = Steel(
        martensite_start=400.0, composition={"C": 0.385}, ferrite_start=800, pearlite_start=720, bainite_start=550
    )
    found = cool(steel, 0.01)
    assert found[0] <= 0.5 + 1e-12
    assert found[:2].sum() == pytest.approx(1.0, abs=1e-3)


def test_without_a_composition_only_martensite_forms() -> None:
    found = cool(Steel(martensite_start=410.0), 0.1)
    assert found == pytest.approx([0.0, 0.0, 0.0, 0.98630], abs=5e-6)


def test_a_part_grows_smoothly_with_temperature() -> None:
    """No corner: central differences over 2e-6 and 2e-4 of the temperature agree, far below the bends of a table."""
    kinetics = Kinetics(boron_steel())
    begun = np.zeros((4, 400))
    begun[2] = np.geomspace(1e-4, 0.9, 400)

    def slope(apart: float) -> np.ndarray:
        more, less = (kinetics.advance(begun, np.full(400, 500.0 * (1.0 + way)), 0.5)[2] for way in (apart, -apart))
        return np.asarray((more - less) / (1000.0 * apart))

    np.testing.assert_allclose(slope(1e-6), slope(1e-4), rtol=2e-4, atol=1e-9)
