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
ENOUGH = 0.7
"""Part of a force that is left by taking the others out of it, above which once is enough."""
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
        found, basis = np.zeros_like(rest), _Basis(rest.shape)
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
                basis.add(way, force)
            # 2. of each right-hand side what they can take
            shares = np.einsum("kn,mn->km", rest, basis.forces)
            rest -= np.einsum("km,mn->kn", shares, basis.forces)
            found += np.einsum("km,mn->kn", shares, basis.ways)
            before_all, left = left, np.abs(rest).max(axis=1)
            open_ = np.nonzero((left > goal) & (left < STAGNANT * before_all))[0]
        return found


class _Basis:
    """Ways, and the orthonormal forces that they take. shape: right-hand sides and freedoms (k, n)."""

    def __init__(self, shape: tuple[int, ...]) -> None:
        self._count = 0
        self._ways, self._forces = np.empty((4 * shape[0], shape[1])), np.empty((4 * shape[0], shape[1]))

    @property
    def ways(self) -> FloatArray:
        """So far (m, n)."""
        return self._ways[: self._count]

    @property
    def forces(self) -> FloatArray:
        """So far (m, n)."""
        return self._forces[: self._count]

    def add(self, way: FloatArray, force: FloatArray) -> None:
        """Add a way and its force (n,), made orthonormal to the others, if it is new beside them."""
        before = size = float(np.linalg.norm(force))
        for _ in range(2):
            share = np.einsum("mn,n->m", self.forces, force)
            force = force - np.einsum("m,mn->n", share, self.forces)
            way = way - np.einsum("m,mn->n", share, self.ways)
            last, size = size, float(np.linalg.norm(force))
            if size > ENOUGH * last:  # orthogonal to round-off
                break
        if size <= LINEARLY_NEW * before:
            return
        if self._count == len(self._ways):
            self._ways, self._forces = (np.concatenate([of, np.empty_like(of)]) for of in (self._ways, self._forces))
        self._ways[self._count], self._forces[self._count] = way / size, force / size
        self._count += 1
