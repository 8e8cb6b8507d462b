# SPDX-License-Identifier: Apache-2.0
"""Media that cool zones of a surface in forming: heat lost in a short time is h A (T - T_medium) t."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from presswork.case import Case, build_model
from presswork.case.space.schema import SpaceCase
from presswork.implicit.heat_of_forming import KINDS, HeatArrays
from presswork.implicit.stepping import ImplicitProcedure

START, MEDIUM, TIME, H = 500.0, 100.0, 1e-3, 2.0
STEEL = {
    "young": 200e3, "poisson": 0.3, "density": "7800 kg/m^3", "hardening": {"law": "linear", "yield_stress": 300.0},
    "thermal": {"conductivity": 25.0, "specific_heat": "650 J/(kg*K)"},
}  # fmt: skip
SIZE = {"plane_strain": [4.0, 3.0], "axisymmetric": [4.0, 3.0], "solid": [4.0, 3.0, 2.0]}
AREA = {
    "plane_strain": {"right": 3.0, "top": 4.0},
    "axisymmetric": {"right": 2 * np.pi * 4.0 * 3.0, "top": np.pi * 16.0},
    "solid": {"right": 6.0, "top": 8.0, "front": 12.0},
}


def lose(family: str, convection: list[dict[str, Any]], surroundings: dict[str, Any] | None = None) -> dict[str, float]:
    """Return the heat that convection has taken in TIME [N mm], as a gain."""
    n = len(SIZE[family])
    boundary = {"x": {"set": "left", "fix": ["x"]}, "y": {"set": "bottom", "fix": ["y"]}}
    data = {
        "title": "block",
        "analysis": family,
        "workpiece": {"material": "steel", "mesh": {"size": SIZE[family], "cells": [2] * n}},
        "materials": {"steel": STEEL},
        "boundary": boundary | ({"z": {"set": "back", "fix": ["z"]}} if n == 3 else {}),
        "heat": {"initial_temperature": START} | ({"surroundings": surroundings} if surroundings else {}),
        "stages": [{"name": "cool", "duration": TIME, "convection": convection}],
    }
    procedure = ImplicitProcedure(build_model((SpaceCase if n == 3 else Case).model_validate(data)))
    for _ in procedure.advance():
        pass
    return dict(zip(KINDS, procedure.state[HeatArrays].heat.tolist(), strict=True))


def medium(name: str, coefficient: object = H) -> dict[str, Any]:
    return {"set": name, "coefficient": coefficient, "ambient": MEDIUM}


@pytest.mark.parametrize("family", SIZE)
def test_a_zone_loses_heat_by_its_area(family: str) -> None:
    area = AREA[family]
    one = -H * (START - MEDIUM) * TIME
    assert lose(family, [medium("right")])["convection"] == pytest.approx(one * area["right"], rel=0.02)
    assert lose(family, [medium("boundary")])["convection"] == pytest.approx(one * sum(area.values()), rel=0.02)


@pytest.mark.parametrize("family", SIZE)
def test_the_later_zone_counts_and_surroundings_have_the_rest(family: str) -> None:
    area, one = AREA[family], -H * (START - MEDIUM) * TIME
    rest = sum(area.values()) - area["right"]
    twice = lose(family, [medium("boundary"), medium("right", 0.0)])
    assert twice["convection"] == pytest.approx(one * rest, rel=0.02)
    around = lose(family, [medium("right", 0.0)], {"ambient": MEDIUM, "coefficient": 0.1})
    assert around["convection"] == pytest.approx(0.1 / H * one * rest, rel=0.02)


def test_a_coefficient_is_that_of_the_surface_temperature() -> None:
    rows = [[MEDIUM, 0.1], [START - 100.0, 0.1], [START, H]]
    lost = lose("plane_strain", [medium("right", rows)])["convection"]
    assert lost == pytest.approx(-H * (START - MEDIUM) * TIME * 3.0, rel=0.03)
