# SPDX-License-Identifier: Apache-2.0
"""Preconditioners: smoothed aggregation (Vanek, Mandel & Brezina 1996) of displacements, and blocks with pressures.

pyamg makes the levels.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import scipy

from presswork.implicit.linear.krylov import Operator
from presswork.model import FloatArray

COARSEST = 500
"""Freedoms of the level on which sweeps alone solve."""
SWEEPS = 5
"""Number of sweeps of block Gauss-Seidel there, forward and backward."""
DISPLACEMENTS = 3
"""Freedoms of a node before its pressure."""
WEAK = 0.1
"""Couplings of pressures below this part of the diagonal are left out of aggregates."""


def make_preconditioner(matrix: scipy.sparse.bsr_matrix, modes: FloatArray) -> Operator:
    """Return what nearly inverts a symmetric matrix with blocks of displacements, or of these and a pressure.

    modes: rigid motions (n_points * 3, k). With pressures the matrix is [[K, G], [G^T, -C]]; K is inverted by one cycle
    of its levels, and S = C + G^T diag(K)^-1 G by one of its own (Elman, Silvester & Wathen 2014, ch. 4).
    """
    if matrix.blocksize[0] == DISPLACEMENTS:
        cycle: Operator = _make_levels(matrix, modes).aspreconditioner().matvec
        return cycle
    d, (n, _) = DISPLACEMENTS, matrix.shape
    points = n // (d + 1)
    pattern = (matrix.indices, matrix.indptr)
    stiffness = scipy.sparse.bsr_matrix((matrix.data[:, :d, :d].copy(), *pattern), (d * points, d * points))
    gradient = scipy.sparse.bsr_matrix((matrix.data[:, :d, d:].copy(), *pattern), (d * points, points)).tocsr()
    compliance = scipy.sparse.csr_matrix((-matrix.data[:, d, d], *pattern), (points, points))
    divergence = gradient.T.tocsr()
    schur = (compliance + divergence @ scipy.sparse.diags(1.0 / stiffness.diagonal()) @ gradient).tocsr()
    displace = _make_levels(stiffness, modes).aspreconditioner().matvec
    press = _make_levels(schur).aspreconditioner().matvec

    def apply(residual: FloatArray) -> FloatArray:
        residual = residual.reshape(points, d + 1)
        found = np.empty_like(residual)
        moved = displace(np.ascontiguousarray(residual[:, :d]).reshape(-1))
        found[:, :d] = moved.reshape(points, d)
        found[:, d] = press(divergence @ moved - residual[:, d])
        return found.reshape(-1)

    return apply


def _make_levels(matrix: Any, modes: FloatArray | None = None) -> Any:
    """Return the levels of a symmetric positive matrix, with the motions that it hardly resists (n, k)."""
    import pyamg

    with _same_random_numbers():  # by which pyamg estimates the largest eigenvalue
        return pyamg.smoothed_aggregation_solver(
            matrix,
            B=modes,
            strength=("symmetric", {"theta": WEAK if modes is None else 0.0}),
            improve_candidates=None,
            presmoother=("block_gauss_seidel", {"sweep": "forward"}),
            postsmoother=("block_gauss_seidel", {"sweep": "backward"}),
            coarse_solver=("block_gauss_seidel", {"iterations": SWEEPS, "sweep": "symmetric"}),
            max_coarse=COARSEST,
        )


@contextmanager
def _same_random_numbers() -> Iterator[None]:
    kept = np.random.get_state()
    np.random.seed(0)
    try:
        yield
    finally:
        np.random.set_state(kept)
