# SPDX-License-Identifier: Apache-2.0
"""The best solver for a matrix: by factors, or by iteration where those would be too large."""

from __future__ import annotations

from functools import partial

from presswork.implicit.linear.contract import LinearSolver
from presswork.implicit.linear.direct import Pardiso, SuperLU
from presswork.model import IntArray


def make_solver(
    indptr: IntArray, indices: IntArray, *, symmetric: bool, threads: int, freedoms: int = 0
) -> LinearSolver:
    """Return a solver for this pattern (upper triangle only if symmetric).

    By factors, from the best library installed; freedoms: of a node, by iteration.
    """
    direct = partial(_make_direct, indptr, indices, symmetric=symmetric, threads=threads)
    if not freedoms:
        return direct()
    from presswork.implicit.linear.multigrid import Multigrid

    return Multigrid(indptr, indices, symmetric=symmetric, freedoms=freedoms, make_direct=direct)


def _make_direct(indptr: IntArray, indices: IntArray, *, symmetric: bool, threads: int) -> LinearSolver:
    try:
        return Pardiso(indptr, indices, symmetric=symmetric, threads=threads)
    except ImportError:
        return SuperLU(indptr, indices, symmetric=symmetric)
