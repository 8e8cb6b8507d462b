# SPDX-License-Identifier: Apache-2.0
"""Solutions with the whole tangent of an increment in equilibrium, by factors of nearly the same matrix.

The factors of Newton's method are those of the symmetric part, one iteration old. The whole tangent K is assembled once
and only multiplied. Several right-hand sides are solved together by generalised conjugate residuals: a round takes the
directions M^-1 r of the residual r of each, M the factors, and combines the directions of its rounds so that the
residual is least (Saad 2003, Iterative Methods for Sparse Linear Systems, section 6.9). Sums run in one order, so that
bits do not depend on threads.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from presswork.implicit.linear.system import LinearSystem
from presswork.interaction.contract import Constraints, turn, turn_back
from presswork.model import FloatArray, IndexArray

MOST_ROUNDS = 12
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

    def find_largest(self, force: FloatArray, moves: FloatArray) -> float:
        """Return the largest of given forces, and of those by which given moves of held nodes pull at free ones."""
        held = self._constraints
        given = np.where(self._free, 0.0, turn(held, moves)).ravel()
        pulls = self._multiply(given[None])[0] * self._weight
        return float(max(np.abs(force).max(), np.abs(pulls).max()))

    def find_row(self, motion: FloatArray) -> FloatArray:
        """Return K^T times a motion (n_points, freedoms)."""
        held = self._constraints
        row = np.asarray(self._matrix.T @ turn(held, motion).ravel()).reshape(motion.shape)
        return turn_back(held, row)

    def _multiply(self, directions: FloatArray) -> FloatArray:
        """Return the forces (k, n) of displacements (k, n), without those where nodes are held."""
        return np.where(self._free.ravel(), np.asarray(self._matrix @ directions.T).T, 0.0)

    def _precondition(self, rest: FloatArray) -> FloatArray:
        shape = (len(rest), *self._constraints.mask.shape)
        forces = [turn_back(self._constraints, each) for each in rest.reshape(shape).copy()]
        directions = [turn(self._constraints, direction) for direction in self._system.respond_to_all(forces)]
        self.rounds += len(directions)
        return np.where(self._free, directions, 0.0).reshape(rest.shape)

    def _solve(self, rest: FloatArray, goal: FloatArray) -> FloatArray:
        """Return the displacements of free nodes (k, n) under forces (k, n)."""
        found = np.zeros_like(rest)
        rest = rest * self._weight
        left = np.abs(rest).max(axis=1)
        open_ = np.nonzero(left > goal)[0]
        before: list[tuple[FloatArray, FloatArray]] = []
        for _ in range(MOST_ROUNDS):
            if not len(open_):
                break
            # 1. ways by the factors, and what they take, made orthogonal to those of the rounds before
            direction = self._precondition(rest[open_] / self._weight)
            force = self._multiply(direction) * self._weight
            for directions, forces in before:
                share = _dot(forces[open_], force)
                force -= share * forces[open_]
                direction -= share * directions[open_]
            size = np.sqrt(_dot(force, force))
            scale = np.divide(1.0, size, out=np.zeros_like(size), where=size > 0.0)
            # 2. what each can take of its right-hand side
            force *= scale
            direction *= scale
            share = _dot(rest[open_], force)
            rest[open_] -= share * force
            found[open_] += share * direction
            before.append((_spread(direction, open_, rest), _spread(force, open_, rest)))
            left, left_before = np.abs(rest).max(axis=1), left
            open_ = np.nonzero((left > goal) & (left < STAGNANT * left_before))[0]
        return found


def _dot(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the products of rows with rows (k, 1)."""
    return np.asarray(np.einsum("kn,kn->k", a, b)[:, None])


def _spread(rows: FloatArray, numbers: IndexArray, like: FloatArray) -> FloatArray:
    """Return rows at their numbers, and zeros beside them."""
    found = np.zeros_like(like)
    found[numbers] = rows
    return found
