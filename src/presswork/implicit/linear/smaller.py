# SPDX-License-Identifier: Apache-2.0
"""Systems without the rows that are prescribed all through a run, such as the drilling rotations of a smooth sheet.

A prescribed row has nothing beside its diagonal entry, but factors are found for the pattern, which has all its
columns. A sixth of the rows left out saves three tenths of the time of factors.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from presswork.implicit.linear.contract import Iterations, LinearSolver, Modes
from presswork.model import BoolArray, FloatArray, IntArray


class SmallerSystem:
    """Solves systems of one pattern by a solver for the rows that are not always prescribed."""

    def __init__(
        self,
        indptr: IntArray,
        indices: IntArray,
        prescribed: BoolArray,
        make: Callable[[IntArray, IntArray], LinearSolver],
    ) -> None:
        """prescribed: rows (n,) with nothing beside the diagonal. make: the solver of the rest, for its pattern."""
        row = np.repeat(np.arange(len(prescribed)), np.diff(indptr))
        kept = ~prescribed
        self._entries = np.flatnonzero(kept[row] & kept[indices])
        self._kept, self._prescribed = np.flatnonzero(kept), np.flatnonzero(prescribed)
        self._diagonal = np.flatnonzero((row == indices) & prescribed[row])
        number = (np.cumsum(kept) - 1).astype(np.int32)
        lengths = np.bincount(number[row[self._entries]], minlength=len(self._kept))
        starts = np.concatenate([[0], np.cumsum(lengths)]).astype(np.int32)
        self._solver = make(starts, number[indices[self._entries]])
        self._scale = np.ones(len(self._prescribed))
        self.name = self._solver.name

    @property
    def negative_pivots(self) -> int:
        return self._solver.negative_pivots

    @property
    def iterations(self) -> Iterations | None:
        return self._solver.iterations

    def factorise(self, data: FloatArray, modes: Modes | None = None) -> None:
        self._scale = data[self._diagonal]
        self._solver.factorise(data[self._entries], modes)

    def solve(self, rhs: FloatArray) -> FloatArray:
        solution: FloatArray = self.solve_all(rhs[None])[0]
        return solution

    def solve_all(self, rhs: FloatArray) -> FloatArray:
        found = self._solver.solve_all(rhs.take(self._kept, axis=1))
        solution = np.empty(rhs.shape)
        for row, load, own in zip(solution, rhs, found, strict=True):  # by rows: three times as fast as by columns
            row[self._prescribed] = load[self._prescribed] / self._scale
            row[self._kept] = own
        return solution
