# SPDX-License-Identifier: Apache-2.0
"""Tools whose place follows from a force, and tools that turn, against statics and closed forms."""

from dataclasses import replace

import numpy as np
import pytest

from presswork import Case, CaseError, build_model
from presswork.implicit.progress import Progress
from presswork.implicit.stepping import ImplicitProcedure, NotHeldError
from presswork.model import Push, ToolMotion
from presswork.outcome import GaveUpError
from presswork.process.tool_quantities import measure_tools

WIDTH, HEIGHT, DEPTH = 10.0, 6.0, 2.0
YOUNG, POISSON, YIELD = 200e3, 0.3, 700.0


def block_case(**changes: object) -> Case:
    """A block on frictionless flats: a punch above, the middle plane below."""
    settings = {
        "title": "block",
        "analysis": "plane_strain",
        "depth": DEPTH,
        "workpiece": {
            "material": "steel",
            "element": "quad4_fbar",
            "mesh": {"kind": "rectangle", "size": [WIDTH, HEIGHT], "cells": [4, 3]},
        },
        "materials": {
            "steel": {
                "young": YOUNG,
                "poisson": POISSON,
                "hardening": {"law": "linear", "yield_stress": YIELD, "modulus": 300.0},
            }
        },
        "tools": {"punch": {"profile": [[-5, HEIGHT], [25, HEIGHT]], "contact": "frictionless", "mirrored": []}},
        "boundary": {
            "middle": {"set": "bottom", "fix": ["y"], "symmetry": False},
            "left": {"set": "left", "fix": ["x"], "symmetry": False},
        },
        "stages": [{"name": "push", "tools": {"punch": {"force": 8e3, "direction": [0, -1]}}}],
        "solver": {"max_increment": 0.25, "initial_increment": 0.25, "force_tolerance": 1e-8},
    }
    return Case(**{**settings, **changes})


def run(case: Case) -> ImplicitProcedure:
    procedure = ImplicitProcedure(build_model(case), threads=1)
    for _ in procedure.advance():
        pass
    return procedure


def quantities(procedure: ImplicitProcedure, stage: int = 0):
    return measure_tools(procedure, stage)


def test_a_pushed_tool_stops_where_the_workpiece_balances_its_force() -> None:
    """Elastic block in plane strain: stroke = F H (1 - nu^2) / (E W D)."""
    procedure = run(block_case())
    punch = quantities(procedure)["punch"]
    assert punch.force == pytest.approx(8e3, rel=1e-6)
    strain = 8e3 / (WIDTH * DEPTH) * (1 - POISSON**2) / YOUNG
    assert punch.stroke == pytest.approx(strain * HEIGHT, rel=2e-3)  # log strain, and the width grows a little


def test_a_force_follows_its_table_over_the_stage() -> None:
    """8 kN at half of the stage and 2 kN at its end, from nothing; the last row alone would give 1 kN at half."""
    model = build_model(block_case())
    push = Push((0.0, -1.0), np.array([[0.5, 8e3], [1.0, 2e3]]))
    stage = replace(model.stages[0], tool_motion={"punch": ToolMotion(push=push)})
    procedure = ImplicitProcedure(replace(model, stages=(stage,)), threads=1)
    forces = [(report.fraction, quantities(procedure)["punch"].force) for report in procedure.advance()]
    np.testing.assert_allclose(forces, [(0.25, 4e3), (0.5, 8e3), (0.75, 5e3), (1.0, 2e3)], rtol=1e-6)


def test_force_control_and_stroke_control_agree_in_plastic_flow() -> None:
    force = 20e3  # well above yield: 2/sqrt(3) 700 20 mm2 = 16.2 kN
    pushed = run(block_case(stages=[{"name": "p", "tools": {"punch": {"force": force, "direction": [0, -1]}}}]))
    stroke = quantities(pushed)["punch"].stroke
    assert stroke > 0.1
    driven = run(block_case(stages=[{"name": "p", "tools": {"punch": {"stroke": stroke, "direction": [0, -2]}}}]))
    assert quantities(driven)["punch"].force == pytest.approx(force, rel=1e-5)


def test_a_pushed_tool_takes_up_the_force_of_the_stage_before() -> None:
    """A stroke, then a force smaller than it had reached: the tool retreats as it is unloaded."""
    stages = [
        {"name": "press", "tools": {"punch": {"stroke": 0.01, "direction": [0, -1]}}},
        {"name": "hold", "tools": {"punch": {"force": 2e3, "direction": [0, -1]}}},
    ]
    procedure = ImplicitProcedure(build_model(block_case(stages=stages)), threads=1)
    fractions, forces = [], []
    for report in procedure.advance():
        force = quantities(procedure, 0 if report.stage == "press" else 1)["punch"].force
        if report.stage == "press":
            reached = force
        else:
            fractions.append(report.fraction)
            forces.append(force)
    assert reached > 6e3
    np.testing.assert_allclose(forces, reached + np.array(fractions) * (2e3 - reached), rtol=1e-6)


def test_half_a_mirrored_tool_takes_half_the_force() -> None:
    tools = {"punch": {"profile": [[0, HEIGHT], [25, HEIGHT]], "contact": "frictionless", "mirrored": ["x"]}}
    punch = quantities(run(block_case(tools=tools)))["punch"]
    whole = quantities(run(block_case()))["punch"]
    assert punch.force == pytest.approx(8e3, rel=1e-6)
    assert punch.stroke == pytest.approx(0.5 * whole.stroke, rel=1e-3)


@pytest.mark.parametrize("friction", [{"contact": "shear", "m": 0.3}, {"contact": "coulomb", "mu": 0.2}])
def test_friction_is_part_of_the_balance_of_an_inclined_tool(friction) -> None:
    """A wedge pushed down on a block's corner: the reaction along the push is the force, friction and all."""
    tools = {"punch": {"profile": [[-5, HEIGHT + 1.5], [10, HEIGHT], [12, HEIGHT - 0.2]], **friction, "mirrored": []}}
    stages = [{"name": "p", "tools": {"punch": {"force": 1e3, "direction": [0, -1]}}}]
    procedure = run(block_case(tools=tools, stages=stages))
    punch = quantities(procedure)["punch"]
    assert punch.force == pytest.approx(1e3, rel=1e-5)
    assert abs(punch.vector[0]) > 1.0
    log_lengths = procedure.state[Progress].iterations / procedure.state[Progress].increments
    assert log_lengths <= 9, "Newton's method with the tool's equation in it stays quick"


def test_a_spring_gives_way_above_its_preload_only() -> None:
    spring = {"stiffness": "50 kN/mm", "preload": "3 kN", "direction": [0, -1]}
    tools = {
        "punch": {"profile": [[-5, HEIGHT], [25, HEIGHT]], "contact": "frictionless", "mirrored": []},
        "anvil": {"profile": [[25, 0], [-5, 0]], "contact": "frictionless", "mirrored": [], "spring": spring},
    }
    boundary = {"left": {"set": "left", "fix": ["x"], "symmetry": False}}
    for stroke, gives in ((0.003, False), (0.2, True)):
        stages = [{"name": "p", "tools": {"punch": {"stroke": stroke, "direction": [0, -1]}}}]
        procedure = run(block_case(tools=tools, boundary=boundary, stages=stages))
        punch, anvil = quantities(procedure)["punch"], quantities(procedure)["anvil"]
        assert anvil.force == pytest.approx(punch.force, rel=1e-6)
        if gives:
            assert anvil.force == pytest.approx(3e3 + 50e3 * anvil.stroke, rel=1e-6)
            assert 0.05 < anvil.stroke < 0.2
        else:
            assert anvil.force < 3e3
            assert anvil.stroke == 0.0


def test_a_spring_comes_back_to_its_stop() -> None:
    spring = {"stiffness": 50e3, "preload": 3e3, "direction": [0, -1]}
    tools = {
        "punch": {"profile": [[-5, HEIGHT], [25, HEIGHT]], "contact": "frictionless", "mirrored": []},
        "anvil": {"profile": [[25, 0], [-5, 0]], "contact": "frictionless", "mirrored": [], "spring": spring},
    }
    stages = [
        {"name": "down", "tools": {"punch": {"stroke": 0.05, "direction": [0, -1]}}},
        {"name": "up", "tools": {"punch": {"stroke": 0.047, "direction": [0, 1]}}},
    ]
    boundary = {"left": {"set": "left", "fix": ["x"], "symmetry": False}}
    procedure = run(block_case(tools=tools, boundary=boundary, stages=stages))
    anvil = quantities(procedure, 1)["anvil"]
    assert anvil.stroke == 0.0
    assert 0 < anvil.force < 3e3


def test_a_block_that_turns_with_its_platens_keeps_its_stress() -> None:
    """Two sticking platens hold a pressed block and turn together by 90 degrees about its middle."""
    tools = {
        # the centre of the upper platen comes down with it, to the lower's
        "upper": {"profile": [[-5, HEIGHT], [25, HEIGHT]], "contact": "sticking", "mirrored": [], "centre": [5, 3.02]},
        "lower": {"profile": [[25, 0], [-5, 0]], "contact": "sticking", "mirrored": [], "centre": [5, 3]},
    }
    stages = [
        {"name": "press", "tools": {"upper": {"stroke": 0.02, "direction": [0, -1]}}},
        {"name": "turn", "tools": {"upper": {"turn": "90 degree"}, "lower": {"turn": 90}}},
    ]
    case = block_case(tools=tools, boundary={}, stages=stages, solver={"max_increment": 0.05, "force_tolerance": 1e-8})
    procedure = ImplicitProcedure(build_model(case), threads=1)
    forces = []
    for report in procedure.advance():
        forces.append((report.stage, quantities(procedure, 0 if report.stage == "press" else 1)["upper"].vector))
    pressed = next(f for stage, f in reversed(forces) if stage == "press")
    np.testing.assert_allclose(forces[-1][1], [-pressed[1], pressed[0], 0.0], rtol=2e-2, atol=1e-3 * abs(pressed[1]))


@pytest.mark.parametrize("sense", [1, -1])
def test_a_turning_roll_drags_a_held_block_with_mu_times_its_push(sense) -> None:
    """A roll pressed on a clamped block and turned: force mu N along the surface, torque mu N R against its turning."""
    radius, mu = 20.0, 0.1
    roll = [{"to": [5, HEIGHT]}, {"to": [5, HEIGHT + 2 * radius], "centre": [5, HEIGHT + radius], "turn": "left"},
            {"to": [5, HEIGHT], "centre": [5, HEIGHT + radius], "turn": "left"}]  # fmt: skip
    tools = {"roll": {"profile": roll, "contact": "coulomb", "mu": mu, "free_side": "right", "mirrored": []}}
    stages = [
        {"name": "press", "tools": {"roll": {"stroke": 0.01, "direction": [0, -1]}}},
        {"name": "turn", "tools": {"roll": {"turn": 5 * sense}}},
    ]
    case = block_case(
        tools=tools, stages=stages, boundary={"bottom": {"set": "bottom", "fix": ["x", "y"], "symmetry": False}}
    )
    procedure = run(case)
    q = quantities(procedure, 1)["roll"]
    assert q.angle == pytest.approx(np.radians(5 * sense))
    push, drag = abs(q.vector[1]), abs(q.vector[0])
    assert drag == pytest.approx(mu * push, rel=0.02)  # the surface is curved within the contact
    assert q.torque == pytest.approx(mu * push * radius, rel=0.02)
    assert q.vector[0] * sense < 0, "turning to the left, the underside moves to the right: the block holds it back"


def test_the_work_of_the_tools_is_their_force_over_their_stroke_friction_and_all() -> None:
    """A rough punch flattens a block: what the surfaces lose in sliding is part of the work, and of the balance."""
    tools = {"punch": {"profile": [[-5, HEIGHT], [25, HEIGHT]], "contact": "shear", "m": 0.4, "mirrored": []}}
    stages = [{"name": "press", "tools": {"punch": {"stroke": 1.5, "direction": [0, -1]}}}]
    case = block_case(tools=tools, stages=stages, solver={"max_increment": 0.01})
    procedure = ImplicitProcedure(build_model(case), threads=1)
    strokes, forces = [0.0], [0.0]
    for _ in procedure.advance():
        punch = quantities(procedure)["punch"]
        strokes.append(punch.stroke)
        forces.append(punch.force)
    energy, force = procedure.energy_balance(), np.array(forces)
    work = 0.5 * (force[1:] + force[:-1]) @ np.diff(strokes)
    assert energy["external_work"] == pytest.approx(work, rel=1e-3)
    assert energy["friction_work"] > 0.05 * energy["external_work"]
    assert abs(energy["error_percent"]) < 0.5


def test_a_pushed_tool_with_nothing_before_it_is_refused() -> None:
    tools = {"punch": {"profile": [[-5, HEIGHT + 1], [25, HEIGHT + 1]], "contact": "frictionless", "mirrored": []}}
    with pytest.raises(NotHeldError, match=r"'punch' is pushed by a force in stage 'push', but nothing lies before it"):
        run(block_case(tools=tools))
    with pytest.raises(NotHeldError, match="nothing lies before it"):  # pushed away from the workpiece
        run(block_case(stages=[{"name": "push", "tools": {"punch": {"force": 1, "direction": [0, 1]}}}]))
    lift = {"name": "lift", "tools": {"punch": {"stroke": 1, "direction": [0, 1]}}}
    push = {"name": "push", "tools": {"punch": {"force": 10, "direction": [0, -1]}}}
    with pytest.raises(GaveUpError, match="nothing lies before it"):
        run(block_case(stages=[lift, push], solver={}))


def test_a_workpiece_between_pushed_tools_alone_is_not_held() -> None:
    tools = {
        "punch": {"profile": [[-5, HEIGHT], [25, HEIGHT]], "contact": "shear", "m": 0.1, "mirrored": []},
        "anvil": {"profile": [[25, 0], [-5, 0]], "contact": "shear", "m": 0.1, "mirrored": []},
    }
    down, up = {"force": 8e3, "direction": [0, -1]}, {"force": 8e3, "direction": [0, 1]}
    stages = [{"name": "push", "tools": {"punch": down, "anvil": up}}]
    with pytest.raises(NotHeldError, match="nothing holds the workpiece in y"):
        run(block_case(tools=tools, boundary={}, stages=stages))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"stages": [{"name": "p", "tools": {"punch": {"force": 0, "direction": [0, -1]}}}]}, "expected a value > 0"),
        ({"stages": [{"name": "p", "tools": {"punch": {"force": 5}}}]}, "direction"),
        ({"stages": [{"name": "p", "tools": {"punch": {"force": 5, "stroke": 1, "direction": [0, 1]}}}]}, "travels or"),
        ({"stages": [{"name": "p", "tools": {"punch": {"turn": 5}}}]}, "its centre is not given"),
        ({"analysis": "axisymmetric", "depth": 1, "stages": [
            {"name": "p", "tools": {"punch": {"force": 5, "direction": [1, 0]}}}]}, "along y only"),
        ({"tools": {"punch": {"profile": [[-5, 6], [25, 6]], "contact": "sticking",
            "spring": {"stiffness": 0, "direction": [0, 1]}}}}, "expected a value > 0"),
        ({"tools": {"punch": {"profile": [[-5, 6], [25, 6]], "contact": "sticking",
            "spring": {"stiffness": 1, "direction": [0, 1]}}}}, "rests on a spring"),
    ],
)  # fmt: skip
def test_wrong_input_of_forces_springs_and_turns_is_named(changes, message) -> None:
    with pytest.raises(CaseError, match=message):
        build_model(block_case(**changes))
