# SPDX-License-Identifier: Apache-2.0
"""Curved beams that slide over each other (Neto et al. 2016): what a large first increment must find."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.bodies.body_surfaces import InterfaceArrays
from presswork.model import SolverSettings
from tests.problems.sliding_arches import beams, slide

FIRST_WAY = 0.315


def touch(increments: int):
    part = 1.0 / increments
    solver = SolverSettings(initial_increment=part, max_increment=part, symmetric=False)
    return slide(beams(0.0, solver, way=FIRST_WAY))


@pytest.fixture(scope="module")
def at_once():
    return touch(1)


def test_no_slot_pulls_however_large_the_increment(at_once) -> None:
    """All is elastic: one increment must find the forces of twenty. It held slots that pulled by 37 MPa once."""
    rows, procedure = at_once
    fine, finer = touch(20)
    assert procedure.state[InterfaceArrays].pressure.min() >= -1e-3 * procedure.state[InterfaceArrays].pressure.max()
    np.testing.assert_allclose(rows[-1, 1:], fine[-1, 1:], rtol=2e-3)
    energies = [p.energy_balance()["elastic_energy"] for p in (procedure, finer)]
    assert energies[0] == pytest.approx(energies[1], rel=2e-3)


def test_force_between_bodies_is_the_reaction_at_the_feet(at_once) -> None:
    """In the history by the contact's name, as the sum of the field of contact forces, at the supports."""
    rows, procedure = at_once
    on_feet, between = rows[-1, 1:3], rows[-1, 3:]
    np.testing.assert_allclose(between, -on_feet, rtol=1e-3)
    of_nodes = procedure.state[InterfaceArrays].force[list(procedure.model.bodies[0].points)].sum(axis=0)
    np.testing.assert_allclose(between, of_nodes, rtol=1e-9)


@pytest.mark.parametrize(("way", "allowed"), [(FIRST_WAY, 2.0), (3 * FIRST_WAY, 0.2)])
def test_energy_of_a_frictionless_slide_balances_over_an_edge(way, allowed) -> None:
    """Straight edges that slide past each other do work on each other within the length of one, and take it back.

    The pressure acts along the normal of one surface's edges, and the other's are inclined to them. All that the
    balance lacks is this work; nothing of it is left after three edges (0.36 mm long).
    """
    solver = SolverSettings(initial_increment=0.05, max_increment=0.05, symmetric=False)
    procedure = ImplicitProcedure(beams(0.0, solver, way=way), threads=1)
    work, before = 0.0, procedure.state[InterfaceArrays].force
    for _ in procedure.advance():
        state = procedure.state
        work += 0.5 * float(((before + state[InterfaceArrays].force) * state.nodes.increment).sum())
        before = state[InterfaceArrays].force
    energy = procedure.energy_balance()
    assert abs(energy["error_percent"]) < allowed
    lacking = energy["external_work"] - energy["elastic_energy"] - energy["plastic_work"]
    assert lacking == pytest.approx(-work, abs=1e-3 * energy["external_work"])
