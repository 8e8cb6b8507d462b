# SPDX-License-Identifier: Apache-2.0
"""Presses in cases: what is taken, and what is refused with key, value and remedy."""

import math
from copy import deepcopy
from typing import Any

import pytest

from presswork.case import CaseError, build_model
from presswork.case.plane.schema import Case
from presswork.model import Blow, Crank, Model
from tests.unit.case.test_heat_case import change

MAXI = {"kind": "crank", "stroke": 200, "rpm": 60, "rod_ratio": 0.2}
CASE: dict[str, Any] = {
    "title": "presses",
    "analysis": "axisymmetric",
    "workpiece": {"material": "metal", "mesh": {"size": [20, 30], "cells": [2, 3]}},
    "materials": {
        "metal": {"young": 2e5, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 100, "modulus": 0}}
    },
    "boundary": {"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
    "tools": {"die": {"profile": [[0, 30], [60, 30]], "contact": "frictionless"}},
    "presses": {
        "hammer": {"kind": "hammer", "energy": 2, "velocity": "5 m/s", "efficiency": 0.8},
        "screw": {"kind": "screw", "energy": "40 kJ", "velocity": 700, "efficiency": 0.7},
        "maxi": MAXI,
        "slow": {"kind": "hydraulic", "velocity": [[0, 50], [5, 20]], "force": "5 MN", "power": 90},
    },
    "stages": [{"name": "forge", "press": "hammer", "tools": {"die": {"stroke": 12, "direction": [0, -1]}}}],
}


def build(key: str = "title", value: object = "presses") -> Model:
    """Build the Model of the case with one key changed."""
    return build_model(Case.model_validate(change(key, value, CASE)))


def test_a_symmetry_plane_across_the_ram_doubles_its_way_and_its_work() -> None:
    halved = build("stages.0.press", "maxi").stages[0].drive
    assert halved is not None
    assert (halved.travel, halved.whole) == (24.0, 2.0)
    whole = build_model(
        Case.model_validate(change("boundary.middle.symmetry", False, change("stages.0.press", "maxi", CASE)))
    )
    drive = whole.stages[0].drive
    assert drive is not None
    assert (drive.travel, drive.whole) == (12.0, 1.0)


def test_a_stage_s_velocity_is_that_of_the_tool() -> None:
    data = change("stages.0.press", None, change("stages.0.velocity", [[0, 60], [6, 30]], CASE))
    stage = build_model(Case.model_validate(data)).stages[0]
    assert stage.drive is not None
    assert stage.drive.travel == 12.0
    assert stage.duration == pytest.approx(math.log(2.0) * 6 / 30 + 6 / 30)


def test_a_crank_starts_where_the_stage_says() -> None:
    def start(press: object) -> float:
        drive = build("stages.0.press", press).stages[0].drive
        assert drive is not None
        assert isinstance(drive.motion, Crank)
        return drive.motion.start

    assert start("maxi") == 24.0, "without more it ends at bottom dead centre"
    assert start({"name": "maxi", "before_bottom": 30}) == 30.0
    rod = 500.0
    height = 100 + rod - 100 * math.cos(1.0) - math.sqrt(rod**2 - (100 * math.sin(1.0)) ** 2)
    assert start({"name": "maxi", "angle_before_bottom": "1 rad"}) == pytest.approx(height, rel=1e-12)


def test_several_blows_are_stages_with_pauses_between() -> None:
    stages = build("stages.0.press", {"name": "hammer", "blows": 3, "pause": 0.5}).stages
    assert [s.name for s in stages] == ["forge 1", "forge, pause 1", "forge 2", "forge, pause 2", "forge 3"]
    assert [s.tool_motion["die"].move[1] for s in stages] == [-12, 12, -12, 12, -12]
    assert [s.tool_motion["die"].start for s in stages] == [None, None, "touch_again", None, "touch_again"]
    assert [s.duration for s in stages[1::2]] == [0.5, 0.5]
    blows = [s.drive.motion for s in stages[::2] if s.drive is not None]
    assert [b.number for b in blows if isinstance(b, Blow)] == [1, 2, 3]


BAD = [
    ("presses.hammer.energy", -2, "presses.hammer.energy = -2: expected a value > 0"),
    ("presses.hammer.efficiency", 0, "presses.hammer.efficiency = 0.0: expected a value > 0"),
    ("presses.hammer.efficiency", None, "presses.hammer.efficiency: missing key"),
    ("presses.hammer.mass", 400, "expected two quantities, and found energy, velocity, mass"),
    ("presses.hammer.velocity", None, "expected two quantities, and found energy; give two of"),
    ("presses.hammer.height", 1000, "presses.hammer.height = 1000: velocity and height are both given"),
    ("presses.screw.mass", 400, "presses.screw.mass = 400: a screw press stores its energy in the flywheel"),
    ("presses.maxi.rpm", 0, "presses.maxi.rpm = 0.0: expected a value > 0"),
    ("presses.maxi.rod_ratio", 1, "presses.maxi.rod_ratio = 1.0: expected a value < 1"),
    ("presses.maxi.rated_angle", 20, "presses.maxi.rated_angle = 20: it is where the rated force begins, and there"),
    (
        "presses.maxi",
        {**MAXI, "force": 9e5, "rated_height": 100},
        "rated_height = 100: expected less",
    ),
    (
        "presses.maxi",
        {**MAXI, "force": 9e5, "rated_height": 6, "rated_angle": 30},
        "rated_angle and rated_height are both given",
    ),
    ("presses.hammer.force", 9e5, "presses.hammer.force = 900000.0: a hammer has no frame that bears its force"),
    ("presses.maxi.kind", "cam", "presses.maxi.kind"),
    ("presses.slow.velocity", 0, "presses.slow.velocity = 0: expected speeds > 0"),
    ("presses.slow.velocity", [[0, 50], [0, 20]], "expected travels that increase from 0"),
    ("presses.slow.velocity", [[1, 50]], "expected travels that increase from 0"),
    ("stages.0.press", "hamer", 'stages.0.press = "hamer": no such press; did you mean `hammer`?'),
    ("stages.0.duration", 1, "stages.0.duration: its time follows from press"),
    ("stages.0.velocity", 20, "stages.0.velocity: the press gives the speed"),
    ("stages.0.velocity", [[0, -20]], "expected speeds > 0"),
    ("stages.0.tools", {}, "stages.0.press: no tool moves in this stage"),
    ("stages.0.press", {"name": "maxi", "blows": 2}, "stages.0.press.blows: has no meaning for a press of kind crank"),
    ("stages.0.press", {"name": "hammer", "before_bottom": 9}, "has no meaning for a press of kind hammer"),
    ("stages.0.press", {"name": "hammer", "pause": 1}, "a single blow has no pause"),
    (
        "stages.0.press",
        {"name": "maxi", "before_bottom": 20},
        "stages.0.press.before_bottom: the ram turns round at bottom dead centre after 20 mm, its travel is 24 mm, "
        "twice the tool's for the mirror image",
    ),
    ("stages.0.press", {"name": "maxi", "before_bottom": 201}, "the stroke of the press is 200 mm, too short"),
    (
        "stages.0.press",
        {"name": "maxi", "angle_before_bottom": 10},
        "stages.0.press.angle_before_bottom: the ram turns round at bottom dead centre after 1.8",
    ),
    ("stages.0.press", {"name": "maxi", "before_bottom": 9, "angle_before_bottom": 9}, "are both given; give one"),
]


@pytest.mark.parametrize(("key", "value", "message"), BAD)
def test_bad_presses_are_refused_with_their_key(key: str, value: object, message: str) -> None:
    with pytest.raises(CaseError) as caught:
        build(key, value)
    assert message in str(caught.value)


def test_a_crank_shorter_than_the_way_asked_for_is_refused() -> None:
    data = change("presses.maxi.stroke", 20, change("stages.0.press", "maxi", CASE))
    with pytest.raises(CaseError) as caught:
        build_model(Case.model_validate(data))
    assert 'stages.0.press = "maxi": the stroke of the press is 20 mm, too short for a ram 24 mm' in str(caught.value)


def test_explicit_stages_take_one_blow_and_no_limits() -> None:
    data = change("materials.metal.density", 7.85e-9, change("procedure", "explicit", CASE))
    with pytest.raises(CaseError, match=r"stages\.0\.press\.blows = 2: in the explicit procedure a tool goes on"):
        build_model(Case.model_validate(change("stages.0.press", {"name": "hammer", "blows": 2}, data)))
    with pytest.raises(CaseError, match="the explicit procedure has no limits of force and power"):
        build_model(Case.model_validate(change("stages.0.press", "slow", data)))
    with pytest.raises(CaseError, match=r"stages\.0\.ramp = 1\.0: a ram neither starts nor stops smoothly"):
        build_model(Case.model_validate(change("stages.0.ramp", 1, change("stages.0.press", "maxi", data))))


def test_heat_needs_the_time_between_blows() -> None:
    data = deepcopy(CASE)
    data["stages"][0]["press"] = {"name": "hammer", "blows": 2}
    data["heat"] = {"initial_temperature": 1000}
    with pytest.raises(CaseError, match=r"stages\.0\.press\.pause: missing key: heat needs a duration"):
        build_model(Case.model_validate(data))
