# SPDX-License-Identifier: Apache-2.0
"""Cyclic symmetry: the two faces that cut a sector out of a body in space move alike, turned by the sector's angle.

A node s of the one face and its partner m of the other obey x_s = R x_m, with R the turn about z, for any motion of the
whole that has this symmetry. The equation is linear. A spring k = STIFF E h between the two, h the root of the mean
face beside them, leaves a gap of about 1e-6 h, which no multiplier needs to take back.
"""

from __future__ import annotations

import numpy as np

from presswork.body.solids import Mechanics
from presswork.interaction.contract import Forces, Guess, Interaction
from presswork.mesh.faces import face_areas
from presswork.mesh.space.cyclic import pair_faces, turn_of
from presswork.model import CyclicSector, FloatArray, IntArray, Mesh, Model
from presswork.state import State

STIFF = 1e3
"""Stiffness of the tie over that of the metal, E h."""


class CyclicTies(Interaction):
    """The ties between the two faces of a sector."""

    def __init__(self, model: Model, cells: Mechanics) -> None:
        assert model.cyclic is not None
        self._cyclic, self._cells = model.cyclic, cells
        self._young = max(material.young for material in model.materials)
        self.find_places(model.mesh)

    def find_places(self, mesh: Mesh) -> None:
        """Pair the nodes of the two faces."""
        self._start, self._turn = mesh.points, turn_of(self._cyclic)
        self._first, self._last = pair_faces(self._cyclic, mesh)
        areas = face_areas(mesh.points, mesh.boundary_faces).sum(axis=1)
        self._spring = STIFF * self._young * float(np.sqrt(areas.mean()))
        m, s = self._first, self._last
        self._pairs = np.concatenate([np.column_stack(pair) for pair in ((s, s), (m, m), (s, m), (m, s))])
        self._cells.couple(np.ascontiguousarray(np.unique(self._pairs[2 * len(m) :], axis=0)))

    def evaluate(self, state_n: State, trial: State, guess: Guess) -> Forces:
        """Return the forces of the ties at a guess."""
        x = self._start + guess.displacement[:, :3]
        pull = -self._spring * (x[self._last] - x[self._first] @ self._turn.T)
        force = np.zeros_like(x)
        np.add.at(force, self._last, pull)
        np.add.at(force, self._first, -pull @ self._turn)
        n, freedoms = len(pull), guess.displacement.shape[1]
        blocks = np.zeros((4, n, freedoms, freedoms))
        blocks[:2, :, :3, :3] = self._spring * np.eye(3)
        blocks[2, :, :3, :3] = -self._spring * self._turn
        blocks[3, :, :3, :3] = -self._spring * self._turn.T
        return Forces(force, self._pairs, blocks.reshape(-1, freedoms, freedoms))


def hold_rigid_motions(cyclic: CyclicSector, mesh: Mesh, modes: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return nodes (n,), and what the ties feel there of rigid motions (n, 6).

    modes: the moves of the nodes in these (n_points, 3, 6).
    """
    first, last = pair_faces(cyclic, mesh)
    felt: FloatArray = modes[last] - np.einsum("ij,njk->nik", turn_of(cyclic), modes[first])
    return np.repeat(last, 3), felt.reshape(-1, 6)
