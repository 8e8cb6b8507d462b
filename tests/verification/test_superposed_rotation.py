# SPDX-License-Identifier: Apache-2.0
"""Rigid motion of a stressed body, and frame indifference of a whole run (plane strain).

Truth: a rotation Q after a motion, or together with it, turns the Cauchy stress, Q sigma Q^T, the forces, Q f, and
changes nothing else.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from presswork.model import Material
from tests.problems.plane_solids import (
    ELEMENTS,
    block_mesh,
    distort,
    fixed_increments,
    linear_hardening,
    make_model,
    prescribe,
    run,
    with_node_sets,
)

STEEL = Material("steel", 200e3, 0.3, linear_hardening(400.0, 500.0))
TURN = np.radians(60.0)
Q = np.array([[np.cos(TURN), -np.sin(TURN)], [np.sin(TURN), np.cos(TURN)]])
CARRY = np.array([40.0, -7.0])


def turn(stress):
    """Q sigma Q^T of stresses in order xx, yy, zz, xy."""
    plane = np.stack([stress[..., [0, 3]], stress[..., [3, 1]]], axis=-2)
    turned = Q @ plane @ Q.T
    return np.stack([turned[..., 0, 0], turned[..., 1, 1], stress[..., 2], turned[..., 0, 1]], axis=-1)


@cache
def bend(element):
    """Bend a distorted patch by its boundary, plastically and not homogeneously, in one increment."""
    mesh = distort(block_mesh(element, (3, 3), origin=(-1.0, 2.0), size=(6.0, 6.0)), 0.4)
    boundary = [int(i) for i in np.unique(mesh.boundary_edges)]
    x, y = mesh.points.T
    bent = np.column_stack([0.02 * x * (y - 5.0), -0.01 * x**2 + 0.05 * y])
    solver = fixed_increments(1, force_tolerance=1e-11, max_iterations=40)
    model = make_model(
        with_node_sets(mesh, boundary), STEEL, solver=solver, prescribed=prescribe({i: bent[i] for i in boundary})
    )
    procedure, reports = run(model)
    assert len(reports) == 1
    return procedure


def move(element, state, displacement):
    """Evaluate one increment from a state to a total displacement of every node; return forces and the new state."""
    procedure = bend(element)
    trial = procedure.at_rest()
    force = procedure.mechanics.evaluate(state, trial, displacement - state.nodes.displacement, with_stiffness=False)
    return force, trial


@pytest.mark.parametrize("element", ELEMENTS)
def test_rigid_motion_of_a_stressed_body_turns_its_stress_and_makes_no_force(element):
    """60 degrees and a translation in one increment: Q sigma Q^T, and Q f of the body that is kept still."""
    procedure = bend(element)
    before, points = procedure.state, procedure.model.mesh.points
    place = (points + before.nodes.displacement) @ Q.T + CARRY
    force, after = move(element, before, place - points)
    still, _ = move(element, before, before.nodes.displacement)
    assert np.ptp(before.cells.stress[0][..., 0]) > 100.0
    assert before.cells.eqps[0].min() > 1e-3
    np.testing.assert_allclose(after.cells.stress[0], turn(before.cells.stress[0]), rtol=0, atol=1e-6)
    np.testing.assert_allclose(after.cells.eqps[0], before.cells.eqps[0], rtol=0, atol=1e-12)
    np.testing.assert_allclose(force, still @ Q.T, rtol=0, atol=1e-8 * np.abs(still).max())


@pytest.mark.parametrize("element", ELEMENTS)
def test_still_body_keeps_its_forces_and_its_equilibrium(element):
    """An increment without displacement changes nothing: the converged state stays in equilibrium."""
    procedure = bend(element)
    before, points = procedure.state, procedure.model.mesh.points
    still, _ = move(element, before, before.nodes.displacement)
    largest = np.abs(before.nodes.reaction).max()
    np.testing.assert_allclose(still, before.nodes.reaction, rtol=0, atol=1e-8 * largest)
    inner = np.setdiff1d(np.arange(len(points)), procedure.model.mesh.boundary_edges)
    assert len(inner) >= 4
    assert np.abs(still[inner]).max() < 1e-8 * largest


@pytest.mark.parametrize("element", ELEMENTS)
def test_deformation_with_a_rotation_on_top_gives_the_turned_answer(element):
    """Frame indifference of the update over one increment: F -> Q F leaves U, and so the unturned stress, alone."""
    procedure = bend(element)
    before, points = procedure.state, procedure.model.mesh.points
    place = (points + before.nodes.displacement) @ Q.T + CARRY
    force, after = move(element, procedure.at_rest(), place - points)
    np.testing.assert_allclose(after.cells.stress[0], turn(before.cells.stress[0]), rtol=0, atol=1e-6)
    np.testing.assert_allclose(after.cells.eqps[0], before.cells.eqps[0], rtol=0, atol=1e-10)
    np.testing.assert_allclose(
        force, before.nodes.reaction @ Q.T, rtol=0, atol=1e-8 * np.abs(before.nodes.reaction).max()
    )
