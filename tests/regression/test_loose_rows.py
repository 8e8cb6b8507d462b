# SPDX-License-Identifier: Apache-2.0
"""Explicit forming: a body that its tools have left rests where it is; one with a velocity at the start flies on.

Outside truth: a part that is left at rest stays where it is but for its elastic recovery, which is at most the flow
stress over Young's modulus of its size. A body that is thrown goes on at its speed.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from presswork import build_model
from presswork.case import Case, StampingCase
from presswork.case.space.schema import SpaceCase
from presswork.process.begin import choose
from tests.regression.whole_runs import run_to_end

STEEL: dict[str, Any] = {
    "young": 206000.0,
    "poisson": 0.3,
    "density": "7850 kg/m^3",
    "hardening": {"law": "swift", "K": 700.0, "e0": 0.01, "n": 0.2},
}
RECOVERY = 600.0 / 206000.0
"""Largest flow stress over Young's modulus."""
COULOMB = {"contact": "coulomb", "mu": 0.1}
TIMES: dict[str, Any] = {"duration": "60 us", "ramp": "10 us"}


def bar(analysis: str, **changes: Any) -> Case:
    """A bar or a disc pressed between two plates, which leave it and wait."""
    return Case.model_validate(
        {
            "title": "a part that is left",
            "analysis": analysis,
            "procedure": "explicit",
            "workpiece": {"material": "steel", "element": "quad4_1pt", "mesh": {"size": [10.0, 5.0], "cells": [8, 4]}},
            "materials": {"steel": STEEL},
            "boundary": {"axis": {"set": "left", "fix": ["x"]}} if analysis == "axisymmetric" else {},
            "tools": {
                "punch": {"profile": [[-30, 5], [60, 5]], **COULOMB},
                "anvil": {"profile": [[60, 0], [-30, 0]], **COULOMB},
            },
            "stages": [
                {"name": "press", **TIMES, "tools": {"punch": {"move": [0.0, -0.5]}}},
                {"name": "lift", **TIMES, "tools": {"punch": {"move": [0.0, 3.0]}}},
                {"name": "wait", "duration": "100 us"},
            ],
            "output": {"rows": 40, "steps": 2},
        }
        | changes
    )


def block() -> SpaceCase:
    """A block pressed between two planes, which leave it and wait."""
    plane = {"shape": "plane", **COULOMB}
    return SpaceCase.model_validate(
        {
            "title": "a block that is left",
            "analysis": "solid",
            "procedure": "explicit",
            "workpiece": {
                "material": "steel",
                "element": "hex8_1pt",
                "mesh": {"size": [6.0, 4.0, 3.0], "cells": [4, 3, 3]},
            },
            "materials": {"steel": STEEL},
            "tools": {
                "punch": {**plane, "normal": [0, 0, -1], "position": [0, 0, 3]},
                "anvil": {**plane, "normal": [0, 0, 1], "position": [0, 0, 0]},
            },
            "stages": [
                {"name": "press", **TIMES, "tools": {"punch": {"move": [0.0, 0.0, -0.4]}}},
                {"name": "lift", **TIMES, "tools": {"punch": {"move": [0.0, 0.0, 3.0]}}},
                {"name": "wait", "duration": "100 us"},
            ],
            "output": {"rows": 40, "steps": 2},
        }
    )


def follow(case: Any) -> tuple[Any, dict[str, np.ndarray]]:
    """Return the procedure at the end, and where the centre of mass was at the end of each stage."""
    procedure, ends = choose(build_model(case), 1), {}
    for report in procedure.advance():
        if report.fraction == 1.0:
            ends[report.stage] = centre(procedure.solids)
    return procedure, ends


def centre(solids: Any) -> np.ndarray:
    return np.asarray(solids.mass @ solids.position / solids.mass.sum())


@pytest.mark.parametrize(
    ("case", "height"),
    [(bar("plane_strain"), 4.5), (bar("axisymmetric"), 4.5), (block(), 2.6)],
    ids=["plane", "axisymmetric", "space"],
)
def test_a_part_that_its_tools_have_left_rests_where_it_is(case: Any, height: float) -> None:
    procedure, ends = follow(case)
    risen = np.abs(ends["wait"] - ends["press"]).max()
    assert risen < 4.0 * RECOVERY * height, "it springs back, and its vibration pushes it off the anvil a little"
    (warning,) = procedure.loose.warn(procedure.model)
    assert warning.startswith("nothing holds the workpiece in ")
    assert "in stage 'lift': it came off its tools" in warning


def test_a_part_that_a_tool_pushes_to_another_is_held_at_the_end_of_the_stage() -> None:
    """It comes off the punch by bounces on its way to the anvil, 1 mm below, and is pressed by 0.5 mm there."""
    pushed = bar(
        "axisymmetric",
        tools={
            "punch": {"profile": [[-30, 5], [60, 5]], **COULOMB},
            "anvil": {"profile": [[60, -1], [-30, -1]], **COULOMB},
        },
        stages=[{"name": "press", "duration": "300 us", "ramp": "10 us", "tools": {"punch": {"move": [0.0, -1.5]}}}],
    )
    procedure, ends = follow(pushed)
    assert ends["press"][1] == pytest.approx(2.5 - 1.0 - 0.25, abs=0.05)
    assert procedure.loose.warn(procedure.model) == []


def test_a_thrown_part_flies_on_and_nothing_is_said() -> None:
    speed, duration = 10e3, 300e-6
    case = bar("plane_strain", tools={}, stages=[{"name": "fly", "duration": duration}])
    case = case.model_copy(update={"workpiece": case.workpiece.model_copy(update={"velocity": [speed, 0.0]})})
    procedure, ends = follow(case)
    assert ends["fly"][0] == pytest.approx(5.0 + speed * duration, rel=1e-9)
    assert procedure.loose is None


def test_a_sheet_that_its_tools_have_left_rests_where_it_is(tmp_path) -> None:
    stages = [
        {"name": "draw", "velocity": "5 m/s", "tools": {"punch": {"stroke": 4.0}}},
        {"name": "lift", "velocity": "5 m/s", "tools": {"punch": {"stroke": -4.0}}},
    ]
    case = StampingCase.model_validate(
        {
            "title": "a dish that is left",
            "analysis": "stamping",
            "blank": {
                "shape": "circle", "diameter": 40, "thickness": 1, "element_size": 4, "material": "steel",
                "symmetry": ["x", "y"],
            },
            "materials": {"steel": STEEL},
            "tools": {
                "punch": {"kind": "punch", "shape": "round", "diameter": 20, "edge_radius": 5},
                "die": {"kind": "die", "shape": "round", "diameter": 24, "edge_radius": 5, "mu": 0.05},
            },
            "stages": stages,
            "output": {"rows": 40, "steps": 2},
        }
    )  # fmt: skip
    result = run_to_end(build_model(case), tmp_path / "out")
    drawn, left = (result.field("displacement", step=step)[:, 2].mean() for step in (2, 4))
    assert abs(left - drawn) < 0.1, "0.8 mm if it flew on"
    warning = result.summary["warnings"][0]
    assert warning.startswith("nothing holds the blank in z in stage 'lift'")
