# SPDX-License-Identifier: Apache-2.0
"""Bodies that nothing holds any more rest where they are, in the plane, in space and as sheets, and the run says so.

Outside truth: a body without forces on it does not move as a whole, so its centre of volume stays; one that shrinks by
e has its ends at e times their distance from there.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from presswork import build_model
from presswork.case import Case, StampingCase
from presswork.case.space.schema import SpaceCase
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.loose_bodies import warn_of_loose
from presswork.outcome import GaveUpError
from presswork.process.begin import choose

STEEL: dict[str, Any] = {
    "young": 206000.0,
    "poisson": 0.3,
    "hardening": {"law": "swift", "K": 700.0, "e0": 0.01, "n": 0.2},
}
ROUGH: dict[str, Any] = {"contact": "shear", "m": 0.3}


def pressed(**changes: Any) -> dict[str, Any]:
    """A bar on its middle plane, pressed by a tool that drags it along x, and left by it."""
    return {
        "title": "a bar that is left",
        "analysis": "plane_strain",
        "workpiece": {"material": "steel", "mesh": {"size": [20.0, 5.0], "cells": [8, 3]}},
        "materials": {"steel": STEEL},
        "boundary": {"middle": {"set": "bottom", "fix": ["y"]}},
        "tools": {"punch": {"profile": [[-30, 5], [60, 5]], **ROUGH}},
        "stages": [
            {"name": "press", "tools": {"punch": {"move": [0.3, -0.4]}}},
            {"name": "lift", "tools": {"punch": {"move": [3.0, 5.0]}}},
        ],
        "solver": {"initial_increment": 0.1, "max_increment": 0.1},
    } | changes


def run(case: Any) -> tuple[ImplicitProcedure, list[np.ndarray]]:
    """Return the procedure at the end, and where the nodes were at the end of each stage."""
    procedure = ImplicitProcedure(build_model(case), threads=1)
    ends = []
    for report in procedure.advance():
        if report.fraction == 1.0:
            ends.append(procedure.model.mesh.points + procedure.state.nodes.moved)
    return procedure, ends


def test_a_bar_that_its_tool_has_left_rests_where_it_is() -> None:
    procedure, (dragged, left) = run(Case.model_validate(pressed()))
    assert dragged[:, 0].mean() - 10.0 > 0.1, "the tool has dragged it along"
    assert left[:, 0].mean() == pytest.approx(dragged[:, 0].mean(), abs=5e-3)
    (warning,) = warn_of_loose(procedure.model, procedure.state)
    assert warning.startswith("nothing holds the workpiece in x in stage 'lift': it rests where it is")


def test_a_hot_bar_that_nothing_holds_shrinks_about_its_centre() -> None:
    expansion, start, end = 1.2e-5, 800.0, 20.0
    steel = {"density": "7850 kg/m^3", "hardening": {"law": "linear", "yield_stress": 5000.0, "modulus": 0.0}}
    laws = {
        "thermal": {"conductivity": 30.0, "specific_heat": "600 J/(kg*K)"},
        "expansion": {"coefficient": expansion},
    }
    case = pressed(
        materials={"steel": {**STEEL, **steel, **laws}},
        heat={
            "initial_temperature": start,
            "surroundings": {"ambient": end, "coefficient": "50 kW/(m^2*K)"},
        },
        stages=[
            {"name": "touch", "duration": 1e-4, "tools": {"punch": {"move": [0, -0.001]}}},
            {"name": "lift", "duration": 1e-4, "tools": {"punch": {"move": [0, 1]}}},
            {"name": "cool", "duration": 300.0},
        ],
        boundary={"middle": {"set": "bottom", "fix": ["y"]}},
    )
    _, ends = run(Case.model_validate(case))
    along = ends[-1][:, 0]
    # plane strain: the strain across the plane is prevented, which the others make up for by Poisson's ratio
    shrunk = 10.0 * expansion * (start - end) * (1.0 + 0.3)
    assert along.min() + along.max() == pytest.approx(20.0, abs=1e-6)
    assert along.min() == pytest.approx(shrunk, rel=0.02)


def test_a_hot_bar_that_shrinks_off_a_sloping_tool_does_not_slide_along_it() -> None:
    """A strip in a rolling pause: to stay in touch it would go on by its shrinkage over the slope, 0.4 mm."""
    expansion, slope = 1.2e-5, 0.15
    steel = {"density": "7850 kg/m^3", "hardening": {"law": "linear", "yield_stress": 5000.0, "modulus": 0.0}}
    laws = {
        "thermal": {"conductivity": 3000.0, "specific_heat": "600 J/(kg*K)"},
        "expansion": {"coefficient": expansion},
    }
    case = pressed(
        materials={"steel": {**STEEL, **steel, **laws}},
        heat={"initial_temperature": 800.0, "surroundings": {"ambient": 20.0, "coefficient": "50 kW/(m^2*K)"}},
        tools={"roll": {"profile": [[-30, 5 + 50 * slope], [60, 5 - 40 * slope]], "contact": "frictionless"}},
        boundary={
            "middle": {"set": "bottom", "fix": ["y"]},
            "stop": {"set": "left", "fix": ["x"], "stages": ["press"]},
        },
        stages=[
            {"name": "press", "duration": 1e-4, "tools": {"roll": {"move": [0, -0.01]}}},
            {"name": "release", "duration": 1e-4},
            {"name": "pause", "duration": 300.0},
        ],
    )
    procedure, (_, released, cooled) = run(Case.model_validate(case))
    shrunk = 5.0 * expansion * 780.0 * 1.3
    assert cooled[:, 1].max() == pytest.approx(released[:, 1].max() - shrunk, abs=2e-3)
    assert cooled[:, 0].mean() == pytest.approx(released[:, 0].mean(), abs=1e-5)
    (warning,) = warn_of_loose(procedure.model, procedure.state)
    assert warning.startswith("nothing holds the workpiece in x in stage 'pause': it rests where it is")


def test_a_sheet_that_its_punch_has_left_rests_on_the_die() -> None:
    """It would follow the punch by 6 mm; its own recovery is that of a drawn dish, some hundredths."""
    steel = {**STEEL, "density": "7850 kg/m^3"}
    tools = {
        "punch": {"kind": "punch", "shape": "round", "diameter": 20, "edge_radius": 5},
        "die": {"kind": "die", "shape": "round", "diameter": 24, "edge_radius": 5, "mu": 0.05},
    }
    case = StampingCase.model_validate(
        {
            "title": "a dish that is left",
            "analysis": "stamping",
            "procedure": "implicit",
            "blank": {
                "shape": "circle", "diameter": 40, "thickness": 1, "element_size": 5, "material": "steel",
                "symmetry": ["x", "y"],
            },
            "materials": {"steel": steel},
            "tools": tools,
            "stages": [
                {"name": "draw", "tools": {"punch": {"stroke": 2.0}}},
                {"name": "lift", "tools": {"punch": {"stroke": -6.0}}},
            ],
            "implicit": {"max_increment": 0.1},
        }
    )  # fmt: skip
    recording = choose(build_model(case), 1)
    height = [
        recording.procedure.state.nodes.displacement[:, 2].mean()
        for report in recording.advance()
        if report.fraction == 1.0
    ]
    assert height[1] == pytest.approx(height[0], abs=0.1)


def test_a_body_on_another_rests_while_the_other_is_pressed_on() -> None:
    """The upper bar is pressed onto the lower one, and its tool leaves it: it rests in x, and on the lower one in y."""
    case = pressed(
        bodies={"upper": {"material": "steel", "mesh": {"origin": [5.0, 5.0], "size": [10.0, 4.0], "cells": [5, 2]}}},
        contacts={"between": {"between": ["workpiece", "upper"], "contact": "frictionless"}},
        tools={"punch": {"profile": [[-30, 9], [60, 9]], **ROUGH}},
        boundary={"middle": {"set": "bottom", "fix": ["x", "y"]}},
    )
    case["stages"][0] = {"name": "press", "tools": {"punch": {"move": [0.0, -0.05]}}}
    procedure, (pressed_at, left) = run(Case.model_validate(case))
    upper = procedure.model.bodies[1].points
    moved = left[upper.start : upper.stop] - pressed_at[upper.start : upper.stop]
    assert np.abs(moved.mean(axis=0)).max() < 0.02
    (warning,) = warn_of_loose(procedure.model, procedure.state)
    assert warning.startswith("nothing holds the body 'upper' in x")


def block(**changes: Any) -> SpaceCase:
    """A block pressed on its middle plane by a tool that drags it along, and leaves it."""
    return SpaceCase.model_validate(
        {
            "title": "a block that is left",
            "analysis": "solid",
            "workpiece": {"material": "steel", "mesh": {"size": [6.0, 4.0, 3.0], "cells": [3, 2, 2]}},
            "materials": {"steel": STEEL},
            "boundary": {"middle": {"set": "back", "fix": ["z"]}},
            "tools": {"punch": {"shape": "plane", "normal": [0, 0, -1], "position": [0, 0, 3], **ROUGH}},
            "stages": [
                {"name": "press", "tools": {"punch": {"move": [0.1, 0.0, -0.2]}}},
                {"name": "lift", "tools": {"punch": {"move": [1.0, 1.0, 3.0]}}},
            ],
            "solver": {"initial_increment": 0.1, "max_increment": 0.1},
        }
        | changes
    )


def test_a_block_that_its_tool_has_left_rests_where_it_is() -> None:
    procedure, (dragged, left) = run(block())
    assert dragged[:, 0].mean() - 3.0 > 0.03, "the tool has dragged it along"
    np.testing.assert_allclose(left[:, :2].mean(axis=0), dragged[:, :2].mean(axis=0), atol=5e-3)
    (warning,) = warn_of_loose(procedure.model, procedure.state)
    assert warning.startswith("nothing holds the workpiece in x and y and rotation about z in stage 'lift'")


def test_a_load_on_a_body_that_nothing_holds_ends_the_run_with_the_reason() -> None:
    case = pressed()
    case["stages"].append({"name": "pull", "force": [{"set": "right", "value": [100.0, 0.0]}]})
    with pytest.raises(GaveUpError, match="loads push the workpiece, and nothing holds it"):
        run(Case.model_validate(case))


def test_a_body_that_something_holds_is_not_loose() -> None:
    procedure, _ = run(Case.model_validate(pressed(boundary={"middle": {"set": "bottom", "fix": ["x", "y"]}})))
    assert warn_of_loose(procedure.model, procedure.state) == []
