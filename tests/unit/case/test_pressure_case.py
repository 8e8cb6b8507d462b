# SPDX-License-Identifier: Apache-2.0
"""Pressure on the sheet of a stamping: what a case builds, and what it refuses."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from presswork.case import CaseError, StampingCase, build_model, describe
from presswork.model import Model
from tests.problems.bulges import vary_bulge
from tests.problems.superplastic import make_dome
from tests.unit.case.round_cup import CUP, changed

OIL = {"oil": {"face": "top", "inside": {"shape": "circle", "diameter": 40}}}
DRAWN = changed(
    CUP,
    ("tools", {name: tool for name, tool in CUP["tools"].items() if name != "punch"}),
    ("pressure", OIL),
    ("stages", [{"name": "bulge", "duration": 0.01, "pressure": {"oil": {"p": 2.0}}}]),
)
"""A blank that is pressed from above through the openings of holder and die."""


def build(data: dict[str, Any]) -> Model:
    return build_model(StampingCase.model_validate(data))


def refuse(data: dict[str, Any]) -> str:
    with pytest.raises((CaseError, ValidationError)) as caught:
        build(data)
    return str(caught.value)


def test_a_pressure_goes_from_stage_to_stage() -> None:
    stages = [
        {"name": "fill", "duration": 0.01, "pressure": {"oil": {"p": "20 bar"}}},
        {"name": "hold", "duration": 0.01},
        {"name": "more", "duration": 0.02, "pressure": {"oil": {"p_over_time": [[0, 2], [0.01, 5], [0.02, 4]]}}},
    ]
    model = build(changed(DRAWN, ("stages", stages)))
    courses = [stage.pressure_course["oil"] for stage in model.stages]
    np.testing.assert_allclose(courses[0].rows, [[0, 0], [1, 2]])
    np.testing.assert_allclose(courses[1].rows, [[0, 2], [1, 2]])
    np.testing.assert_allclose(courses[2].rows, [[0, 2], [0.5, 5], [1, 4]])
    assert [course.over for course in courses] == ["way", "way", "time"]
    words = describe(model)
    for part in ("on the top face", "0 to 2 MPa", "stays 2 MPa", "2 to 4 MPa, at most 5 MPa"):
        assert part in words


def test_a_table_over_the_stroke_counts_what_moves_farthest() -> None:
    stage = {
        "name": "draw",
        "tools": {"die": {"stroke": 20}, "holder": {"force": 8000}},
        "pressure": {"oil": {"p_over_stroke": [[5, 0], [20, 3]]}},
    }
    course = build(changed(DRAWN, ("stages", [stage]))).stages[0].pressure_course["oil"]
    np.testing.assert_allclose(course.rows, [[0, 0], [0.25, 0], [1, 3]])
    assert course.over == "way"


PLACE, STAGE = "pressure.oil", "stages.0.pressure.oil"
REFUSED = {
    "pressure.oil.outside": (
        [(f"{PLACE}.outside", {"shape": "circle", "diameter": 60})],
        ("inside and outside are both given", "give one of them"),
    ),
    "pressure.oil.face": ([(f"{PLACE}.face", "upper")], ("upper", "top")),
    "stages.0.pressure.oil.p_over_time": (
        [(f"{STAGE}.p_over_time", [[0, 0], [0.01, 2]])],
        ("p and p_over_time are both given", "leave p_over_time out"),
    ),
    "stages.0.pressure.oil.p": ([(STAGE, {})], ("neither pressure nor inflow is given", "8 MPa")),
    "stages.0.pressure.oil.p: ": ([(f"{STAGE}.p", -1)], ("-1",)),
    "stages.0.pressure.oil.p_over_time: ": (
        [(STAGE, {"p_over_time": [[0.01, 2], [0.0, 0]]})],
        ("times of the table do not increase", "sort its rows"),
    ),
    "p_over_time = [[0.0, 0.0], [0.02, 2.0]]": (
        [(STAGE, {"p_over_time": [[0, 0], [0.02, 2]]})],
        ("beyond the end of the stage at 0.01 s", "lengthen the stage"),
    ),
    "p_over_time = [[0.0, 1.0], [0.01, 2.0]]": (
        [(STAGE, {"p_over_time": [[0, 1], [0.01, 2]]})],
        ("begins with 1 MPa, but the stage does with 0 MPa", "begin it with [0, 0]"),
    ),
    "p_over_time: expected": (
        [(STAGE, {"p_over_time": [[0, 0], [0.01, -2]]})],
        ("expected pressures >= 0", "the other face"),
    ),
    "p_over_time: the table": ([(STAGE, {"p_over_time": []})], ("is empty",)),
    "stages.0.pressure.oil.p_over_stroke": (
        [(STAGE, {"p_over_stroke": [[0, 0], [5, 2]]})],
        ("nothing moves by a stroke", "give p_over_time, or p"),
    ),
    "stages.0.pressure.gas": (
        [("stages.0.pressure", {"oil": {"p": 1}, "gas": {"p": 1}})],
        ("no such pressure", "oil"),
    ),
    "pressure.gas": (
        [("pressure", {**OIL, "gas": {"face": "top"}})],
        ("no stage sets its value", "stages.pressure.gas"),
    ),
    "pressure.gas: ": (
        [
            ("pressure", {**OIL, "gas": {"face": "top", "inside": {"shape": "circle", "diameter": 20}}}),
            ("stages.0.pressure", {"oil": {"p": 1}, "gas": {"p": 1}}),
        ],
        ("shells on the top face that oil pushes, too", "lines that do not overlap"),
    ),
    "pressure.oil.inside: the holder": (
        [(f"{PLACE}.inside.diameter", 70)],
        ("the holder holder lies on", "a line inside the opening of the holder"),
    ),
    'pressure.oil.face = "inside"': (
        [("pressure", {"oil": {"face": "inside"}})],
        ("the sheet is flat, which has no such face", "take top or bottom"),
    ),
    "pressure.oil.face: ": (
        [("pressure", {"oil": {"face": "bottom"}})],
        ("the die die lies on", "a line inside the opening of the die"),
    ),
    "pressure.oil.inside: the middle": (
        [(f"{PLACE}.inside", {"shape": "circle", "diameter": 0.5})],
        ("the middle of no shell lies there", "in mm"),
    ),
    "pressure.oil.inside: the line": (
        [(f"{PLACE}.inside", {"shape": "polygon", "points": [[0, 0], [1, 1], [1, 0], [0, 1]]})],
        ("crosses", "without"),
    ),
    "stages.0.pressure.oil.inflow": (
        [(STAGE, {"inflow": 100})],
        ("there is no fluid that could flow in", "pressure.oil.fluid"),
    ),
    "stages.0.pressure.oil.p: the": (
        [(f"{PLACE}.fluid", {"stiffness": 2000, "room": 1e5})],
        ("the pressure of a fluid with a volume is found", "give inflow"),
    ),
    "stages.0.pressure.oil: 2000 mm3": (
        [(f"{PLACE}.fluid", {"stiffness": 2000, "room": 1000}), (STAGE, {"inflow": -2000})],
        ("flow out of the room of 1000 mm3", "let less flow out"),
    ),
    "inflow_over_time = [[0.0, 5.0], [0.01, 9.0]]": (
        [(f"{PLACE}.fluid", {"stiffness": 2000, "room": 1000}), (STAGE, {"inflow_over_time": [[0, 5], [0.01, 9]]})],
        ("begins with 5 mm3, but the stage does with 0 mm3", "begin it with [0, 0]"),
    ),
    "pressure.oil.fluid.stiffness": (
        [(f"{PLACE}.fluid", {"stiffness": 0, "room": 1000}), (STAGE, {"inflow": 10})],
        ("expected a value > 0",),
    ),
    "pressure.oil.fluid.room": ([(f"{PLACE}.fluid", {"stiffness": 2000}), (STAGE, {"inflow": 10})], ("missing",)),
    "pressure.oil.fluid: ": (
        [
            ("tools", {}),
            ("pressure", {"oil": {"face": "top", "fluid": {"stiffness": 2000, "room": 1000}}}),
            (STAGE, {"inflow": 10}),
        ],
        ("its space is open", "boundary.clamp"),
    ),
    "stages.0.pressure.oil.p = 6000": ([(STAGE, {"p": 6000})], ("at most 1500 MPa", '"60 bar"')),
    "stages.0.pressure.oil.p_over_time: no press": (
        [(STAGE, {"p_over_time": [[0, 0], [0.01, 2000]]})],
        ("at most 1500 MPa", "plain numbers are MPa"),
    ),
    'stages.0.pressure.oil.inflow = "5 m^3"': (
        [(f"{PLACE}.fluid", {"stiffness": 2000, "room": 1000}), (STAGE, {"inflow": "5 m^3"})],
        ("5e+09 mm3 have flowed in", "if it became a sphere", '"20 cm^3"'),
    ),
    "explicit.device": ([("explicit", {"device": "host"})], ("by the CPU alone", 'take "cpu"')),
}


@pytest.mark.parametrize("key", REFUSED)
def test_a_wrong_pressure_is_refused_with_its_key_and_a_remedy(key: str) -> None:
    changes, parts = REFUSED[key]
    text = refuse(changed(DRAWN, *changes))
    for part in (key.split(":")[0].split(" = ")[0], *parts):
        assert part in text, text


TUBE = {"shape": "tube", "diameter": 60, "length": 40, "element_size": 6, "thickness": 2, "material": "steel"}


def test_a_tube_has_faces_inside_and_outside() -> None:
    tube = changed(DRAWN, ("blank", TUBE), ("tools", {}), ("pressure", {"oil": {"face": "inside"}}))
    model = build(tube)
    assert np.hypot(*model.mesh.points[:, 1:].T).max() == pytest.approx(29.0)
    text = refuse(changed(tube, ("pressure.oil.face", "top")))
    for part in ("pressure.oil.face", "the sheet is a tube, which has no such face", "take inside or outside"):
        assert part in text
    text = refuse(changed(tube, ("blank.thickness", 30)))
    assert "blank.thickness" in text
    assert "leaves no bore in a tube of 60 mm" in text


def test_inflow_adds_up_over_stages() -> None:
    fluid = {**OIL["oil"], "fluid": {"stiffness": "2 GPa", "room": "1 cm^3"}}
    stages = [
        {"name": "fill", "duration": 0.01, "pressure": {"oil": {"inflow": 300}}},
        {"name": "more", "duration": 0.02, "pressure": {"oil": {"inflow_over_time": [[0, 0], [0.01, 50]]}}},
    ]
    model = build(changed(DRAWN, ("pressure.oil", fluid), ("stages", stages)))
    np.testing.assert_allclose(model.stages[0].pressure_course["oil"].rows, [[0, 0], [1, 300]])
    np.testing.assert_allclose(model.stages[1].pressure_course["oil"].rows, [[0, 300], [0.5, 350]])
    assert "50 mm3 flow in, 350 since the start, into 1000 mm3 of room" in describe(model)


def test_a_stage_without_motion_needs_a_duration() -> None:
    text = refuse(changed(DRAWN, ("stages", [{"name": "bulge", "pressure": {"oil": {"p": 2.0}}}])))
    assert "or the stage a duration" in text


def test_pressure_is_refused_beside_what_does_not_know_it() -> None:
    gradients = {"by": ["materials.sheet.hardening.K"], "of": ["clamp.force_z"]}
    assert "runs with pressure have no derivatives" in refuse(vary_bulge(("gradients", gradients)))
    operation = {"name": "one", "stages": [{"name": "draw", "duration": 0.01}]}
    text = refuse({**{k: v for k, v in DRAWN.items() if k not in ("stages", "tools")}, "operations": [operation]})
    assert "pressure is not carried from one operation to the next" in text


def test_a_dwell_keeps_its_pressure() -> None:
    stages = [
        *DRAWN["stages"],
        {"name": "quench", "dwell": {"duration": 1.0, "place": "air"}, "pressure": {"oil": {"p": 1}}},
    ]
    assert "nothing moves in a dwell" in refuse(changed(DRAWN, ("stages", stages)))


GAS = {"rate": {"target": 1e-3, "least": 0.01, "most": 2.0}}
SWIFT = {"law": "swift", "K": 500, "e0": 0.01, "n": 0.2}
HOT = changed(
    make_dome(0.5, 7.0), ("stages", [{"name": "blow", "duration": 900, "pressure": {"oil": GAS}}])
)  # fmt: skip

COLD = {**HOT["materials"]["sheet"], "heating": None, "hardening": SWIFT}


def test_a_rate_is_held_until_another_stage_gives_one() -> None:
    more = {**GAS["rate"], "target": 5e-4, "of": "mean"}
    stages = [
        *HOT["stages"],
        {"name": "on", "duration": 60},
        {"name": "slow", "duration": 60, "pressure": {"oil": {"rate": more}}},
    ]
    model = build(changed(HOT, ("stages", stages)))
    held = [stage.pressure_course["oil"].held for stage in model.stages]
    assert held[0] == held[1]
    assert held[2] is not None
    assert (held[2].of, held[2].target) == ("mean", 5e-4)
    assert "holds the greatest strain rate at 0.001 1/s, between 0.01 and 2 MPa" in describe(model)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ([("procedure", "explicit")], ["stages.0.pressure.oil.rate", "implicit procedure alone"]),
        ([("stages.0.pressure.oil.rate.target", 100)], ["rate.target", "outside the window", "1e-08 to 1 1/s"]),
        ([("materials.sheet", COLD)], ["does not depend on the rate"]),
        ([("stages.0.pressure.oil.rate.least", 3)], ["rate.most", "not above least = 3"]),
        ([("stages.0.pressure.oil.rate.most", 20000)], ["no press gives so much"]),
        ([("pressure.oil.fluid", {"stiffness": 2000, "room": 1000})], ["of a fluid with a volume is found"]),
        ([("stages.1", {"name": "p", "duration": 1, "pressure": {"oil": {"p": 1}}})], ["only the run knows"]),
    ],
)  # fmt: skip
def test_rates_that_no_pressure_holds_are_refused(changes: list[tuple[str, object]], words: list[str]) -> None:
    case = HOT
    for path, value in changes:
        case = (
            changed(case, ("stages", [*case["stages"], value])) if path == "stages.1" else changed(case, (path, value))
        )
    text = refuse(case)
    for word in words:
        assert word in text


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ([("procedure", "explicit")], ["pressure.oil.seal", "implicit procedure alone"]),
        ([("pressure.oil", {"face": "top", "seal": "tools"})], ["pressure.oil.inside", "begins somewhere"]),
        ([("pressure.oil.fluid", {"stiffness": 2000, "room": 1000})], ["pressure.oil.seal", "taken to be tight"]),
    ],
)
def test_seals_that_are_not_found_are_refused(changes: list[tuple[str, object]], words: list[str]) -> None:
    sealed = changed(DRAWN, ("procedure", "implicit"), ("pressure.oil.seal", "tools"), *changes)
    text = refuse(sealed)
    for word in words:
        assert word in text


def test_a_seal_without_tools_is_refused() -> None:
    case = changed(
        HOT, ("pressure.oil", {"face": "bottom", "inside": {"shape": "circle", "diameter": 40}, "seal": "tools"})
    )
    assert "there are no tools that could seal it" in refuse(case)
