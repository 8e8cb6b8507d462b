# SPDX-License-Identifier: Apache-2.0
"""An interaction of one's own, written here alone: an elastic foundation under a block.

Springs of stiffness k [N/mm] a node stand under the bottom of a block that a force pulls down and whose top is held.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from presswork import build_model
from presswork.case import Case
from presswork.implicit.epochs import new_epoch
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.contract import Forces, Guess, Interaction
from presswork.interaction.supports import NotHeldError
from presswork.model import FloatArray, IntArray, Mesh
from presswork.state import Arrays, State
from tests.problems.renumbered import renumber

STIFFNESS, FORCE, CELLS = 50.0, 300.0, 4

BLOCK: dict[str, Any] = {
    "title": "block on springs",
    "analysis": "plane_strain",
    "workpiece": {
        "material": "steel",
        "element": "quad4_fbar",
        "mesh": {"kind": "rectangle", "size": [10.0, 10.0], "cells": [CELLS, CELLS]},
    },
    "materials": {
        "steel": {
            "young": 200000.0,
            "poisson": 0.3,
            "hardening": {"law": "linear", "yield_stress": 400.0, "modulus": 1000.0},
        }
    },
    "boundary": {"side": {"set": "left", "fix": ["x"]}, "anchor": {"set": "top", "fix": ["y"]}},
    "stages": [{"name": "pull", "force": [{"set": "bottom", "value": [0.0, -FORCE]}]}],
}


@dataclass
class FoundationArrays(Arrays):
    owner = "foundation"
    force: FloatArray
    """Of each spring on its node, along y (n_springs,) [N]."""


class SpringFoundation(Interaction):
    """Springs between nodes and the ground, along y."""

    def __init__(self, node_set: str, stiffness: float) -> None:
        self._node_set, self._stiffness = node_set, stiffness

    def find_places(self, mesh: Mesh) -> None:
        self._nodes, self._n_points = mesh.node_sets[self._node_set], len(mesh.points)

    def at_rest(self) -> tuple[Arrays, ...]:
        return (FoundationArrays(np.zeros(len(self._nodes))),)

    def evaluate(self, state_n: State, trial: State, guess: Guess) -> Forces:
        force = np.zeros((self._n_points, 2))
        force[self._nodes, 1] = -self._stiffness * guess.displacement[self._nodes, 1]
        blocks = np.zeros((len(self._nodes), 2, 2))
        blocks[:, 1, 1] = self._stiffness
        return Forces(force, np.column_stack([self._nodes, self._nodes]).astype(np.int32), blocks)

    def end_increment(self, state_n: State, trial: State, own: Any, constraints: Any) -> None:
        trial[FoundationArrays].force = own.force[self._nodes, 1]

    def stored(self, state: State) -> float:
        return float((state[FoundationArrays].force ** 2).sum()) / (2 * self._stiffness)


def make(stiffness: float = STIFFNESS) -> tuple[ImplicitProcedure, IntArray]:
    model = build_model(Case.model_validate(BLOCK))
    bottom = model.mesh.node_sets["bottom"]
    foundation = SpringFoundation("bottom", stiffness)
    return ImplicitProcedure(model, others=(foundation,)), bottom


def test_springs_take_their_share_of_the_force() -> None:
    """The block's own stiffness, found without springs, and the springs act side by side on a bottom that they move."""
    procedure, bottom = make()
    for _ in procedure.advance():
        pass
    state = procedure.state
    on_springs = float(state[FoundationArrays].force.sum())
    assert on_springs == pytest.approx(-STIFFNESS * state.nodes.displacement[bottom, 1].sum(), rel=1e-12)
    top = float(state.nodes.reaction[procedure.model.mesh.node_sets["top"], 1].sum())
    assert top + on_springs == pytest.approx(FORCE, rel=1e-6), "top and springs carry the force together"
    assert abs(procedure.energy_balance()["error_percent"]) < 1e-2


def test_its_arrays_are_part_of_a_checkpoint() -> None:
    procedure, _ = make()
    arrays = procedure.state.to_arrays()
    assert "foundation.force" in arrays
    other, _ = make()
    for _ in procedure.advance():
        pass
    other.state.load_arrays(procedure.state.to_arrays())
    found, wanted = (p.state[FoundationArrays].force for p in (other, procedure))
    np.testing.assert_array_equal(found, wanted)


def test_it_finds_its_places_anew_when_the_mesh_changes() -> None:
    """Half of the run is computed on the same mesh with other numbers: the springs carry what they carry without."""
    whole, bottom = make()
    for _ in whole.advance():
        pass
    first, _ = make()
    for _ in range(len(list(make()[0].advance())) // 2):
        next(first.advance())
    change = renumber(first.model.mesh)
    second = new_epoch(first, change.mesh, change.transfer)
    for _ in second.advance():
        pass
    moved = second.state.nodes.displacement[second.model.mesh.node_sets["bottom"], 1]
    np.testing.assert_allclose(np.sort(moved), np.sort(whole.state.nodes.displacement[bottom, 1]), rtol=1e-9)
    on_springs = [float(p.state[FoundationArrays].force.sum()) for p in (second, whole)]
    assert on_springs[0] == pytest.approx(on_springs[1], rel=1e-9)


def test_iteration_is_quadratic_with_it() -> None:
    procedure, _ = make()
    reports = list(procedure.advance())
    assert max(len(r.log) for r in reports) <= 4


def test_a_held_block_is_asked_for() -> None:
    """What an interaction of one's own holds is not known before the run: supports are still needed."""
    with pytest.raises(NotHeldError):
        ImplicitProcedure(build_model(Case.model_validate(BLOCK | {"boundary": {"side": BLOCK["boundary"]["side"]}})))
