# SPDX-License-Identifier: Apache-2.0
"""Isothermal transformation by a table, its additivity, and martensite, against closed forms."""

import numpy as np
import pytest

from presswork.evolution.contract import PointChange
from presswork.evolution.kinetics import Kinetics
from presswork.evolution.phases import PhaseLaw
from presswork.evolution.time_tables import TimeTable
from presswork.model import FloatArray, Phase, PhaseMechanics, Transformation


def avrami_table(degrees: FloatArray) -> FloatArray:
    """Return the rows of X = 1 - exp(-(k t)^2), k = 0.02 exp(-((T - 600)/60)^2) [1/s]."""
    k = 0.02 * np.exp(-(((degrees - 600.0) / 60.0) ** 2))
    first, last = (np.sqrt(-np.log1p(-part)) / k for part in (0.01, 0.99))
    return np.column_stack([degrees, first, last, np.ones_like(degrees)])


def test_cooling_adds_up_as_scheils_integral() -> None:
    steel = Transformation(martensite_start=200.0, times={"bainite": avrami_table(np.arange(480.0, 721.0, 0.5))})
    kinetics, fractions, width = Kinetics(steel), np.zeros((4, 1)), 0.5
    for middle in np.arange(700.0 - 0.5 * width, 500.0, -width):
        fractions = kinetics.advance(fractions, np.array([middle]), width / 2.0)
    assert fractions[2, 0] == pytest.approx(0.66368, abs=2e-5)
    assert fractions[[0, 1, 3], 0].tolist() == [0.0, 0.0, 0.0]


def test_martensite_of_koistinen_and_marburger() -> None:
    fraction, _ = Kinetics(Transformation(martensite_start=410.0)).martensite(np.zeros((4, 1)), np.array([25.0]))
    assert fraction[0] == pytest.approx(0.98552, abs=5e-6)


def test_an_isothermal_step_is_exact_however_long() -> None:
    table = TimeTable(avrami_table(np.array([550.0, 600.0, 650.0])))
    at = np.array([600.0])
    once, often = table.advance(np.zeros(1), at, 40.0), np.zeros(1)
    for _ in range(100):
        often = table.advance(often, at, 0.4)
    assert once[0] == pytest.approx(1.0 - np.exp(-(0.8**2)), rel=1e-12)
    assert often == pytest.approx(once, rel=1e-9)


def test_no_more_forms_than_the_table_has_and_nothing_outside() -> None:
    rows = avrami_table(np.array([550.0, 600.0, 650.0]))
    rows[:, 3] = 0.4
    kinetics = Kinetics(Transformation(martensite_start=200.0, times={"ferrite": rows}))
    fractions = kinetics.advance(np.zeros((4, 3)), np.array([500.0, 600.0, 700.0]), 1e6)
    assert fractions[0] == pytest.approx([0.0, 0.4, 0.0])


def test_hardness_is_mixed_by_fractions() -> None:
    one = np.array([[0.0, 1e-5]])
    values = (200.0, 150.0, 250.0, 350.0, 640.0)
    mechanics = PhaseMechanics(tuple(Phase(expansion=one, hardness=value) for value in values))
    law = PhaseLaw(Transformation(martensite_start=410.0, mechanics=mechanics))
    assert "hardness" in {quantity.name for quantity in law.quantities}
    before = {quantity.name: np.zeros(1) for quantity in law.quantities}
    none = np.zeros(1)
    found = law.advance(before, PointChange(none, none, none, none, 1.0, np.array([800.0]), np.array([25.0])))
    assert found["hardness"][0] == pytest.approx(0.98552 * 640 + 0.01448 * 200, abs=0.01)
