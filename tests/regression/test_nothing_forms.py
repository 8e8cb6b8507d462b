# SPDX-License-Identifier: Apache-2.0
"""Runs in which nothing is formed say so first, in every family; runs that mean something do not."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from presswork.case import Case, CaseError, build_model, read_case
from presswork.case.space.schema import SpaceCase
from presswork.case.stamping.schema import StampingCase
from presswork.examples import copy_example
from presswork.recorder import run_model
from tests.unit.case.test_resistance import AXIS, DOWN, MIDDLE, STEEL, flat, line, plane_case, space_case

QUICK = {"solver": {"initial_increment": 0.5, "max_increment": 0.5}, "output": {"steps": 1}}
SHORT = {"output": {"steps": 1, "rows": 2}, "limits": {"stop": False}}
MESH = {"size": [10, 12, 15], "cells": [1, 1, 1]}
SIDES = {"x0": {"set": "left", "fix": ["x"]}, "y0": {"set": "bottom", "fix": ["y"]}}
NEVER = {"law": "linear", "yield_stress": 1e6, "modulus": 1.0}
ELASTIC = {"young": 200e3, "poisson": 0.3, "magnitudes": "any", "hardening": NEVER}


def run(case: Case | SpaceCase | StampingCase, folder: Path) -> dict[str, Any]:
    """Return the summary of a run that ends."""
    assert run_model(build_model(case), folder, threads=1).status == "completed"
    found: dict[str, Any] = json.loads((folder / "summary.json").read_text("utf-8"))
    return found


def in_plane(kind: str) -> Case:
    dynamic = {"procedure": "explicit", "stages": [{"name": "press", "duration": 2e-4}]} if kind == "explicit" else {}
    options = SHORT if dynamic else QUICK | {"limits": {"stop": False}}
    slow = {"punch": {"stroke": 0.01, "direction": [0, -1]}} if dynamic else DOWN
    return plane_case({"punch": line(15)}, AXIS, slow, **options, **dynamic)


def in_space(kind: str) -> SpaceCase:
    dynamic = {"procedure": "explicit", "stages": [{"name": "press", "duration": 2e-4}]} if kind == "explicit" else {}
    options = SHORT if dynamic else QUICK | {"limits": {"stop": False}}
    slow = {"punch": {"stroke": 0.01 if dynamic else 5, "direction": [0, 0, -1]}}
    return space_case(MESH, {"punch": flat(15, -1)}, SIDES, slow, **options, **dynamic)


@pytest.mark.parametrize("kind", ["implicit", "explicit"])
def test_a_workpiece_that_rides_along_is_the_first_line_in_the_plane(kind: str, tmp_path: Path) -> None:
    found = run(in_plane(kind), tmp_path / "out")
    assert found["verdict"].startswith("nothing was formed: ")
    assert found["warnings"][0] == found["verdict"]


@pytest.mark.parametrize("kind", ["implicit", "explicit"])
def test_a_workpiece_that_rides_along_is_the_first_line_in_space(kind: str, tmp_path: Path) -> None:
    found = run(in_space(kind), tmp_path / "out")
    assert found["warnings"][0] == found["verdict"]
    assert found["verdict"].startswith("nothing was formed: ")


@pytest.mark.parametrize("procedure", ["implicit", "explicit"])
def test_a_stamping_whose_sheet_stays_elastic_says_so_first(procedure: str, tmp_path: Path) -> None:
    tool = {"shape": "round", "edge_radius": 5, "mu": 0.1}
    case = StampingCase.model_validate(
        {
            "title": "t",
            "analysis": "stamping",
            "procedure": procedure,
            "blank": {
                "shape": "circle", "diameter": 100, "thickness": 1, "material": "steel", "element_size": 12,
                "symmetry": ["x", "y"],
            },
            "materials": {"steel": STEEL},
            "tools": {
                "punch": tool | {"kind": "punch", "diameter": 50},
                "die": tool | {"kind": "die", "diameter": 53},
            },
            "boundary": {"rim": {"set": "edge", "fix": ["z"]}},
            "stages": [{"name": "draw", "tools": {"punch": {"stroke": 1e-3}}}],
            "output": {"steps": 1, "rows": 1},
            "implicit": {"initial_increment": 1, "max_increment": 1},
        }
    )  # fmt: skip
    found = run(case, tmp_path / "out")
    assert found["verdict"].startswith("nothing was formed: ")
    assert found["warnings"][0] == found["verdict"]


@pytest.mark.parametrize("name", ["formed", "elastic"])
def test_a_run_that_forms_or_is_meant_to_stay_elastic_has_no_verdict(name: str, tmp_path: Path) -> None:
    materials = {"materials": {"steel": ELASTIC}} if name == "elastic" else {}
    stroke = {"punch": {"stroke": 0.1, "direction": [0, -1]}}
    found = run(plane_case({"punch": line(15)}, AXIS | MIDDLE, stroke, **QUICK, **materials), tmp_path / "out")
    assert found["verdict"] == ""
    assert found["warnings"] == []


def test_a_run_that_gives_up_before_its_first_row_has_no_verdict(tmp_path: Path) -> None:
    """Equilibrium within 1e-15 is not found; increments that do not reach the billet are not tried."""
    stroke = {"punch": {"stroke": 0.1, "direction": [0, -1]}}
    strict = {"solver": {"force_tolerance": 1e-15, "max_iterations": 5, "min_increment": 0.02}}
    done = run_model(build_model(plane_case({"punch": line(15)}, AXIS | MIDDLE, stroke, **strict)), tmp_path / "out")
    assert done.status == "gave_up"
    assert done.result.summary["warnings"] == []


def roll_strip(folder: Path, mu: float, **more: str) -> list[str]:
    """Return the warnings of the packaged rolling with a coefficient of friction, on a coarse mesh."""
    keys = {"workpiece.mesh.cells": "[60, 3]", "solver.max_increment": "0.1", "solver.initial_increment": "0.1"}
    keys |= {"tools.roll.mu": f"{mu}"} | more
    case = read_case(copy_example("strip_rolling", folder), [f"{key}={value}" for key, value in keys.items()])
    run_model(build_model(case), folder / "out", threads=1)
    found: list[str] = json.loads((folder / "out" / "summary.json").read_text("utf-8"))["warnings"]
    return found


@pytest.mark.validation
def test_rolls_that_do_not_bite_are_named_and_rolls_that_do_are_not(tmp_path: Path) -> None:
    """A bite of acos(1 - 0.4 / 100) = 5.1 degrees draws the strip in from a coefficient of tan 5.1 = 0.09 on."""
    for mu in (0.0, 0.06):
        slips = roll_strip(tmp_path / f"slips_{mu}", mu)
        assert any("the tool roll turned by 18 degrees in the stage 'roll', and the work" in text for text in slips)
    assert not [text for text in roll_strip(tmp_path / "bites", 0.3) if "stood still" in text]


SLAB = """
title = "rolling of a slab in space, 2 mm wide"
analysis = "solid"
[workpiece]
material = "steel"
mesh = {size = [30, 2, 2], cells = [30, 1, 3], origin = [-39, 0, 0]}
[materials.steel]
young = 200e3
poisson = 0.3
density = 7.85e-9
hardening = {law = "swift", K = 600, e0 = 0.02, n = 0.15}
[tools.roll]
shape = "straight"
contact = "coulomb"
mu = 0.3
profile = [
    [0, 1.6],
    {to = [0, 201.6], centre = [0, 101.6], turn = "left"},
    {to = [0, 1.6], centre = [0, 101.6], turn = "left"},
]
[tools.pusher]
shape = "plane"
normal = [1, 0, 0]
position = [-39, 0, 0]
contact = "frictionless"
[boundary]
middle = {set = "back", fix = ["z"]}
plane_strain = {set = "all", fix = ["y"]}
[[stages]]
name = "bite"
tools.roll = {turn = -1.5}
tools.pusher = {move = [2.7, 0, 0]}
[[stages]]
name = "roll"
tools.roll = {turn = -6}
[output]
steps = 1
"""
STOOD = "the tool roll turned by 6 degrees in the stage 'roll', and the workpiece stood still"


def roll_slab(folder: Path, mu: float, *changes: str, way: int = -1) -> list[str]:
    """Return the warnings of a slab that a roll draws in along x; way: -1, or 1, by which it pushes it back."""
    path = folder / "slab.toml"
    folder.mkdir()
    path.write_text(SLAB, "utf-8")
    keys = [f"tools.roll.mu={mu}", f"stages.0.tools.roll.turn={1.5 * way}", f"stages.1.tools.roll.turn={6 * way}"]
    run_model(build_model(read_case(path, [*keys, *changes])), folder / "out", threads=1)
    found: list[str] = json.loads((folder / "out" / "summary.json").read_text("utf-8"))["warnings"]
    return [text for text in found if text.startswith(STOOD)]


@pytest.mark.validation
def test_rolls_that_do_not_bite_or_turn_the_wrong_way_are_named_in_space(tmp_path: Path) -> None:
    """A rolled slab moves by 6 degrees of a radius of 100 mm, 10 mm; the back of one that does not is on the pusher."""
    keys = ["solver.max_increment=0.1"]
    assert roll_slab(tmp_path / "slips", 0.0, *keys)
    assert roll_slab(tmp_path / "wrong way", 0.3, *keys, way=1)
    assert not roll_slab(tmp_path / "bites", 0.3, *keys)


@pytest.mark.validation
def test_rolls_that_do_not_bite_are_named_in_explicit_space(tmp_path: Path) -> None:
    keys = ["procedure=explicit", "workpiece.mesh.cells=[15, 1, 2]"]
    keys += ["stages.0.duration=0.5 ms", "stages.1.duration=2 ms"]
    assert roll_slab(tmp_path / "slips", 0.0, *keys)
    assert not roll_slab(tmp_path / "bites", 0.3, *keys)


def test_explicit_rolls_in_the_plane_are_refused(tmp_path: Path) -> None:
    """So none can slip there."""
    keys = ["procedure=explicit", "stages.0.duration=1 ms", "stages.1.duration=1 ms"]
    with pytest.raises(CaseError, match=r"stages\.1\.tools\.roll\.turn.*a tool can be moved only"):
        build_model(read_case(copy_example("strip_rolling", tmp_path), keys))


def test_an_impact_that_stays_elastic_says_so_first(tmp_path: Path) -> None:
    """A bar at 0.3 m/s: the wave's stress is density times its speed (5.1 km/s) times 0.3 m/s, 12 MPa."""
    keys = ["workpiece.velocity=[0, -300]", "workpiece.mesh.cells=[4, 16]"]
    model = build_model(read_case(copy_example("taylor_bar", tmp_path), keys))
    run_model(model, tmp_path / "out", threads=1)
    found = json.loads((tmp_path / "out" / "summary.json").read_text("utf-8"))
    assert found["warnings"][0].startswith("nothing was formed: nothing of the workpiece has yielded")
