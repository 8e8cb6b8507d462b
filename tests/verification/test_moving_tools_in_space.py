# SPDX-License-Identifier: Apache-2.0
"""Tools in space that forces push, that rest on springs, turn and are driven by a press: closed forms and the plane."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from presswork.case import Case, CaseError, build_model
from presswork.case.description import describe
from presswork.case.space.schema import SpaceCase
from presswork.implicit.ram import RamArrays
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.supports import NotHeldError
from presswork.process.tool_quantities import ToolQuantities, measure_tools

STEEL = {"young": 200e3, "poisson": 0.3, "hardening": {"law": "swift", "K": 565, "e0": 0.007, "n": 0.26}}
DOWN = [0, 0, -1]
DIE = {"shape": "plane", "normal": DOWN, "position": "touch", "contact": "frictionless"}
SYMMETRIC = {"left": {"set": "left", "fix": ["x"]}, "bottom": {"set": "bottom", "fix": ["y"]}}
LYING = {**SYMMETRIC, "back": {"set": "back", "fix": ["z"]}}
RADIUS, HALF = 20.0, 4.0
"""Of a roll, and half the gap between two of them [mm]."""


def block(tools: dict[str, Any], stages: list[dict[str, Any]], **others: Any) -> SpaceCase:
    """A quarter of a block 20 x 20 x 8 mm of eight cells."""
    data = {
        "title": "pressed",
        "analysis": "solid",
        "workpiece": {"material": "steel", "mesh": {"size": [10, 10, 8], "cells": [2, 2, 2]}},
        "materials": {"steel": STEEL},
        "tools": tools,
        "boundary": LYING,
        "stages": stages,
    }
    return SpaceCase.model_validate(data | others)


def run(case: Case | SpaceCase) -> tuple[ImplicitProcedure, list[tuple[str, float, dict[str, ToolQuantities]]]]:
    """Return the procedure at the end, and stage, fraction and quantities of every increment."""
    procedure = ImplicitProcedure(build_model(case))
    names = [stage.name for stage in procedure.model.stages]
    found = []
    for report in procedure.advance():
        found.append((report.stage, report.fraction, measure_tools(procedure, names.index(report.stage))))
    return procedure, found


def test_a_pushed_die_upsets_a_block_as_far_as_its_force_does_by_a_stroke() -> None:
    """The second stage begins from the force of the first."""
    pushes = [{"name": f"to {f}", "tools": {"die": {"force": f, "direction": DOWN}}} for f in (200e3, 400e3)]
    procedure, found = run(block({"die": DIE}, pushes))
    forces = [q["die"].force for *_, q in found]
    np.testing.assert_allclose(
        forces, [2e5 * f if s == "to 200000.0" else 2e5 * (1 + f) for s, f, _ in found], rtol=1e-4
    )
    _, driven = run(block({"die": DIE}, [{"name": "press", "tools": {"die": {"stroke": 4, "direction": DOWN}}}]))
    way, force = np.array([(q["die"].stroke, q["die"].force) for *_, q in driven]).T
    ours = np.array([q["die"].stroke for *_, q in found if q["die"].stroke > 0.5])
    np.testing.assert_allclose(np.interp(ours, way, force), forces[-len(ours) :], rtol=2e-3)
    assert abs(procedure.energy_balance()["error_percent"]) < 0.01


def test_a_die_on_a_spring_gives_way_beyond_the_preload() -> None:
    cushion = {"shape": "plane", "normal": [0, 0, 1], "contact": "shear", "m": 0.2}
    cushion["spring"] = {"stiffness": 1e5, "preload": 150e3, "direction": DOWN}
    press = [{"name": "press", "tools": {"die": {"stroke": 4, "direction": DOWN}}}]
    # until the die lets go: nothing holds the block then
    press += [{"name": "lift", "tools": {"die": {"move": [0, 0, 1.4]}}}]
    procedure, found = run(block({"die": DIE, "cushion": cushion}, press, boundary=SYMMETRIC))
    gave = [q["cushion"] for *_, q in found if q["cushion"].stroke > 0.0]
    assert found[2][2]["cushion"].stroke == 0.0, "it rests on its stop below the preload"
    np.testing.assert_allclose([c.force for c in gave], [150e3 + 1e5 * c.stroke for c in gave], rtol=1e-4)
    assert max(c.stroke for c in gave) > 0.5
    assert found[-1][2]["cushion"].stroke == pytest.approx(0.0, abs=1e-9), "it is back on its stop"
    assert abs(procedure.energy_balance()["error_percent"]) < 1.5, "one increment lets go of two thirds of the force"


def rolling(
    cells: list[int], boundary: dict[str, list[str]], tool: dict[str, Any], across: list[float]
) -> dict[str, Any]:
    """A strip is pushed by 6.5 mm into a roll whose surface moves by 7.7 mm."""
    turn = -22.0 if len(across) == 2 else 22.0  # about y the other way round than about the normal of the plane
    return {
        "title": "rolled",
        "workpiece": {"material": "steel", "mesh": {"size": [20.0, *across], "cells": cells}},
        "materials": {"steel": STEEL},
        "tools": {"roll": {"contact": "coulomb", "mu": 0.3, **tool}},
        "boundary": {name: {"set": name, "fix": fix} for name, fix in boundary.items()},
        "stages": [
            {
                "name": "roll",
                "tools": {"roll": {"turn": turn}},
                "displacement": [{"set": "left", "component": "x", "value": 6.5}],
            }
        ],
    }


def test_a_slice_under_a_roll_is_rolled_as_in_plane_strain() -> None:
    """5 mm to 4: force and torque at the end to 1.5 %, the length to 0.5 %, by cells of 0.8 mm."""
    x, z = 20.0 + math.sqrt(RADIUS**2 - (RADIUS - 1.0) ** 2) + 1e-3, HALF + RADIUS
    half_circles = [{"to": [x + s * RADIUS, z], "centre": [x, z], "turn": "left"} for s in (1, -1)]
    profile = [[x - RADIUS, z], *half_circles]
    sides = {"back": ["z"], "bottom": ["y"], "top": ["y"]}
    straight = {"shape": "straight", "profile": profile}
    given = {"analysis": "solid", **rolling([24, 1, 5], sides, straight, [1.0, 5.0])}
    space, in_space = run(SpaceCase.model_validate(given))
    flat = {"analysis": "plane_strain", **rolling([24, 5], {"bottom": ["y"]}, {"profile": profile}, [5.0])}
    plane, in_plane = run(Case.model_validate(flat))
    ours, theirs = in_space[-1][2]["roll"], in_plane[-1][2]["roll"]
    assert math.degrees(ours.angle) == pytest.approx(-22.0)
    assert ours.vector[2] == pytest.approx(theirs.vector[1], rel=1.5e-2)
    assert ours.torque == pytest.approx(theirs.torque, rel=1.5e-2)
    assert ours.torque > 0.0, "it must be driven"
    ends = [p.model.mesh.points[:, 0] + p.state.nodes.displacement[:, 0] for p in (space, plane)]
    assert np.ptp(ends[0]) == pytest.approx(np.ptp(ends[1]), rel=5e-3)
    assert abs(space.energy_balance()["error_percent"]) < 0.5


def test_a_tool_turned_at_the_start_is_the_one_drawn_so() -> None:
    """A straight die with a rounded edge, drawn along y and turned to run along x; and one drawn in y and z."""
    rounded = {"shape": "straight", "profile": [[0, 0], {"to": [6, 0], "radius": 2}, [8, 4], [30, 4]]}
    own = {**rounded, "contact": "shear", "m": 0.2, "position": [0, 0, 8]}
    press = [{"name": "press", "tools": {"die": {"stroke": 2, "direction": DOWN}}}]
    along_y, _ = run(block({"die": own}, press))
    turned = {**own, "rotation": {"axis": [0, 0, 1], "angle": 90}}
    along_x, _ = run(block({"die": turned}, press))
    swapped = along_x.state.nodes.displacement[:, [1, 0, 2]]
    order = [
        int(np.abs(along_x.model.mesh.points[:, [1, 0, 2]] - p).sum(axis=1).argmin()) for p in along_y.model.mesh.points
    ]
    np.testing.assert_allclose(swapped[order], along_y.state.nodes.displacement, atol=5e-4)


def test_a_hammer_strikes_until_its_energy_is_spent_and_again_from_where_it_touches() -> None:
    hammer = {"kind": "hammer", "energy": 2e-1, "velocity": 5000, "efficiency": 1.0}
    strike = {"name": "strike", "press": {"name": "hammer", "blows": 2, "pause": 0.5}}
    strike["tools"] = {"die": {"stroke": 4, "direction": DOWN}}
    procedure, found = run(block({"die": DIE}, [strike], presses={"hammer": hammer}))
    ends = {stage: q["die"].stroke for stage, _, q in found}
    assert procedure.state[RamArrays].work == pytest.approx(2 * 2e5, rel=1e-4)
    balance = procedure.energy_balance()
    assert 8 * (balance["plastic_work"] + balance["elastic_energy"]) == pytest.approx(4e5, rel=2e-2)
    first, second = ends["strike 1"], ends["strike 2"]
    assert 0.0 < first < second < 2 * first, "the second blow goes on, against a harder block"


def test_a_crank_gives_the_stage_its_time() -> None:
    """Its ram goes twice as far as the die: z = 0 is a symmetry plane across it."""
    crank = {"kind": "crank", "stroke": 100, "rpm": 60, "rod_ratio": 0.0}
    stage = {"name": "press", "press": "crank", "tools": {"die": {"stroke": 4, "direction": DOWN}}}
    model = build_model(block({"die": DIE}, [stage], presses={"crank": crank}))
    assert model.stages[0].duration == pytest.approx(math.acos(1 - 8 / 50) / (2 * math.pi))
    assert "crank" in describe(model)


BALL = {"shape": "round", "profile": [[0, 0], {"to": [3, 3], "centre": [0, 3], "turn": "left"}], "contact": "sticking"}


@pytest.mark.parametrize(
    ("tool", "motion", "said"),
    [
        ({**DIE, "position": [0, 0, 8]}, {"turn": 10}, r"stages\.0\.tools\.die\.turn .* its axis is not given"),
        (
            {**DIE, "axis": [1, 0, 0], "position": [0, 0, 8]},
            {"turn": 10},
            "cannot turn about an axis that their symmetry plane does not cross",
        ),
        (DIE, {"force": 1e3, "direction": [1, 0, -1]}, "cannot be pushed across their symmetry plane"),
        ({**DIE, "position": [0, 0, 12]}, {"stroke": 3, "direction": DOWN}, "never reaches the workpiece"),
        (DIE, {"stroke": 3, "direction": [0, 0, 1]}, r"tools\.die\.position .* passes beside the workpiece"),
        ({**BALL, "position": "touch"}, {"stroke": 3, "direction": [1, 0, 0]}, "never comes to it|passes"),
        (
            {**DIE, "spring": {"stiffness": 1e3, "direction": [0, 0, 1]}},
            {"force": 1e3, "direction": DOWN},
            "on a spring",
        ),
        ({**DIE, "rotation": {"axis": [0, 0, 0], "angle": 1}}, {"stroke": 1, "direction": DOWN}, "not zero"),
        (DIE, {"stroke": 1, "direction": DOWN, "force": 2}, "force and stroke are both given"),
    ],
)
def test_motions_that_mean_nothing_are_refused(tool: Any, motion: Any, said: str) -> None:
    with pytest.raises(CaseError, match=said):
        build_model(block({"die": tool}, [{"name": "press", "tools": {"die": motion}}]))


def test_a_force_on_a_tool_that_touches_nothing_is_refused() -> None:
    push = [{"name": "press", "tools": {"die": {"force": 1e3, "direction": DOWN}}}]
    with pytest.raises(NotHeldError, match="nothing lies before it"):
        run(block({"die": {**DIE, "position": [0, 0, 9]}}, push))
