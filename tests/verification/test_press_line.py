# SPDX-License-Identifier: Apache-2.0
"""Operations in a row against themselves: nothing done changes nothing, two are as one, explicit is as implicit."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import Result
from tests.regression.whole_runs import run_stamping

STEEL = {
    "young": 206e3,
    "poisson": 0.3,
    "density": "7850 kg/m^3",
    "hardening": {"law": "swift", "K": 565, "e0": 0.0071, "n": 0.26},
}
DRAW = {
    "name": "draw",
    "tools": {
        "punch": {"kind": "punch", "shape": "round", "diameter": 20, "edge_radius": 5},
        "die": {"kind": "die", "shape": "round", "diameter": 23, "edge_radius": 5},
        "holder": {"kind": "holder", "shape": "round", "diameter": 23, "edge_radius": 1},
    },
    "stages": [{"name": "form", "tools": {"punch": {"stroke": 8}, "holder": {"force": 4000}}}],
    "springback": {},
}
REDRAW = {
    "name": "redraw",
    "tools": {
        "punch": {"kind": "punch", "shape": "round", "diameter": 13, "edge_radius": 4},
        "die": {"kind": "die", "shape": "round", "diameter": 16, "edge_radius": 4},
        "sleeve": {"kind": "holder", "shape": "ring", "inner_diameter": 14, "outer_diameter": 18, "outer_radius": 1.5},
    },
    "stages": [{"name": "form", "tools": {"punch": {"stroke": 4}, "sleeve": {"force": 1500}}}],
    "springback": {},
}


def line(folder: Path, *operations: dict[str, Any], blank: dict[str, Any] | None = None, **changes: Any) -> Result:
    data = {
        "title": "a small cup",
        "analysis": "stamping",
        "blank": {"shape": "circle", "diameter": 46, "thickness": 1.0, "element_size": 2.0, "material": "steel",
                  "symmetry": ["x", "y"], **(blank or {})},
        "materials": {"steel": STEEL},
        "operations": copy.deepcopy(operations),
        "output": {"rows": 100, "steps": 1},
    }  # fmt: skip
    return run_stamping(data, folder, **changes)


def distance(one: Result, other: Result, step: int, step_of_other: int) -> float:
    return float(np.linalg.norm(one.points(step) - other.points(step_of_other), axis=1).max())


def thinner(one: Result, other: Result, step: int, step_of_other: int) -> float:
    return float(np.abs(one.field("thickness", step) - other.field("thickness", step_of_other)).max())


def measure_volume(result: Result, step: int) -> float:
    points, cells = result.points(step), result.mesh_at(step).blocks[0].connectivity
    a, b, c, d = (points[cells[:, i]] for i in range(4))
    return float((0.5 * np.linalg.norm(np.cross(c - a, d - b), axis=1) * result.field("thickness", step)).sum())


def test_an_operation_that_does_nothing_changes_nothing(tmp_path) -> None:
    """What moves by 2 um is the springback of implicit shells, seen by explicit ones; nothing flows."""
    idle = {"name": "idle", "stages": [{"name": "wait", "duration": "0.2 ms"}], "springback": {}}
    run = line(tmp_path / "out", DRAW, idle, explicit={"damping": 2e4})
    drawn = 2
    for step in range(drawn + 1, len(run.times)):
        assert distance(run, run, drawn, step) < 3e-3
        assert thinner(run, run, drawn, step) < 5e-5
        strain = [run.field("equivalent_plastic_strain", each) for each in (drawn, step)]
        np.testing.assert_array_equal(strain[0], strain[1])


def test_two_operations_with_the_same_tools_are_as_one(tmp_path) -> None:
    """Left behind are velocities of the sheet, which are small as the tools stand."""
    half = copy.deepcopy(DRAW)
    half["stages"][0]["tools"]["punch"]["stroke"] = 4
    whole = copy.deepcopy(half)
    whole["stages"].append({**half["stages"][0], "name": "further"})
    one = line(tmp_path / "one", whole)
    stands = {"punch": 0.5 - 4, "die": -0.5, "holder": 0.5 - float(one.history["draw_holder.stroke"][99])}
    again = {**copy.deepcopy(half), "name": "again"}
    for name, height in stands.items():
        again["tools"][name]["position"] = [0, 0, height]
    del half["springback"]
    two = line(tmp_path / "two", half, again)
    for step in (-2, -1):
        assert distance(one, two, step, step) < 4e-3
        assert thinner(one, two, step, step) < 2e-3
    forces = [float(two.history["again_punch.force"].max()), float(one.history["draw_punch.force"].max())]
    assert forces[0] == pytest.approx(forces[1], rel=1e-3)


@pytest.mark.validation
def test_redraw_keeps_the_volume_and_is_alike_by_explicit_and_implicit_procedure(tmp_path) -> None:
    """Draw-in within 0.05 mm, thickness within 0.006 of 1 mm, force within 3 %; volumes within 1e-3 of the blank's.

    Implicit shells have no stress across their thickness, so explicit ones do without it, too (ironing).
    """
    fine = {"element_size": 1.25}
    alike = {"element": "shell4_mitc_plus", "ironing": False}
    explicit = line(tmp_path / "explicit", DRAW, REDRAW, blank=fine, explicit=alike)
    implicit = line(tmp_path / "implicit", DRAW, REDRAW, blank=fine, procedure="implicit")
    for step in range(1, len(explicit.times)):
        rims = [np.linalg.norm(run.points(step)[:, :2], axis=1).max() for run in (explicit, implicit)]
        assert rims[0] == pytest.approx(rims[1], abs=0.05)
        assert distance(explicit, implicit, step, step) < 0.04
        assert thinner(explicit, implicit, step, step) < 0.006
        for run in (explicit, implicit):
            assert measure_volume(run, step) == pytest.approx(measure_volume(run, 0), rel=1e-3)
    for name in ("draw_punch.force", "redraw_punch.force"):
        assert explicit.history[name].max() == pytest.approx(implicit.history[name].max(), rel=0.03)


def test_reverse_redraw_turns_the_cup_inside_out_and_keeps_its_volume(tmp_path) -> None:
    reverse = {
        "name": "reverse",
        "place": {"over": "x"},
        "tools": {
            "punch": {"kind": "punch", "shape": "round", "diameter": 11, "edge_radius": 3},
            "die": {"kind": "die", "shape": "ring", "inner_diameter": 13.6, "outer_diameter": 20.4, "inner_radius": 1.7,
                    "outer_radius": 1.7},
            "holder": {"kind": "holder", "shape": "ring", "inner_diameter": 13.6, "outer_diameter": 28,
                       "inner_radius": 1},
        },
        "stages": [{"name": "form", "tools": {"punch": {"stroke": 4}, "holder": {"force": 1500}}}],
        "springback": {},
    }  # fmt: skip
    run = line(tmp_path / "out", DRAW, reverse)
    middle = int(np.argmin(np.linalg.norm(run.mesh.points, axis=1)))
    heights = [float(run.points(step)[middle, 2]) for step in (2, 3, -1)]
    assert heights[1] == pytest.approx(-heights[0], abs=1e-12)
    assert heights[2] < heights[1] - 3.9
    assert float(run.points(-1)[:, 2].max()) - heights[2] > 2.5  # a wall stands round the bottom, the other way
    assert measure_volume(run, -1) == pytest.approx(measure_volume(run, 0), rel=1e-3)
