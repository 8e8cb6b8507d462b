# SPDX-License-Identifier: Apache-2.0
"""What a wall bears and how far a round cup draws: closed forms, and the grades of the library."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from presswork.case import build_model
from presswork.case.description.stamping import describe_stamping
from presswork.case.material.yield_function import Hill1948, Yld2000
from presswork.case.stamping.schema import StampingCase
from presswork.law.elastic_plastic import make_yield_function
from presswork.law.wall import (
    Cup,
    Strengths,
    find_draw_force,
    find_drawing_ratio,
    find_flow_stress,
    find_strengths,
    find_wall_force,
)
from presswork.material import find_sheet
from presswork.model import Hardening, Material
from presswork.observe.wall_load import warn_of_wall_load
from tests.unit.case.round_cup import CUP, changed

SWIFT = Material("steel", 206e3, 0.3, Hardening("swift", (500.0, 1e-6, 0.2)))


@pytest.mark.parametrize("r", [0.6, 1.0, 2.0])
def test_strengths_of_hills_normal_anisotropy(r: float) -> None:
    function = make_yield_function(Hill1948(law="hill1948", r00=r, r45=r, r90=r).to_model())
    found = find_strengths(function)
    assert found.wall == pytest.approx((1 + r) / math.sqrt(1 + 2 * r), rel=1e-3)
    assert found.flange == pytest.approx(math.sqrt(2 * (1 + r) / (1 + 2 * r)), rel=1e-3)


def test_a_wall_of_a_power_law_bears_the_force_of_its_neck() -> None:
    """K w^(1+n) n^n exp(-n), at a strain of n."""
    found = find_wall_force(Strengths(1.2, 1.1), lambda p: 500.0 * p**0.2)
    assert found == pytest.approx(500.0 * 1.2**1.2 * 0.2**0.2 * math.exp(-0.2), rel=1e-4)


def test_the_pull_of_a_flange_that_does_not_harden_is_the_logarithm_of_the_ratio() -> None:
    cup = Cup(mu=0.0, holder_pressure=0.0, die_radius=1e9)
    found = find_draw_force(Strengths(1.0, 1.15), lambda p: np.full_like(p, 300.0), 2.0, cup)
    assert found == pytest.approx(1.15 * 300.0 * math.log(2.0), rel=1e-3)


def test_friction_holder_and_sharp_dies_lower_the_ratio() -> None:
    usual = find_drawing_ratio(SWIFT)
    for cup in (Cup(mu=0.15), Cup(holder_pressure=6.0), Cup(die_radius=3.0)):
        assert find_drawing_ratio(SWIFT, cup) < usual - 0.02


def test_dc04_draws_as_far_as_in_practice_and_not_as_far_as_by_hill() -> None:
    """2.0 to 2.2 in practice; Hill's function of the same r-values draws to more."""
    sheet = find_sheet("dc04").material
    assert isinstance(sheet.yield_function, Yld2000)
    hill = replace(sheet.to_model("dc04"), yield_function=sheet.yield_function.find_hill().to_model())
    assert 2.0 < find_drawing_ratio(sheet.to_model("dc04")) < 2.2
    assert find_drawing_ratio(hill) > 2.25


def test_a_force_near_what_the_wall_bears_warns() -> None:
    model = build_model(StampingCase.model_validate(changed(CUP)))
    _, material = model.sheet
    strengths = find_strengths(make_yield_function(material.yield_function))
    bears = math.pi * 50.0 * 0.8 * find_wall_force(strengths, find_flow_stress(material))

    def warn(*parts: float) -> list[str]:
        return warn_of_wall_load(model, {"punch.force_z": bears * np.array(parts)})

    (text,) = warn(0.1, 0.95, 0.95, 0.5)
    assert text.startswith("punch: its largest force,")
    assert "95 % of what the wall bears" in text
    assert not warn(0.1, 0.5, 0.8, 0.5)
    assert not warn(0.1, 0.5, 0.95, 0.5), "one peak alone"
    assert not warn(0.1, 1.5, 1.5, 1.5), "pressed between punch and die"


def test_check_tells_the_drawing_ratio_beside_what_the_wall_bears() -> None:
    small, large = (
        "\n".join(describe_stamping(build_model(StampingCase.model_validate(changed(CUP, ("blank.diameter", d))))))
        for d in (80, 125)
    )
    assert "drawing ratio: 1.6" in small
    assert "what the wall bears if the cup is drawn through" not in small
    assert "what the wall bears if the cup is drawn through" in large


def test_check_says_what_a_yield_function_makes_of_other_directions() -> None:
    grade = {"young": "206 GPa", "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 200, "modulus": 1000}}
    texts = []
    for function in ({}, {"law": "hill1948"}):
        table = {**grade, "yield_function": {**function, "r00": 1.7, "r45": 1.3, "r90": 1.9}}
        case = StampingCase.model_validate(changed(CUP, ("materials.steel", table)))
        texts.append("\n".join(describe_stamping(build_model(case))))
    assert "yld2000 (yield stress at 45, 90 degrees and biaxial equal to that at 0)" in texts[0]
    assert "hill1948 (yield stress at 45, 90 degrees and biaxial 1.11, 1.02 and 1.19 of that at 0" in texts[1]
    assert "take yld2000 with r00, r45, r90" in texts[1]
