# SPDX-License-Identifier: Apache-2.0
"""Orders of elimination by coordinates: permutations that keep factors as sparse as METIS does."""

from __future__ import annotations

import numpy as np
import pytest
import scipy

from presswork import _core
from presswork.implicit.linear.choose import find_order
from presswork.implicit.linear.direct import Pardiso
from presswork.implicit.linear.system import flatten


def count_fill(matrix: scipy.sparse.csr_matrix, order: np.ndarray) -> int:
    """Return the entries of Cholesky's factor of a matrix eliminated in an order, by elimination trees' row counts."""
    n = matrix.shape[0]
    permuted = matrix[order][:, order].tocsr()
    parent, fill = np.full(n, -1), n
    for row in range(n):
        seen = {row}
        for column in permuted.indices[permuted.indptr[row] : permuted.indptr[row + 1]].tolist():
            while column < row and column not in seen:
                seen.add(column)
                fill += 1
                if parent[column] < 0:
                    parent[column] = row
                column = int(parent[column])
    return fill


def grid(n_x: int, n_y: int) -> tuple[np.ndarray, scipy.sparse.csr_matrix]:
    """Return the nodes of a rectangle of quadrilaterals, shuffled, and the pattern of its matrix, one row a node."""
    i, j = (a.ravel() for a in np.meshgrid(np.arange(n_x + 1), np.arange(n_y + 1), indexing="ij"))
    near = (np.abs(i[:, None] - i) <= 1) & (np.abs(j[:, None] - j) <= 1)
    mixed = np.random.default_rng(1).permutation(len(i))
    pattern = scipy.sparse.csr_matrix(near[mixed][:, mixed].astype(float))
    return np.column_stack([i, j])[mixed].astype(float), pattern


@pytest.mark.parametrize("shape", [(24, 24), (6, 60), (1, 80)])
def test_fill_is_that_of_nested_dissection(shape):
    """George (1973): about 7.75 n log2 n entries on a square of n nodes; natural orders have n^1.5 and more."""
    points, pattern = grid(*shape)
    order = find_order(points, pattern.indptr, pattern.indices)
    assert np.array_equal(np.sort(order), np.arange(len(points)))
    n = len(points)
    assert count_fill(pattern, order) < 0.25 * 7.75 * n * np.log2(n)
    assert count_fill(pattern, order) < 0.6 * count_fill(pattern, np.arange(n))


def test_order_keeps_the_freedoms_of_a_node_together_and_solves_the_system():
    points, pattern = grid(9, 7)
    whole = scipy.sparse.kron(pattern + 20.0 * scipy.sparse.eye(len(points)), [[2.0, 1.0], [1.0, 3.0]])
    upper = scipy.sparse.triu(whole).tocsr()
    upper.sort_indices()
    order = find_order(points, upper.indptr, upper.indices)
    assert np.array_equal(order[1::2], order[::2] + 1)
    assert np.array_equal(order[::2] // 2, _core.dissect(points, pattern.indptr, pattern.indices))
    pytest.importorskip("pypardiso")
    solver = Pardiso(upper.indptr, upper.indices, symmetric=True, threads=1, order=order)
    solver.factorise(upper.data)
    rhs = np.arange(2.0 * len(points))
    assert whole @ solver.solve(rhs) == pytest.approx(rhs, abs=1e-9)


def test_nodes_that_touch_no_other_and_equal_places_are_ordered():
    points = np.zeros((9, 2))
    alone = scipy.sparse.eye(9).tocsr()
    assert np.array_equal(np.sort(_core.dissect(points, alone.indptr, alone.indices)), np.arange(9))
    full = scipy.sparse.csr_matrix(np.ones((9, 9)))
    assert np.array_equal(np.sort(_core.dissect(points, full.indptr, full.indices)), np.arange(9))


def test_the_plan_of_a_flat_sheet_gives_the_order_of_elimination():
    plan = np.random.default_rng(2).uniform(size=(50, 2))
    sheet = np.insert(100.0 * plan, 1, 3.0 + 0.01 * plan[:, 0], axis=1)
    assert np.array_equal(flatten(sheet), 100.0 * plan)
    assert flatten(np.insert(plan, 2, 0.1 * plan[:, 0], axis=1)) is None
    assert flatten(plan) is plan
