# SPDX-License-Identifier: Apache-2.0
"""Krylov methods preconditioned by multigrid.

For large bodies in space, whose factors would take long and fill the memory.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy

from presswork.implicit.linear.contract import Iterations, LinearSolver, Modes, SolverError
from presswork.implicit.linear.krylov import NotDefiniteError, solve_symmetric, solve_unsymmetric
from presswork.implicit.linear.preconditioner import DISPLACEMENTS, make_preconditioner
from presswork.model import FloatArray, IntArray

TOLERANCE = 1e-4
"""Residual over the right-hand side: Newton's method loses no iteration by it."""
MOST = 200
"""Iterations after which the matrix is factorised instead."""


class Multigrid:
    """Iterates on one pattern; where that fails, takes the factors of another solver."""

    name = "smoothed aggregation with rigid motions (pyamg)"

    def __init__(
        self,
        indptr: IntArray,
        indices: IntArray,
        *,
        symmetric: bool,
        freedoms: int,
        make_direct: Callable[[], LinearSolver],
    ) -> None:
        """freedoms: of a node. symmetric: indices and values are those of the upper triangle."""
        self._symmetric, self._make_direct = symmetric, make_direct
        # pressures make the matrix indefinite
        self._method = solve_symmetric if symmetric and freedoms == DISPLACEMENTS else solve_unsymmetric
        self._factors: LinearSolver | None = None
        self._is_factorised = False
        self.iterations: Iterations | None = None
        n, count = len(indptr) - 1, len(indices)
        entry = scipy.sparse.csr_matrix((np.arange(1, count + 1, dtype=np.int64), indices, indptr), shape=(n, n))
        mirrored = entry.T.tocsr()
        both = entry + scipy.sparse.triu(entry, 1).T if symmetric else entry
        blocks = both.tobsr((freedoms, freedoms))
        blocks.sort_indices()
        self._from = blocks.data.astype(np.int32)
        """Where a block's values stand (n_blocks, freedoms, freedoms), counted from 1; 0 where there is none."""
        if not symmetric:
            across = mirrored.tobsr((freedoms, freedoms))
            across.sort_indices()
            assert np.array_equal(across.indices, blocks.indices), "the pattern is symmetric"
            self._across = across.data.astype(np.int32)
        self._pattern = (blocks.indices, blocks.indptr)
        self._shape = (n, n)

    @property
    def negative_pivots(self) -> int:
        """Return nothing: the iteration does not find them."""
        return 0

    def factorise(self, data: FloatArray, modes: Modes | None = None) -> None:
        """Make the levels for these values."""
        assert modes is not None, "aggregates move by rigid motions"
        self._data = data
        padded = np.concatenate([[0.0], data])
        self._blocks = near = self._fill(padded[self._from])
        if not self._symmetric:
            near = self._fill(0.5 * (self._blocks.data + padded[self._across]))
        self._is_factorised = False
        self._preconditioner = make_preconditioner(near, modes())

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Return the solution; raises SolverError where neither method finds one."""
        remark = ""
        if not self._is_factorised:
            remark = "the matrix is not positive definite"
            try:
                x, count, residual = self._method(
                    self._blocks.dot, self._preconditioner, rhs, tolerance=TOLERANCE, most=MOST
                )
                if residual <= TOLERANCE:
                    self.iterations = Iterations(count, residual)
                    return x
                remark = f"residual {residual:.1e} after {count} iterations"
            except NotDefiniteError:
                pass
            self._factorise(remark)
        assert self._factors is not None
        x = self._factors.solve(rhs)
        residual = float(np.linalg.norm(rhs - self._blocks.dot(x)) / max(float(np.linalg.norm(rhs)), 1e-300))
        self.iterations = Iterations(0, residual, remark)
        return x

    def solve_all(self, rhs: FloatArray) -> FloatArray:
        """Return the solutions (k, n) one after the other."""
        return np.array([self.solve(each) for each in rhs])

    def _fill(self, values: FloatArray) -> scipy.sparse.bsr_matrix:
        """Return a matrix of its own, since pyamg keeps what it finds out about a matrix in it."""
        return scipy.sparse.bsr_matrix((values, *self._pattern), self._shape)

    def _factorise(self, remark: str) -> None:
        try:
            self._factors = self._factors or self._make_direct()
            self._factors.factorise(self._data)
        except (SolverError, MemoryError) as error:
            raise SolverError(f"{remark}; by factors: {error}") from error
        self._is_factorised = True
