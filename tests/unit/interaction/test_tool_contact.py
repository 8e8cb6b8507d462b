# SPDX-License-Identifier: Apache-2.0
"""Tool profiles: gaps, normals, corners; and nodes that are held, pushed and let go."""

import numpy as np
import pytest

from presswork import Case, _core, build_model
from presswork.geometry.segments import measure_distance
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.tool_arrays import ContactArrays

FLOOR = np.array([[0.0, 0, 10, 0, 0, 0, 0]])
L_SHAPE = np.array([[0.0, 10, 0, 0, 0, 0, 0], [0.0, 0, 10, 0, 0, 0, 0]])  # down a wall, along a floor: an inner corner
EDGE = np.array([[0.0, 0, 5, 0, 0, 0, 0], [5.0, 0, 5, -5, 0, 0, 0]])  # along a top, down a side: an outer corner
HILL = np.array([[-1.0, 0, 1, 0, 0, 0, -1]])  # upper half circle, run clockwise: metal below


def touch(segments, *points):
    gap, normal, second_gap, second_normal, _, _ = _core.touch_profile(segments, np.array(points, dtype=float))
    return gap, normal, second_gap, second_normal


def test_gap_is_the_signed_distance_from_a_line() -> None:
    gap, normal, second, _ = touch(FLOOR, [3, 2], [3, -0.5])
    np.testing.assert_allclose(gap, [2, -0.5])
    np.testing.assert_allclose(normal, [[0, 1], [0, 1]])
    assert np.isinf(second).all()


def test_there_is_no_tool_beyond_an_open_end() -> None:
    assert np.isinf(touch(FLOOR, [10.5, -0.5])[0]).all()


def test_a_corner_is_not_closest_where_an_open_end_is_nearer() -> None:
    """Behind both faces of an inner corner, but far up beyond the wall's end: no tool is there."""
    gap, _, second, _ = touch(L_SHAPE, [-0.1, 12.0])
    assert np.isinf(gap).all()
    assert np.isinf(second).all()
    relief = np.array([[8.4, -30, 8.4, -10, 0, 0, 0], [8.4, -10, 8, -9, 0, 0, 0], [8.0, -9, 10, 0, 0, 0, 0]])
    assert np.isinf(touch(relief, [8.75, 30])[0]).all()


def test_gap_and_normal_of_an_arc_point_away_from_its_metal() -> None:
    gap, normal, _, _ = touch(HILL, [0, 1.5], [0.6, 0.0 + 0.8 * 0.9])
    np.testing.assert_allclose(gap, [0.5, np.hypot(0.6, 0.72) - 1])
    np.testing.assert_allclose(normal[0], [0, 1])


def test_a_hollow_arc_holds_what_is_inside_it() -> None:
    hollow = np.array([[-1.0, 0, 1, 0, 0, 0, 1]])  # lower half circle, run counter-clockwise: free above
    gap, normal, _, _ = touch(hollow, [0, -0.75], [0, -1.25])
    np.testing.assert_allclose(gap, [0.25, -0.25])
    np.testing.assert_allclose(normal, [[0, 1], [0, 1]])


def test_a_point_behind_an_inner_corner_sees_both_faces() -> None:
    gap, normal, second_gap, second_normal = touch(L_SHAPE, [-0.1, -0.2], [0, 0], [3, -0.2])
    np.testing.assert_allclose(gap[:2], [-0.1, 0])
    np.testing.assert_allclose(normal[0], [1, 0])
    np.testing.assert_allclose(second_gap[:2], [-0.2, 0])
    np.testing.assert_allclose(second_normal[0], [0, 1])
    assert gap[2] == pytest.approx(-0.2)
    assert np.isinf(second_gap[2])


def test_the_normal_turns_round_an_outer_corner() -> None:
    gap, normal, _, _ = touch(EDGE, [5.3, 0.4], [5.3, -1])
    np.testing.assert_allclose(gap, [0.5, 0.3])
    np.testing.assert_allclose(normal, [[0.6, 0.8], [1, 0]], atol=1e-12)


def test_a_point_behind_an_acute_inner_corner_is_inside() -> None:
    groove = np.array([[-1.0, 5, 0, 0, 0, 0, 0], [0.0, 0, 1, 5, 0, 0, 0]])  # a groove that opens by 23 degrees
    gap, _, second_gap, _ = touch(groove, [0, -0.5], [0.2, -0.3], [0.5, 0])
    assert (np.minimum(gap, second_gap) < 0).all()


def test_a_turn_too_small_to_see_is_no_corner() -> None:
    bent = np.array([[0.0, 0, 5, 0, 0, 0, 0], [5.0, 0, 10, 0.002, 0, 0, 0]])
    assert np.isinf(touch(bent, [5, 0], [5, -0.1])[2]).all(), "0.4 mm on a metre is smooth"
    bent[1, 3] = 0.02
    assert np.isfinite(touch(bent, [5, 0])[2]).all()


@pytest.mark.parametrize("arcs", [False, True])
@pytest.mark.parametrize("n_segments", [1, 3, 8, 37, 400])
def test_the_closest_of_many_segments_is_found(arcs, n_segments) -> None:
    """Against distances by numpy to every segment and vertex, for points near a wavy chain, open at its ends."""
    rng = np.random.default_rng(n_segments)
    x = np.linspace(0.0, 40.0, n_segments + 1)
    ends = np.column_stack([x, 4.0 * np.sin(0.4 * x)])
    segments = np.zeros((n_segments, 7))
    segments[:, 0:2], segments[:, 2:4] = ends[:-1], ends[1:]
    if arcs:
        chord = ends[1:] - ends[:-1]
        sides = rng.choice([-1.0, 1.0], n_segments)
        normal = np.column_stack([-chord[:, 1], chord[:, 0]])
        segments[:, 4:6] = 0.5 * (ends[1:] + ends[:-1]) + 2.0 * sides[:, None] * normal
        segments[:, 6] = sides
    foot = rng.uniform(0.0, 40.0, 3000)
    points = np.column_stack([foot, 4.0 * np.sin(0.4 * foot) + rng.uniform(-0.5, 8.0, 3000)])
    gap, normal, second_gap, _, segment, second_segment = _core.touch_profile(segments, points)
    place = measure_distance(points, segments)
    single = place.beside & np.isinf(second_gap)
    np.testing.assert_allclose(gap[single], place.distance[single], atol=1e-9)
    assert single.mean() > 0.5
    assert ((segment >= 0) == np.isfinite(gap)).all()
    assert ((second_segment >= 0) == np.isfinite(second_gap)).all()
    for k in np.flatnonzero(single)[:50]:
        alone, *_ = _core.touch_profile(segments[segment[k]][None], points[k][None])
        assert alone[0] == gap[k] or np.linalg.norm(points[k] - segments[segment[k], 2:4]) == pytest.approx(abs(gap[k]))


def block_case(**changes) -> Case:
    """A 10 x 15 mm quarter billet under a frictionless punch."""
    case = {
        "title": "block",
        "analysis": "axisymmetric",
        "workpiece": {
            "material": "steel",
            "element": "quad4_fbar",
            "mesh": {"kind": "rectangle", "size": [10, 15], "cells": [4, 4], "pattern": "quad"},
        },
        "materials": {
            "steel": {
                "young": 200e3,
                "poisson": 0.3,
                "hardening": {"law": "linear", "yield_stress": 700, "modulus": 300},
            }
        },
        "tools": {"punch": {"profile": [[0, 15], [30, 15]], "contact": "frictionless"}},
        "boundary": {"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
        "stages": [{"name": "press", "tools": {"punch": {"stroke": 3, "direction": [0, -1]}}}],
    }
    return Case(**{**case, **changes})


def advance(case: Case) -> ImplicitProcedure:
    procedure = ImplicitProcedure(build_model(case), threads=1)
    for _ in procedure.advance():
        pass
    return procedure


def tool_force(procedure: ImplicitProcedure) -> np.ndarray:
    stage = len(procedure.model.stages) - 1
    procedure.interactions.tools.contact.search(procedure.state, procedure.state.nodes.displacement)
    return procedure.interactions.tools.contact.tool_forces(
        procedure.state, procedure.interactions.supports.fixed(stage)
    )[0]


def test_frictionless_punch_compresses_without_barrelling() -> None:
    procedure = advance(block_case())
    stress = np.concatenate([s.reshape(-1, 4) for s in procedure.state.cells.stress])
    axial = stress[:, 1]
    np.testing.assert_allclose(axial, axial[0], rtol=1e-6)
    np.testing.assert_allclose(stress[:, [0, 2, 3]], 0.0, atol=1e-4 * abs(axial[0]))
    radius = 10 + procedure.state.nodes.displacement[procedure.model.mesh.node_sets["right"], 0]
    np.testing.assert_allclose(radius, radius[0], rtol=1e-8)
    assert tool_force(procedure)[0, 1] == pytest.approx(-axial[0] * np.pi * radius[0] ** 2, rel=1e-6)


@pytest.mark.parametrize("profile", [[[0, 15], [30, 15]], [[0, 15], [10.5, 15], [10.5, 0]]])
def test_pushes_are_those_of_the_forces(profile) -> None:
    """Under a flat punch, and in a container whose wall the metal reaches."""
    tools = {"punch": {"profile": profile, "contact": "coulomb", "mu": 0.1}}
    press = {"name": "press", "tools": {"punch": {"stroke": 1.2, "direction": [0, -1]}}}
    procedure = advance(block_case(tools=tools, stages=[press]))
    contact, fixed = procedure.interactions.tools.contact, procedure.interactions.supports.fixed(0)
    forces = contact.forces(procedure.state, fixed)
    held, push = contact.pushes(procedure.state, fixed)
    tool, place = np.nonzero(held)
    assert np.array_equal(contact.nodes[place], forces.nodes)
    assert push[tool, place] == pytest.approx(forces.push, rel=1e-12, abs=1e-9)
    assert (push[~held] == 0.0).all()


def test_a_node_lets_go_when_the_punch_withdraws() -> None:
    stages = [
        {"name": "press", "tools": {"punch": {"stroke": 3, "direction": [0, -1]}}},
        {"name": "withdraw", "tools": {"punch": {"stroke": 5, "direction": [0, 1]}}},
    ]
    procedure = advance(block_case(stages=stages))
    assert not procedure.state[ContactArrays].status.any()
    assert np.abs(tool_force(procedure)).max() == 0.0
    stress = np.concatenate([s.reshape(-1, 4) for s in procedure.state.cells.stress])
    assert np.abs(stress).max() < 1.0, "a homogeneously pressed block springs back free of stress"


def test_a_corner_node_is_held_by_both_faces() -> None:
    """A block pressed into a container: confined compression, wall and floor one profile with an inner corner."""
    tools = {
        "punch": {"profile": [[-5, 10], [30, 10]], "contact": "frictionless"},
        "container": {"profile": [[-1, 0], [10, 0], [10, 20]], "contact": "frictionless"},
    }
    workpiece = {
        "material": "steel",
        "element": "quad4_fbar",
        "mesh": {"kind": "rectangle", "size": [10, 10], "cells": [4, 4], "pattern": "quad"},
    }
    case = block_case(
        analysis="plane_strain",
        workpiece=workpiece,
        tools=tools,
        boundary={"middle": {"set": "left", "fix": ["x"]}},
        stages=[{"name": "press", "tools": {"punch": {"stroke": 0.05, "direction": [0, -1]}}}],
    )
    procedure = advance(case)
    corner = procedure.model.mesh.points.tolist().index([10.0, 0.0])
    place = procedure.interactions.tools.contact.nodes.tolist().index(corner)
    assert (procedure.state[ContactArrays].status[2:, place] > 0).sum() == 2
    np.testing.assert_allclose(procedure.state.nodes.displacement[corner], 0.0, atol=1e-9)
    bulk, shear = 200e3 / (3 * 0.4), 200e3 / 2.6
    strain = np.log(1 - 0.05 / 10)  # uniaxial strain: mean stress is elastic, the deviator sits on the yield surface
    stress = procedure.state.cells.stress[0].reshape(-1, 4)
    np.testing.assert_allclose(stress[:, :3].mean(axis=1), bulk * strain, rtol=1e-6)
    plastic = (2 * shear * abs(strain) - 700) / (3 * shear + 300)
    assert plastic > 0
    np.testing.assert_allclose(procedure.state.cells.eqps[0], plastic, rtol=1e-6)


@pytest.mark.parametrize(("inner_end", "outer_start"), [(10.4, 10.4), (10.4, 9.5)])
def test_flush_tools_press_like_one(inner_end, outer_start) -> None:
    """A platen in two pieces that adjoin or overlap: nodes slide from one to the other, and are pinned by neither."""
    tools = {
        "inner": {"profile": [[0, 15], [inner_end, 15]], "contact": "frictionless"},
        "outer": {"profile": [[outer_start, 15], [30, 15]], "contact": "frictionless"},
    }
    motion = {"stroke": 3, "direction": [0, -1]}
    stages = [{"name": "press", "tools": {"inner": motion, "outer": motion}}]
    whole, parts = advance(block_case()), advance(block_case(tools=tools, stages=stages))
    assert tool_force(parts)[:, 1].sum() == pytest.approx(tool_force(whole)[0, 1], rel=1e-6)
    np.testing.assert_allclose(parts.state.nodes.displacement, whole.state.nodes.displacement, atol=1e-6)
    assert tool_force(parts)[1, 1] > 0, "the outer piece has taken over the rim"


def test_an_increment_fails_whose_contact_does_not_settle() -> None:
    """A node that has changed too often to be let go and pulls strongly: cut back, not kept."""
    procedure = advance(block_case())
    contact, state, fixed = (
        procedure.interactions.tools.contact,
        procedure.state,
        procedure.interactions.supports.fixed(0),
    )
    contact.search(state, state.nodes.displacement)
    held = int(np.nonzero(state[ContactArrays].status[0])[0][-1])
    pulling = state.nodes.reaction.copy()
    pulling[contact.nodes[held]] *= -1.0
    contact.begin_increment(state)
    drag = procedure.interactions.tools.friction.drag
    assert contact.update(state.duplicate(), pulling, drag, fixed, near=True, tolerance=0.0) == 1, "it lets go"
    assert contact.n_undecided == 0
    contact._changes[held] = 4
    assert contact.update(state.duplicate(), pulling, drag, fixed, near=True, tolerance=0.0) == 0, "it may not let go"
    assert contact.n_undecided == 1
    assert contact.update(state.duplicate(), state.nodes.reaction, drag, fixed, near=True, tolerance=0.0) == 0
    assert contact.n_undecided == 0


def test_held_nodes_lie_on_the_tool() -> None:
    tools = {
        "punch": {
            "profile": [{"to": [-20, 35]}, {"to": [20, 35], "centre": [0, 35], "turn": "left"}],
            "contact": "frictionless",
        }
    }
    case = block_case(tools=tools)
    procedure = advance(case)
    procedure.interactions.tools.contact.search(procedure.state, procedure.state.nodes.displacement)
    held = procedure.state[ContactArrays].status > 0
    assert held.sum() >= 4
    assert np.abs(procedure.interactions.tools.contact.gap[held]).max() < 1e-4
    assert procedure.interactions.tools.contact.gap[0].min() > -1e-4, "no boundary node is inside the tool"
    push = procedure.interactions.tools.contact.normal_forces(
        procedure.state, procedure.state.nodes.reaction, procedure.interactions.supports.fixed(0)
    )
    assert push[held].min() > -1e-3 * push.max()


@pytest.mark.parametrize("step", [0.005, 0.02, 0.05])
def test_no_node_passes_through_a_tool_at_any_increment_size(step) -> None:
    tools = {"punch": {"profile": [[0, 15], [30, 15]], "contact": "sticking"}}
    stages = [{"name": "press", "tools": {"punch": {"stroke": 9, "direction": [0, -1]}}}]
    solver = {"initial_increment": step, "max_increment": step, "max_iterations": 40}
    procedure = advance(block_case(tools=tools, stages=stages, solver=solver))
    procedure.interactions.tools.contact.search(procedure.state, procedure.state.nodes.displacement)
    assert procedure.interactions.tools.contact.gap.min() > -procedure.interactions.tools.contact.tolerance
    assert (procedure.state[ContactArrays].status > 0).any(axis=0).sum() > 5, "the side has folded onto the punch"


def test_increments_do_not_die_away_beside_a_node_that_chatters() -> None:
    """A node at the end of a curved, rough punch is let go and taken again in every increment, which costs iterations.

    Were increments cut by 30 % for these, as for others, they would shrink for ever: 2527 increments to 55 %.
    """
    case = Case(
        title="curved punch",
        analysis="plane_strain",
        workpiece={
            "material": "metal",
            "element": "quad8_2x2",
            "mesh": {"size": [6, 10], "cells": [16, 7], "pattern": "quad"},
        },
        materials={"metal": {"young": 2e5, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 400}}},
        tools={
            "punch": {
                "profile": [[0, 10], {"to": [40, 50], "centre": [0, 50], "turn": "left"}],
                "contact": "shear",
                "m": 0.42,
            }
        },
        boundary={"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
        stages=[{"name": "press", "tools": {"punch": {"move": [0, -5.8]}}}],
    )
    procedure = ImplicitProcedure(build_model(case), threads=1)
    for report in procedure.advance():
        assert report.number < 250
    assert report.fraction == 1.0
