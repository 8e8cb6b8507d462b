# SPDX-License-Identifier: Apache-2.0
"""The best solver for a matrix: by factors, or by iteration where those would be too large."""

from __future__ import annotations

from functools import partial

import numpy as np

from presswork import _core
from presswork.implicit.linear.contract import LinearSolver
from presswork.implicit.linear.direct import Pardiso, SuperLU
from presswork.implicit.linear.refined import RefinedPardiso
from presswork.implicit.linear.smaller import SmallerSystem
from presswork.model import BoolArray, FloatArray, IntArray


def make_solver(
    indptr: IntArray,
    indices: IntArray,
    *,
    symmetric: bool,
    threads: int,
    freedoms: int = 0,
    points: FloatArray | None = None,
    may_refine: bool = False,
    prescribed: BoolArray | None = None,
) -> LinearSolver:
    """Return a solver for this pattern (upper triangle only if symmetric).

    It uses factors, from the best library installed. freedoms: number of a node, if the solver iterates. points: of the
    nodes, all of which have as many rows, of a mesh in the plane (n_points, 2), whose coordinates give the order of
    elimination.
    may_refine: solutions may have the error that linear.refined states; unsymmetric matrices get single factors then.
    prescribed: rows (n,) that have nothing beside the diagonal in all matrices; factors are found without them.
    """
    order = None if points is None else find_order(points, indptr, indices)
    by_factors = partial(_make_direct, symmetric=symmetric, threads=threads, may_refine=may_refine)
    if freedoms:
        from presswork.implicit.linear.multigrid import Multigrid

        direct = partial(by_factors, indptr, indices, order=order)
        return Multigrid(indptr, indices, symmetric=symmetric, freedoms=freedoms, make_direct=direct)
    if prescribed is None:
        return by_factors(indptr, indices, order=order)
    if order is not None:
        number = np.cumsum(~prescribed, dtype=np.int32) - 1
        order = number[order[~prescribed[order]]]
    return SmallerSystem(indptr, indices, prescribed, partial(by_factors, order=order))


def _make_direct(
    indptr: IntArray, indices: IntArray, *, order: IntArray | None, symmetric: bool, threads: int, may_refine: bool
) -> LinearSolver:
    try:
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
