# SPDX-License-Identifier: Apache-2.0
"""The best solver for a matrix: by factors, or by iteration where those would be too large."""

from __future__ import annotations

from functools import partial

import numpy as np

from presswork import _core
from presswork.implicit.linear.contract import LinearSolver
from presswork.implicit.linear.direct import Pardiso, SuperLU
from presswork.implicit.linear.refined import RefinedPardiso
from presswork.model import FloatArray, IntArray


def make_solver(
    indptr: IntArray,
    indices: IntArray,
    *,
    symmetric: bool,
    threads: int,
    freedoms: int = 0,
    points: FloatArray | None = None,
    may_refine: bool = False,
) -> LinearSolver:
    """Return a solver for this pattern (upper triangle only if symmetric).

    By factors, from the best library installed; freedoms: of a node, by iteration. points: of the nodes, all of which
    have as many rows, of a mesh in the plane (n_points, 2), whose coordinates give the order of elimination.
    may_refine: solutions may be so far off as linear.refined says; unsymmetric matrices get single factors then.
    """
    direct = partial(
        _make_direct, indptr, indices, symmetric=symmetric, threads=threads, points=points, may_refine=may_refine
    )
    if not freedoms:
        return direct()
    from presswork.implicit.linear.multigrid import Multigrid

    return Multigrid(indptr, indices, symmetric=symmetric, freedoms=freedoms, make_direct=direct)


def _make_direct(
    indptr: IntArray, indices: IntArray, *, symmetric: bool, threads: int, points: FloatArray | None, may_refine: bool
) -> LinearSolver:
    try:
        order = None if points is None else find_order(points, indptr, indices)
        if may_refine and not symmetric:
            return RefinedPardiso(indptr, indices, threads=threads, order=order)
        return Pardiso(indptr, indices, symmetric=symmetric, threads=threads, order=order)
    except ImportError:
        return SuperLU(indptr, indices, symmetric=symmetric)


def find_order(points: FloatArray, indptr: IntArray, indices: IntArray) -> IntArray:
    """Return the rows of a pattern in an order of elimination (n,) by the coordinates of its nodes (n_points, 2)."""
    nodes = _core.dissect(np.ascontiguousarray(points), indptr, indices)
    rows = (len(indptr) - 1) // len(nodes)
    return np.asarray((rows * nodes[:, None] + np.arange(rows, dtype=np.int32)).reshape(-1))
