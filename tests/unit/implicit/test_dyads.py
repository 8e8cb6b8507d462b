# SPDX-License-Identifier: Apache-2.0
"""Parts of a tangent that couple all nodes, beside its factors."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.implicit.linear.dyads import Dyads

rng = np.random.default_rng(3)


@pytest.mark.parametrize("n", [1, 2])
def test_solutions_are_those_of_the_whole_matrix(n: int) -> None:
    """A matrix of 12 freedoms and n dyads, whose columns and rows differ, for three right-hand sides."""
    matrix, columns, rows, rhs = rng.random((12, 12)), rng.random((n, 12)), rng.random((n, 12)), rng.random((3, 12))
    answers = np.linalg.solve(matrix, columns.T).T.reshape(n, 4, 3)
    dyads = Dyads(list(rows.reshape(n, 4, 3)), answers)
    found = dyads.correct(np.linalg.solve(matrix, rhs.T).T.reshape(3, 4, 3)).reshape(3, 12)
    np.testing.assert_allclose(found @ (matrix + columns.T @ rows).T, rhs, rtol=1e-9, atol=1e-9)


def test_it_counts_by_how_many_the_negative_eigenvalues_fall() -> None:
    """A softening direction that a stiff dyad holds."""
    matrix, column = np.diag([2.0, -1.0, 3.0]), np.array([[0.0, 4.0, 0.0]])
    dyads = Dyads([column], np.linalg.solve(matrix, column.T).T.reshape(1, 1, 3))
    whole = np.linalg.eigvalsh(matrix + column.T @ column)
    assert dyads.n_negative == 1 - int((whole < 0.0).sum()) == 1
