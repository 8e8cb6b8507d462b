# SPDX-License-Identifier: Apache-2.0
"""Contact of a sheet with itself, on both faces and with its thickness: a flange pressed on its panel.

The law is that of a sheet's nodes on tools (space_touch.py), with a shell in place of the tool: a node is pushed off
the shell that it is deepest in, on either face, and the shell's corners bear it. Nodes of both sides are pushed, so two
layers are pressed together by twice the stiffness that each has on a tool. Shells near along the sheet are left out.
cpp/contact/sheet_on_itself.hpp has the forces and their tangent.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from presswork import _core
from presswork.body.shell_arrays import ShellArrays
from presswork.body.shells import ShellMechanics
from presswork.interaction.contract import Forces, Guess, Interaction, Point
from presswork.interaction.space.sheet_contact import SheetNodes
from presswork.interaction.space.space_touch import TANGENTIAL, TouchedNodes, TouchingNodes, choose_touched
from presswork.model import FloatArray, IntArray, Model, take_corners
from presswork.outcome import PassedThrough, Step
from presswork.state import ANEW, RUN, Arrays, OnNewMesh, State

MARGIN = 1.0
"""Thicknesses from touching within which the shells are listed that a node may touch."""
FACES = 2
"""Number of faces of a node, on each of which it may touch a shell."""


@dataclass
class SelfContactArrays(Arrays):
    """What the contact of a sheet with itself keeps; slots are the faces of nodes, two in a row of each."""

    owner = "self_contact"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {
        **dict.fromkeys(("friction", "force", "search_displacement"), ANEW),
        **dict.fromkeys(("energy", "friction_work"), RUN),
    }
    friction: FloatArray
    """Friction on the node, by a shell that it touches (n_slots, 3) [N]."""
    force: FloatArray
    """Force of the sheet on itself, at the nodes (n_points, 3) [N]."""
    search_displacement: FloatArray
    """Displacement at which shells that may touch were last looked for (n_points, 3) [mm]."""
    energy: float
    """Stored by the normal forces [N mm]."""
    friction_work: float
    """Work that friction has taken in the last increment [N mm]."""


@dataclass(frozen=True)
class SelfForces(Forces):
    """Forces of the sheet on itself."""

    touched: TouchedNodes
    """Touched nodes, by slots in place of nodes."""
    shear: FloatArray
    """Friction of the touched slots (n, 3) [N]."""
    slip: FloatArray
    """Way of their nodes along the shells in the increment (n, 3) [mm]."""


class SheetOnItself(Interaction):
    """The contact of one run's sheet with itself."""

    def __init__(self, model: Model, mechanics: ShellMechanics) -> None:
        assert model.self_contact is not None
        self._model, self._mechanics, self._mu = model, mechanics, model.self_contact.mu
        thickest = model.thickest
        corners = [
            np.ascontiguousarray(take_corners(block.connectivity), dtype=np.int32) for block in model.mesh.blocks
        ]
        self._sheet = _core.SheetOnItself(corners, model.mesh.points, thickness=thickest)
        self._margin, self._thickest = MARGIN * thickest, thickest
        self._nodes = SheetNodes(model)
        self._half_cell = np.zeros(sum(len(c) for c in corners))
        self._searched_at: FloatArray | None = None
        self._x_n = model.mesh.points
        self._law_gap: FloatArray | None = None

    def at_rest(self) -> tuple[Arrays, ...]:
        """Return the arrays of a sheet that does not touch itself."""
        n = len(self._model.mesh.points)
        return (SelfContactArrays(np.zeros((FACES * n, 3)), np.zeros((n, 3)), np.zeros((n, 3)), 0.0, 0.0),)

    def begin_increment(self, state_n: State, step: Step) -> None:
        """Take the thickness as it is when the increment begins."""
        self._take_thickness(state_n)
        self._law_gap = None

    def _take_thickness(self, state: State) -> None:
        self._nodes.begin_increment(state)
        self._half_cell = 0.5 * np.concatenate([t.mean(axis=1) for t in state[ShellArrays].thickness])

    def _follow(self, trial: State, displacement: FloatArray) -> None:
        """List the shells near nodes again where these have moved too far since; depends on trial alone."""
        kept = trial[SelfContactArrays]
        if self._has_left(kept.search_displacement, displacement):
            kept.search_displacement = displacement.copy()
        if self._searched_at is None or not np.array_equal(self._searched_at, kept.search_displacement):
            self._searched_at = kept.search_displacement.copy()
            self._mechanics.couple(self._search(kept.search_displacement))

    def _has_left(self, searched_at: FloatArray, displacement: FloatArray) -> bool:
        """Return whether nodes have moved so far since the last search that they might touch shells beyond it."""
        return bool(np.linalg.norm(displacement - searched_at, axis=1).max() > 0.5 * self._margin)

    def _search(self, displacement: FloatArray) -> IntArray:
        """List the shells that nodes may touch until they leave; by the first thickness, so that a resumed run, too,
        finds the same. Return the pairs of nodes that they couple.
        """
        n, half = len(displacement), 0.5 * self._thickest
        half_node, half_cell = np.full(n, half), np.full(len(self._half_cell), half)
        return self._sheet.search(self._places(displacement), half_node, half_cell, self._margin + half)

    def _touching(self) -> TouchingNodes:
        """Return what the law must know of the slots, whose gaps are counted from touching."""
        nodes = self._nodes.touching()
        spring, rounding = np.repeat(nodes.spring, FACES), np.repeat(nodes.rounding, FACES)
        return TouchingNodes(spring, np.zeros_like(spring), rounding, np.repeat(nodes.area, FACES))

    def _look(self, x: FloatArray, x_n: FloatArray, reach: float) -> tuple[IntArray, FloatArray, FloatArray, int]:
        half = 0.5 * self._nodes.thickness
        cell, gap, normal, gone = self._sheet.look(x, x_n, half, self._half_cell, reach)
        return cell, gap, normal, gone

    def evaluate(self, state_n: State, trial: State, guess: Guess) -> SelfForces | PassedThrough:
        """Return the forces of the sheet on itself at a guess."""
        displacement = guess.displacement[:, :3]
        self._follow(trial, displacement)
        before, self._law_gap = self._law_gap, None
        x, x_n = self._places(displacement), self._places(state_n.nodes.displacement[:, :3])
        self._x_n = x_n
        touching = self._touching()
        cell, gap, normal, gone = self._look(x, x_n, touching.farthest)
        if gone >= 0:
            return PassedThrough("self_contact")
        touched = choose_touched((gap, normal), touching, before)
        slots = touched.nodes
        force, pairs, blocks, shear, slip = self._sheet.touch(
            x,
            x_n,
            0.5 * self._nodes.thickness,
            self._half_cell,
            slots.astype(np.int32),
            cell[slots],
            push=touched.push,
            slope=touched.slope,
            hanging=TANGENTIAL * touched.spring,
            shear_n=state_n[SelfContactArrays].friction[slots],
            mu=self._mu,
        )
        return SelfForces(force, pairs, blocks, touched, shear, slip)

    def _places(self, displacement: FloatArray) -> FloatArray:
        return np.ascontiguousarray(self._model.mesh.points + displacement)

    def predict(self, found: Any, change: FloatArray) -> None:
        """Take the law's tangent where a correction asks for it, at the next guess."""
        self._law_gap = np.full(FACES * len(self._model.mesh.points), np.inf)
        self._law_gap[found.touched.nodes] = found.touched.law_gap

    def tune(self, trial: State, point: Point, *, pull: float, credible: float) -> int:
        """Return how many slots the tangent of the law of contact still pushes otherwise than the law."""
        own = next(f for f in point.forces if isinstance(f, SelfForces))
        x = self._places(point.guess.displacement[:, :3])
        _, gap, normal, _ = self._look(x, self._x_n, self._touching().farthest)
        law = choose_touched((gap, normal), self._touching())
        push = np.zeros(FACES * len(x))
        push[own.touched.nodes] = own.touched.push
        push[law.nodes] -= law.push
        return int((np.abs(push) > pull).sum())

    def end_increment(self, state_n: State, trial: State, own: Any, constraints: Any) -> None:
        """Keep what an increment has found."""
        kept, friction_n = trial[SelfContactArrays], state_n[SelfContactArrays].friction
        slots = own.touched.nodes
        kept.friction = np.zeros_like(friction_n)
        kept.friction[slots] = own.shear
        kept.force, kept.energy = own.force, own.touched.energy
        kept.friction_work = -0.5 * float(((friction_n[slots] + own.shear) * own.slip).sum())

    def work(self, state_n: State, trial: State) -> Mapping[str, float]:
        """Return what friction takes [N mm]."""
        return {"friction_work": trial[SelfContactArrays].friction_work}

    def stored(self, state: State) -> float:
        """Return the energy of the normal forces [N mm]."""
        return state[SelfContactArrays].energy

    def find_overlap(self, state: State) -> float:
        """Return by how much the sheet overlaps itself most at a converged state [mm]."""
        self._take_thickness(state)
        displacement = state.nodes.displacement[:, :3]
        if self._searched_at is None or self._has_left(self._searched_at, displacement):
            self._search(displacement)
            self._searched_at = None
        x = self._places(displacement)
        return max(0.0, -float(self._look(x, x, 0.0)[1].min()))
