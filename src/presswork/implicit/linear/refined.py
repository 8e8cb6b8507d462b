# SPDX-License-Identifier: Apache-2.0
"""Factors in single precision, solutions refined in double (Wilkinson 1963).

Single factors of a sheet between tools take six tenths of the time of double ones. A step of refinement, one more
substitution and a product with the matrix, brings the residual down by 1e3 to 1e5; one or two of them are enough. Where
they are not the matrix is factorised again in double precision.
"""

from __future__ import annotations

import numpy as np
import scipy

from presswork.implicit.linear.contract import Modes, SolverError
from presswork.implicit.linear.direct import Pardiso
from presswork.model import FloatArray, IntArray

ENOUGH = 1e-5
"""Largest entry of the residual over that of the right-hand side: what a correction leaves out of balance."""
MOST_STEPS = 4


class RefinedPardiso:
    """Solves unsymmetric systems with MKL PARDISO; analysed once in each precision, in double when first asked for."""

    name = "MKL PARDISO, single precision with refinement"
    iterations = None
    negative_pivots = 0

    def __init__(self, indptr: IntArray, indices: IntArray, *, threads: int, order: IntArray | None = None) -> None:
        """order: of elimination (n,); None: METIS finds one."""
        self._pattern, self._threads, self._order = (indices, indptr), threads, order
        self._single = Pardiso(indptr, indices, symmetric=False, threads=threads, order=order, single=True)
        self._double: Pardiso | None = None
        self._is_double = False
        """Whether the present matrix has been factorised in double precision, too."""

    def factorise(self, data: FloatArray, modes: Modes | None = None) -> None:
        n = len(self._pattern[1]) - 1
        self._matrix = scipy.sparse.csr_matrix((np.ascontiguousarray(data), *self._pattern), shape=(n, n))
        self._is_double = False
        try:
            self._single.factorise(data)
        except SolverError:
            self._factorise_in_double()

    def _factorise_in_double(self) -> Pardiso:
        indices, indptr = self._pattern
        if self._double is None:
            self._double = Pardiso(indptr, indices, symmetric=False, threads=self._threads, order=self._order)
        if not self._is_double:
            self._double.factorise(self._matrix.data)
            self._is_double = True
        return self._double

    def solve(self, rhs: FloatArray) -> FloatArray:
        solution: FloatArray = self.solve_all(rhs[None])[0]
        return solution

    def solve_all(self, rhs: FloatArray) -> FloatArray:
        if self._is_double:
            return self._factorise_in_double().solve_all(rhs)
        solution, residual = np.zeros(rhs.shape), rhs
        size = _largest(rhs)
        for _ in range(MOST_STEPS + 1):
            left = _largest(residual)
            solution += self._single.solve_all(residual / left) * left
            residual = rhs - [self._matrix @ row for row in solution]
            if not np.isfinite(residual).all():
                break
            if (np.abs(residual).max(axis=1, keepdims=True) <= ENOUGH * size).all():
                return solution
        return self._factorise_in_double().solve_all(rhs)


def _largest(rows: FloatArray) -> FloatArray:
    """Return the largest entry of each row (k, 1), 1 where all are 0."""
    largest: FloatArray = np.abs(rows).max(axis=1, keepdims=True)
    return np.where(largest > 0.0, largest, 1.0)
