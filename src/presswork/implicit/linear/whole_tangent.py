# SPDX-License-Identifier: Apache-2.0
"""Solutions with the whole tangent of an increment in equilibrium, by factors of nearly the same matrix.

The factors of Newton's method are those of the symmetric part, one iteration old. The whole tangent K is assembled
once and only multiplied. Several right-hand sides are solved together by generalised conjugate residuals: a round takes
the ways M^-1 r of what all of them still lack, M the factors, and combines the ways of all rounds and right-hand sides
so that the least is left of each (Saad 2003, Iterative Methods for Sparse Linear Systems, sections 6.9 and 6.12).
Sums run in one order, so that bits do not depend on threads.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from presswork.implicit.linear.system import LinearSystem
from presswork.interaction.contract import Constraints, turn, turn_back
from presswork.model import FloatArray

MOST_ROUNDS = 12
LINEARLY_NEW = 1e-12
"""Part of a way's product that must be new beside those of others."""
STAGNANT = 0.7
"""Part of what was lacking that may be left by a round; where more is, no further one follows."""


class WholeTangent:
    """The tangent at one point of a run.

    system: of the run, with factors. matrix: the tangent before constraints (n, n), in the nodes' own frames.
    length: what freedoms are multiplied by to make them lengths.
    """

    def __init__(
        self, system: LinearSystem, matrix: scipy.sparse.csr_matrix, constraints: Constraints, length: FloatArray
    ) -> None:
        self._system, self._matrix, self._constraints = system, matrix, constraints
        self._free = constraints.mask == 0
        self._weight = (np.ones(constraints.mask.shape) / length).ravel()
        self.rounds = 0
        """Back-substitutions so far, one for each right-hand side."""

    def respond(
        self, forces: Sequence[FloatArray], moves: Sequence[FloatArray], goals: Sequence[float]
    ) -> list[FloatArray]:
        """Return what nodes do under forces where some are moved, all (n_points, freedoms) in the global frame.

        goals: largest force that may be left of each.
        """
        held = self._constraints
        given = [np.where(self._free, 0.0, turn(held, move)).ravel() for move in moves]
        rest = np.array([np.where(self._free, turn(held, force), 0.0).ravel() for force in forces])
        rest -= self._multiply(np.array(given))
        found = self._solve(rest, np.asarray(goals)) + given
        return [turn_back(held, each.reshape(held.mask.shape)) for each in found]

    def _multiply(self, ways: FloatArray) -> FloatArray:
        """Return the forces (k, n) of ways (k, n), without those where nodes are held."""
        return np.where(self._free.ravel(), np.asarray(self._matrix @ ways.T).T, 0.0)

    def _precondition(self, rest: FloatArray) -> FloatArray:
        shape = (len(rest), *self._constraints.mask.shape)
        forces = [turn_back(self._constraints, each) for each in rest.reshape(shape).copy()]
        ways = [turn(self._constraints, way) for way in self._system.respond_to_all(forces)]
        self.rounds += len(ways)
        return np.where(self._free, ways, 0.0).reshape(rest.shape)

    def _solve(self, rest: FloatArray, goal: FloatArray) -> FloatArray:
        """Return the ways of free nodes (k, n) under forces (k, n)."""
        found = np.zeros_like(rest)
        ways, forces = np.zeros((0, rest.shape[1])), np.zeros((0, rest.shape[1]))
        rest = rest * self._weight
        left = np.abs(rest).max(axis=1)
        open_ = np.nonzero(left > goal)[0]
        for _ in range(MOST_ROUNDS):
            if not len(open_):
                break
            # 1. ways by the factors, and what they take, made orthonormal to the others
            new = self._precondition(rest[open_] / self._weight)
            taken = self._multiply(new) * self._weight
            for way, force in zip(new, taken, strict=True):
                before = float(np.linalg.norm(force))
                for _ in range(2):
                    share = np.einsum("mn,n->m", forces, force)
                    force = force - np.einsum("m,mn->n", share, forces)
                    way = way - np.einsum("m,mn->n", share, ways)
                size = float(np.linalg.norm(force))
                if size > LINEARLY_NEW * before:
                    forces, ways = np.vstack([forces, force / size]), np.vstack([ways, way / size])
            # 2. of each right-hand side what they can take
            shares = np.einsum("kn,mn->km", rest, forces)
            rest = rest - np.einsum("km,mn->kn", shares, forces)
            found = found + np.einsum("km,mn->kn", shares, ways)
            before_all, left = left, np.abs(rest).max(axis=1)
            open_ = np.nonzero((left > goal) & (left < STAGNANT * before_all))[0]
        return found
