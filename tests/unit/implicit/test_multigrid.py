# SPDX-License-Identifier: Apache-2.0
"""Multigrid against factors: the same solution, the same bits, and factors where it does not converge."""

import numpy as np
import pytest
import scipy

from presswork.implicit.linear.choose import make_solver
from presswork.implicit.linear.contract import SolverError
from presswork.implicit.linear.krylov import NotDefiniteError, solve_symmetric, solve_unsymmetric
from presswork.implicit.linear.multigrid import Multigrid

SIDE = 8


def rigid_motions(points):
    motions = []
    for axis in np.eye(3):
        motions += [np.broadcast_to(axis, points.shape).reshape(-1), np.cross(axis, points).reshape(-1)]
    return np.column_stack(motions)


def lattice(*, unsymmetric=0.0):
    """Springs between neighbours of a cube of nodes, which rigid motions do not stretch, on soft supports."""
    points = np.stack(np.meshgrid(*[np.arange(SIDE, dtype=float)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    pairs = scipy.spatial.cKDTree(points).query_pairs(1.8, output_type="ndarray")
    n, blocks = 3 * len(points), {}
    for a, b in pairs:
        along = (points[b] - points[a]) / np.linalg.norm(points[b] - points[a])
        stiffness = np.outer(along, along)
        for i, j, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
            blocks[i, j] = blocks.get((i, j), np.zeros((3, 3))) + sign * stiffness
    matrix = scipy.sparse.lil_matrix((n, n))
    for (i, j), block in blocks.items():
        turn = unsymmetric * np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 0]]) if i == j else 0.0
        matrix[3 * i : 3 * i + 3, 3 * j : 3 * j + 3] = block + turn
    matrix = matrix.tocsr() + 1e-3 * scipy.sparse.identity(n)
    return matrix.tocsr(), rigid_motions(points)


def solver_of(matrix, *, symmetric):
    stored = scipy.sparse.triu(matrix).tocsr() if symmetric else matrix
    stored.sort_indices()
    solver = make_solver(stored.indptr, stored.indices, symmetric=symmetric, threads=1, freedoms=3)
    return solver, stored.data


@pytest.mark.parametrize("unsymmetric", [0.0, 0.3])
def test_multigrid_finds_the_solution_of_factors(unsymmetric):
    matrix, motions = lattice(unsymmetric=unsymmetric)
    solver, data = solver_of(matrix, symmetric=unsymmetric == 0.0)
    rhs = np.sin(np.arange(matrix.shape[0]))
    solver.factorise(data, lambda: motions)
    x = solver.solve(rhs)
    assert np.linalg.norm(matrix @ x - rhs) < 2e-4 * np.linalg.norm(rhs)
    assert solver.iterations.remark == ""
    assert 0 < solver.iterations.count < 40


def test_multigrid_gives_the_same_bits_whatever_random_numbers_came_before():
    matrix, motions = lattice()
    found = []
    for seed in (1, 2):
        np.random.seed(seed)
        solver, data = solver_of(matrix, symmetric=True)
        solver.factorise(data, lambda: motions)
        found.append(solver.solve(np.ones(matrix.shape[0])))
        assert np.random.random() == np.random.RandomState(seed).random_sample()
    assert np.array_equal(*found)


def test_a_matrix_that_is_not_positive_definite_is_factorised_and_said_so():
    matrix, motions = lattice()
    shifted = (matrix - 2.0 * scipy.sparse.identity(matrix.shape[0])).tocsr()
    solver, data = solver_of(shifted, symmetric=True)
    rhs = np.cos(np.arange(matrix.shape[0]))
    solver.factorise(data, lambda: motions)
    x = solver.solve(rhs)
    assert np.linalg.norm(shifted @ x - rhs) < 1e-9 * np.linalg.norm(rhs)
    assert "factors" in str(solver.iterations)
    assert "not positive definite" in str(solver.iterations)


def test_a_matrix_that_cannot_be_factorised_either_is_told():
    def fail():
        raise MemoryError("PARDISO has not enough memory")

    matrix, motions = lattice()
    shifted = scipy.sparse.triu(matrix - 2.0 * scipy.sparse.identity(matrix.shape[0])).tocsr()
    solver = Multigrid(shifted.indptr, shifted.indices, symmetric=True, freedoms=3, make_direct=fail)
    solver.factorise(shifted.data, lambda: motions)
    with pytest.raises(SolverError, match=r"not positive definite; .*not enough memory"):
        solver.solve(np.ones(matrix.shape[0]))


@pytest.mark.parametrize("method", [solve_symmetric, solve_unsymmetric])
def test_krylov_methods_end_after_as_many_steps_as_eigenvalues(method):
    matrix = np.diag([1.0, 2.0, 2.0, 5.0])
    rhs = np.array([1.0, -2.0, 3.0, 0.5])
    x, count, residual = method(matrix.dot, lambda v: v, rhs, tolerance=1e-12, most=10)
    np.testing.assert_allclose(x, rhs / np.diag(matrix), rtol=1e-12)
    assert count == 3
    assert residual <= 1e-12


def test_minimal_residuals_start_again_when_their_directions_are_full(monkeypatch):
    monkeypatch.setattr("presswork.implicit.linear.krylov.RESTART", 3)
    generator = np.random.default_rng(1)
    matrix = np.eye(12) * 4 + generator.standard_normal((12, 12)) * 0.4
    rhs = generator.standard_normal(12)
    x, count, _ = solve_unsymmetric(matrix.dot, lambda v: v, rhs, tolerance=1e-10, most=200)
    np.testing.assert_allclose(matrix @ x, rhs, atol=1e-8)
    assert count > 3


def test_conjugate_gradients_refuse_a_matrix_that_is_not_definite():
    with pytest.raises(NotDefiniteError):
        solve_symmetric(np.diag([1.0, -1.0]).dot, lambda v: v, np.ones(2), tolerance=1e-8, most=5)
