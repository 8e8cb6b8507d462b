# SPDX-License-Identifier: Apache-2.0
"""Curved beams that slide over each other (Neto et al. 2016): what a large first increment must find."""

from __future__ import annotations

import numpy as np
import pytest
from sliding_arches import beams, slide

from presswork.model import SolverSettings

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
    assert procedure.state.interface_pressure.min() >= -1e-3 * procedure.state.interface_pressure.max()
    np.testing.assert_allclose(rows[-1, 1:], fine[-1, 1:], rtol=2e-3)
    energies = [p.energy_balance()["elastic_energy"] for p in (procedure, finer)]
    assert energies[0] == pytest.approx(energies[1], rel=2e-3)


def test_force_between_bodies_is_the_reaction_at_the_feet(at_once) -> None:
    """In the history by the contact's name, as the sum of the field of contact forces, at the supports."""
    rows, procedure = at_once
    on_feet, between = rows[-1, 1:3], rows[-1, 3:]
    np.testing.assert_allclose(between, -on_feet, rtol=1e-3)
    of_nodes = procedure.state.interface_force[list(procedure.model.bodies[0].points)].sum(axis=0)
    np.testing.assert_allclose(between, of_nodes, rtol=1e-9)
