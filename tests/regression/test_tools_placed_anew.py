# SPDX-License-Identifier: Apache-2.0
"""Stages that place a tool anew: lifted, the workpiece springs back; brought to touch, it goes on where it was."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import CaseError, Result, build_model, run_model
from presswork.case import Case
from presswork.case.space.schema import SpaceCase
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.tool_arrays import SpaceToolArrays, ToolArrays
from presswork.view.all_plots import plot_all
from presswork.view.plots.operation_plot import list_operations, plot_operation
from presswork.view.style import describe_step
from tests.regression.whole_runs import run_in_two_parts

HEIGHT, STROKE, MORE = 10.0, 1.0, 0.4

BLOCK: dict[str, Any] = {
    "title": "block pressed twice",
    "analysis": "plane_strain",
    "workpiece": {"material": "steel", "mesh": {"kind": "rectangle", "size": [5.0, HEIGHT], "cells": [2, 4]}},
    "materials": {
        "steel": {
            "young": 200000.0,
            "poisson": 0.3,
            "hardening": {"law": "linear", "yield_stress": 300.0, "modulus": 500.0},
        }
    },
    "boundary": {"left": {"set": "left", "fix": ["x"]}, "floor": {"set": "bottom", "fix": ["y"]}},
    "tools": {
        "punch": {
            "contact": "frictionless",
            "mirrored": ["x"],
            "profile": [{"to": [8.0, HEIGHT]}, {"to": [-1.0, HEIGHT]}],
        }
    },
    "output": {"steps": 2},
}
PRESS = {"name": "press", "tools": {"punch": {"stroke": STROKE, "direction": [0, -1]}}}
LIFT = {"name": "lift", "tools": {"punch": {"position": [0.0, 3.0]}}}
AGAIN = {"name": "again", "tools": {"punch": {"position": "touch", "stroke": MORE, "direction": [0, -1]}}}


def case(*stages: dict[str, Any]) -> Case:
    return Case.model_validate(BLOCK | {"stages": list(stages)})


@pytest.fixture(scope="module")
def twice(tmp_path_factory: pytest.TempPathFactory) -> Result:
    folder = tmp_path_factory.mktemp("block") / "twice"
    outcome = run_model(build_model(case(PRESS, LIFT, AGAIN)), folder)
    assert outcome.status == "completed"
    return Result(folder)


def test_a_lifted_tool_leaves_the_block_free(twice: Result) -> None:
    """The floor carries nothing; what plane strain locks in across the plane stays below yield."""
    lifted = np.flatnonzero(np.asarray(twice.history["stage"]) == "lift")[-1]
    assert twice.history["punch.force"][lifted] == 0.0
    assert twice.history["punch.stroke"][lifted] == 0.0, "placing is no stroke"
    assert twice.tool_displacement("punch", 2 * 2)[1] == pytest.approx(3.0)
    pressed = np.abs(twice.history["floor.force_y"]).max()
    assert abs(twice.history["floor.force_y"][lifted]) < 1e-3 * pressed
    step = int(np.argmin(np.abs(np.asarray(twice.times) - twice.history["time"][lifted])))
    assert twice.field("effective_stress", step).max() < 150.0
    assert twice.field("equivalent_plastic_strain", step).min() > 0.9 * STROKE / HEIGHT


def test_energy_goes_back_with_what_is_let_go(twice: Result) -> None:
    assert abs(twice.summary["energy"]["error_percent"]) < 0.2


def test_a_tool_that_touches_again_goes_on_where_the_block_was(twice: Result, tmp_path: Path) -> None:
    """Elastic return and reload: at the same place of the tool the force is that of a run without the lift."""
    end = -float(twice.tool_displacement("punch")[1])
    assert twice.history["punch.stroke"][-1] == pytest.approx(MORE), "it counts from where the tool was placed"
    assert 0.98 * STROKE < end - MORE < STROKE, "it begins where the block has sprung back to"
    straight = {"name": "press", "tools": {"punch": {"stroke": end, "direction": [0, -1]}}}
    run_model(build_model(case(straight)), tmp_path / "once")
    once = Result(tmp_path / "once")
    assert twice.history["punch.force"][-1] == pytest.approx(once.history["punch.force"][-1], rel=2e-3)


def test_a_resumed_run_places_it_alike(twice: Result, tmp_path: Path) -> None:
    folder, model = tmp_path / "resumed", build_model(case(PRESS, LIFT, AGAIN))
    run_in_two_parts(model, folder, lambda progress: "lift" in progress.text)
    assert (folder / "history.csv").read_bytes() == (twice.folder / "history.csv").read_bytes()


@pytest.mark.parametrize(
    ("stages", "key", "says"),
    [
        ([AGAIN], "stages.0.tools.punch.position", "the first stage begins where the tool starts"),
        (
            [PRESS, {"name": "lift", "tools": {"punch": {"position": "touch"}}}],
            "stages.1.tools.punch",
            "no direction from which it comes",
        ),
    ],
)
def test_positions_without_sense_are_refused(stages: list[dict[str, Any]], key: str, says: str) -> None:
    with pytest.raises(CaseError) as error:
        build_model(case(*stages))
    assert key in str(error.value)
    assert says in str(error.value)


def test_a_tool_put_into_the_block_stops_the_run(tmp_path: Path) -> None:
    deep = {"name": "deep", "tools": {"punch": {"position": [0.0, -4.0]}}}
    outcome = run_model(build_model(case(PRESS, deep)), tmp_path / "out")
    assert outcome.status == "gave_up"
    assert "into the workpiece when its stage begins" in outcome.reason


def test_every_operation_has_its_stroke_and_its_picture(tmp_path: Path) -> None:
    """A second punch waits above and is set onto the block: its stroke begins there, and titles name it."""
    data = BLOCK | {"tools": BLOCK["tools"] | {"finisher": BLOCK["tools"]["punch"] | {"position": [0.0, 60.0]}}}
    finish = {
        "name": "finish it",
        "tools": {
            "punch": {"position": [0.0, 60.0]},
            "finisher": {"position": [0.0, -0.9], "stroke": MORE, "direction": [0, -1]},
        },
    }
    outcome = run_model(build_model(Case.model_validate(data | {"stages": [PRESS, finish]})), tmp_path / "out")
    assert outcome.status == "completed", outcome.reason
    result, history = outcome.result, outcome.result.history
    own = history["stage"] == "finish it"
    assert history["punch.stroke"][~own][-1] == pytest.approx(STROKE)
    assert not history["punch.stroke"][own].any()
    assert not history["finisher.stroke"][~own].any()
    assert history["finisher.stroke"][-1] == pytest.approx(MORE)
    assert [(o.name, o.tools) for o in list_operations(result)] == [
        ("press", ("punch",)),
        ("finish it", ("finisher",)),
    ]
    assert describe_step(result, 1).startswith("punch stroke 0.50 mm")
    assert describe_step(result, -1).startswith(f"finisher stroke {MORE:.2f} mm")
    assert describe_step(result, 0).startswith("punch stroke 0.00 mm")
    names = {path.name for path in plot_all(result, tmp_path / "plots", ["effective_stress"])}
    assert {"force_stroke.png", "force_stroke_press.png", "force_stroke_finish_it.png"} <= names
    ax = plot_operation(result, list_operations(result)[1])
    (line, *_) = ax.lines
    assert line.get_xdata()[-1] == pytest.approx(MORE)
    assert line.get_ydata()[-1] == pytest.approx(1e-3 * history["finisher.force"][-1])


def test_a_run_without_placing_has_one_picture_of_forces(tmp_path: Path) -> None:
    result = run_model(build_model(case(PRESS)), tmp_path / "out").result
    assert list_operations(result) == []
    names = {path.name for path in plot_all(result, tmp_path / "plots", ["effective_stress"])}
    assert {name for name in names if name.startswith("force_stroke")} == {"force_stroke.png"}


def strip_between(analysis: str) -> Any:
    """A strip under a roll that is placed and turned in one stage."""
    space = analysis == "solid"
    box = {"size": [8.0, 2.0, 1.0], "cells": [16, 4, 1]} if space else {"size": [8.0, 2.0], "cells": [16, 4]}
    middle, still = ([0.5], [0.0]) if space else ([], [])
    roll: dict[str, Any] = {"contact": "coulomb", "mu": 0.3, "position": [1.0, 4.2, *middle]}
    if space:
        roll |= {"shape": "cylinder", "axis": [0, 0, 1], "radius": 2.0, "length": 4.0}
    else:
        circle = {"centre": [0, 0], "turn": "left"}
        roll |= {"profile": [[0, -2], {"to": [0, 2], **circle}, {"to": [0, -2], **circle}]}
    sides = {"bottom": "y", "left": "x"} | ({"back": "z"} if space else {})
    again = {"position": [3.0, 4.0, *middle], "turn": 20.0, "move": [0.0, -0.05, *still]}
    case = {
        "analysis": analysis,
        "workpiece": {"material": "steel", "mesh": box},
        "boundary": {side: {"set": side, "fix": [axis], "symmetry": False} for side, axis in sides.items()},
        "tools": {"roll": roll},
        "stages": [
            {"name": "first", "tools": {"roll": {"move": [0.0, -0.25, *still], "turn": 10.0}}},
            {"name": "second", "tools": {"roll": again}},
        ],
    }
    return (SpaceCase if space else Case).model_validate(BLOCK | case)


@pytest.mark.parametrize("analysis", ["plane_strain", "solid"])
def test_a_roll_is_placed_and_turned_in_one_stage(analysis: str) -> None:
    """It begins the stage at its place with the angle that it has; there it turns and moves on."""
    procedure = ImplicitProcedure(build_model(strip_between(analysis)), threads=1)
    for _ in procedure.advance():
        pass
    placed = procedure.state[SpaceToolArrays if analysis == "solid" else ToolArrays]
    np.testing.assert_allclose(placed.displacement[0][:2], [2.0, -0.25])
    assert placed.angle[0] == pytest.approx(np.radians(30.0))
    assert abs(placed.force).sum() > 0.0
