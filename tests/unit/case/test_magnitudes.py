# SPDX-License-Identifier: Apache-2.0
"""What no metal, no machine and no file can bear is refused by key, by every procedure alike."""

from __future__ import annotations

import copy
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from presswork.case import Case, CaseError, build_model, read_case
from presswork.case.onestep.schema import OneStepCase
from presswork.case.shell.schema import ShellCase
from presswork.case.stamping.schema import StampingCase
from presswork.case.units import LENGTH, unit_factor
from tests.unit.case.round_cup import CUP

STEEL = {"young": 206e3, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 200, "modulus": 500}}
SHELL = {
    "title": "strip",
    "analysis": "shell",
    "workpiece": {
        "material": "steel",
        "element": "shell4_mitc_plus",
        "section": {"thickness": 1},
        "mesh": {"size": [10, 10], "cells": [1, 1]},
    },
    "boundary": {"grip": {"set": "left", "hold": "clamped"}},
    "stages": [{"name": "pull", "force": [{"set": "right", "value": [1, 0, 0]}]}],
}
SOLID = {
    "title": "billet",
    "analysis": "plane_strain",
    "workpiece": {"material": "steel", "element": "quad4_fbar", "mesh": {"size": [10, 15], "cells": [2, 3]}},
    "tools": {"punch": {"profile": [[-5, 15], [30, 15]], "contact": "sticking"}},
    "boundary": {"floor": {"set": "bottom", "fix": ["y"]}, "axis": {"set": "left", "fix": ["x"]}},
    "stages": [{"name": "upset", "tools": {"punch": {"stroke": 5, "direction": [0, -1]}}}],
}
IMPACT = {
    **SOLID,
    "procedure": "explicit",
    "workpiece": {**SOLID["workpiece"], "element": "quad4_1pt"},  # type: ignore[dict-item]
    "tools": {"punch": {"profile": [[-5, 15], [30, 15]], "contact": "frictionless"}},
    "stages": [{"name": "upset", "duration": 1e-4, "tools": {"punch": {"stroke": 5, "direction": [0, -1]}}}],
}
ONESTEP = {"title": "part", "analysis": "onestep", "part": {"path": "x.stl"},
           "blank": {"material": "steel", "thickness": 1}}  # fmt: skip
KINDS: dict[str, Callable[[dict[str, Any]], object]] = {
    "implicit solid": lambda steel: Case(**SOLID, materials={"steel": steel}),
    "explicit solid": lambda steel: Case(**IMPACT, materials={"steel": {**steel, "density": 7.85e-9}}),
    "shell": lambda steel: ShellCase(**SHELL, materials={"steel": steel}),
    "stamping": lambda steel: StampingCase(**{**CUP, "materials": {"steel": steel}}),
    "one step": lambda steel: OneStepCase(**ONESTEP, materials={"steel": steel}),
}
NO_METAL = {
    "young 210": ({"young": 210}, "Young's modulus is 210 MPa, that of no metal"),
    "young 1e-30": ({"young": 1e-30}, "that of no metal"),
    "young 2.1e11": ({"young": 2.1e11}, "Young's modulus is 2.1e+11 MPa"),
    "yield 1e30": ({"hardening": {"law": "linear", "yield_stress": 1e30}}, "expected a stress up to 1e+15"),
    "yield 1e12": ({"hardening": {"law": "linear", "yield_stress": 1e12}}, "the flow stress at a plastic strain"),
    "yield in GPa": ({"hardening": {"law": "linear", "yield_stress": 0.7}}, "the flow stress at a plastic strain"),
    "steep": ({"hardening": {"law": "linear", "yield_stress": 200, "modulus": 1e6}}, "more than Young's modulus"),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("slip", NO_METAL)
def test_every_procedure_refuses_what_no_metal_bears(kind: str, slip: str) -> None:
    change, said = NO_METAL[slip]
    KINDS[kind](STEEL)
    with pytest.raises(CaseError, match=r"materials\.steel") as raised:
        KINDS[kind](STEEL | change)
    assert said in str(raised.value)


@pytest.mark.parametrize("kind", ["implicit solid", "shell"])
def test_academic_magnitudes_are_taken_when_asked_for(kind: str) -> None:
    KINDS[kind](STEEL | {"young": 1.0, "magnitudes": "any"})


@pytest.mark.parametrize(
    ("stroke", "said"),
    [
        (16, "after 14.98 of its 16 mm the tool meets nodes that are held against it"),
        (15, "no metal fits between"),
        (1e30, "expected a length up to 1e+06 mm"),
    ],
)
def test_stroke_beyond_the_billet_is_refused(stroke: float, said: str) -> None:
    case = {**SOLID, "materials": {"steel": STEEL}}
    case["stages"] = [{"name": "upset", "tools": {"punch": {"stroke": stroke, "direction": [0, -1]}}}]
    with pytest.raises(CaseError, match=r"stages\.0\.tools\.punch") as raised:
        build_model(Case(**case))
    assert said in str(raised.value)
    case["stages"] = [{"name": "upset", "tools": {"punch": {"stroke": 14.9, "direction": [0, -1]}}}]
    build_model(Case(**case))


def test_a_held_node_that_a_tool_passes_beside_is_no_obstacle() -> None:
    """The punch beside the billet goes down by more than the billet's height, and the floor's nodes lie in no tool."""
    case = {**SOLID, "materials": {"steel": STEEL}}
    case["tools"] = {
        "punch": {"profile": [[-5, 15], [30, 15]], "contact": "sticking"},
        "ram": {"profile": [[20, 30], [20, 15.5], [30, 15.5]], "contact": "sticking"},
    }
    case["stages"] = [
        {
            "name": "upset",
            "tools": {
                "punch": {"stroke": 5, "direction": [0, -1]},
                "ram": {"stroke": 25, "direction": [0, -1]},
            },
        }
    ]
    build_model(Case(**case))


def test_a_punch_may_go_deeper_than_it_is_wide() -> None:
    """Nodes of the symmetry plane lie nearer to the side of the punch then, and gave way to its face before."""
    case = {**SOLID, "materials": {"steel": STEEL}}
    case["tools"] = {"punch": {"profile": [[3, 50], [3, 15], [0, 15]], "contact": "sticking"}}
    case["stages"] = [{"name": "pierce", "tools": {"punch": {"stroke": 8, "direction": [0, -1]}}}]
    build_model(Case(**case))


@pytest.mark.parametrize(
    "name", ["a/b", "../x", ".", "", " ", "a\0b", "a\nb", "x" * 300, "a:b", ".hidden", "a,b", "\ud800"]
)
def test_names_that_no_file_can_have_are_refused(name: str) -> None:
    stage = {"name": name, "tools": {"punch": {"stroke": 5, "direction": [0, -1]}}}
    with pytest.raises(CaseError, match=r"stages\.0\.name.*(the|this) name"):
        Case(**{**SOLID, "materials": {"steel": STEEL}, "stages": [stage]})
    with pytest.raises(CaseError, match=r"tools\..*(the|this) name"):
        Case(**{**SOLID, "materials": {"steel": STEEL}, "tools": {name: SOLID["tools"]["punch"]}})  # type: ignore[index]
    cup = copy.deepcopy(CUP)
    cup["tools"][name] = cup["tools"].pop("punch")
    cup["stages"][0]["tools"][name] = cup["stages"][0]["tools"].pop("punch")
    with pytest.raises(CaseError, match=r"(the|this) name"):
        StampingCase(**cup)


def test_title_is_a_line_of_text() -> None:
    with pytest.raises(CaseError, match=r"the title has U\+0000"):
        Case(**{**SOLID, "materials": {"steel": STEEL}, "title": "a\0b"})


@pytest.mark.parametrize(
    "unit", ["10**10**10*mm", "mm**9**9", "9**9**9", "mm" * 40, "mm;mm", "__import__", "mm^99", "(" * 50 + "mm", "2 mm"]
)
def test_units_are_names_and_small_powers_alone(unit: str) -> None:
    with pytest.raises(ValueError, match="unknown unit"):
        unit_factor(unit, LENGTH)


@pytest.mark.parametrize(("unit", "factor"), [("m", 1e3), ("mm²/mm", 1.0), ("1/(1/mm)", 1.0), ("mm^2/mm", 1.0)])
def test_usual_writings_of_units_are_taken(unit: str, factor: float) -> None:
    assert unit_factor(unit, LENGTH) == pytest.approx(factor)


def test_a_pipe_or_a_device_is_no_case_file(tmp_path: Path) -> None:
    pipe = tmp_path / "case.toml"
    os.mkfifo(pipe)
    for path in (pipe, Path("/dev/zero")):
        with pytest.raises(CaseError, match="a pipe or a device"):
            read_case(path)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a = " + "[" * 500 + "]" * 500, "nested more than"),
        (".".join("a" * 500) + " = 1", "nested more than"),
        ("a = " + "9" * 5000, "not valid TOML"),
        ("depth = 1" + "0" * 400, "a whole number of 1329 bits"),
    ],
)
def test_what_no_case_has_is_refused(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "case.toml"
    path.write_text(f'{text}\nanalysis = "plane_strain"\n')
    with pytest.raises(CaseError, match=said):
        read_case(path)


@pytest.mark.parametrize("key", ["stages.²", "stages.٣", "stages.-1", "stages.99999999999999999999"])
def test_an_index_of_a_list_is_written_in_digits(tmp_path: Path, key: str) -> None:
    path = tmp_path / "case.toml"
    path.write_text('analysis = "plane_strain"\n[[stages]]\nname = "a"\n')
    with pytest.raises(CaseError, match="is not an index from 0 to 0"):
        read_case(path, [f"{key}=1"])
