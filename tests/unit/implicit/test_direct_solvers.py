# SPDX-License-Identifier: Apache-2.0
"""PARDISO and SuperLU solve the same systems; a singular matrix is said to be one."""

from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sp

from presswork.implicit.linear import direct
from presswork.implicit.linear.choose import make_solver
from presswork.implicit.linear.contract import SolverError
from presswork.implicit.linear.direct import Pardiso, SuperLU
from presswork.implicit.linear.refined import ENOUGH, RefinedPardiso


def system(symmetric: bool, n: int = 60) -> tuple[sp.csr_matrix, np.ndarray]:
    rng = np.random.default_rng(1)
    matrix = sp.random(n, n, density=0.1, random_state=rng) + 10 * sp.eye(n)
    matrix = (matrix + matrix.T if symmetric else matrix).tocsr()
    matrix.sort_indices()
    return matrix, rng.standard_normal(n)


def need_pardiso() -> None:
    if direct._find_mkl() is None:
        pytest.skip("MKL PARDISO is not installed")


@pytest.mark.parametrize("symmetric", [True, False])
@pytest.mark.parametrize("solver", ["pardiso", "superlu"])
def test_solver_solves(solver, symmetric) -> None:
    if solver == "pardiso":
        need_pardiso()
    matrix, rhs = system(symmetric)
    stored = sp.triu(matrix).tocsr() if symmetric else matrix
    if solver == "pardiso":
        made = Pardiso(stored.indptr, stored.indices, symmetric=symmetric, threads=2)
    else:
        made = SuperLU(stored.indptr, stored.indices, symmetric=symmetric)
    made.factorise(stored.data)
    np.testing.assert_allclose(matrix @ made.solve(rhs), rhs, atol=1e-10)
    made.factorise(2 * stored.data)
    np.testing.assert_allclose(2 * matrix @ made.solve(rhs), rhs, atol=1e-10)


@pytest.mark.parametrize("solver", ["pardiso", "superlu"])
def test_negative_pivots_tell_of_negative_eigenvalues(solver) -> None:
    """PARDISO counts them in a symmetric matrix; SuperLU says whether they are odd."""
    if solver == "pardiso":
        need_pardiso()
    matrix, _ = system(symmetric=True)
    values = np.linalg.eigvalsh(matrix.toarray())
    found = []
    for wanted in range(4):
        shift = 0.5 * (values[wanted - 1] + values[wanted]) if wanted else values[0] - 1.0
        stored = sp.triu(matrix - shift * sp.eye(matrix.shape[0])).tocsr()
        if solver == "pardiso":
            made = Pardiso(stored.indptr, stored.indices, symmetric=True, threads=1)
        else:
            made = SuperLU(stored.indptr, stored.indices, symmetric=True)
        made.factorise(stored.data)
        found.append(made.negative_pivots)
    assert found == ([0, 1, 2, 3] if solver == "pardiso" else [0, 1, 0, 1])


def test_the_bits_do_not_depend_on_the_number_of_threads() -> None:
    need_pardiso()
    matrix, rhs = system(symmetric=False, n=2000)
    solutions = []
    for threads in (1, 2):
        solver = Pardiso(matrix.indptr, matrix.indices, symmetric=False, threads=threads)
        solver.factorise(matrix.data)
        solutions.append(solver.solve(rhs))
    np.testing.assert_array_equal(*solutions)


def refined(matrix: sp.csr_matrix, threads: int = 1) -> RefinedPardiso:
    solver = RefinedPardiso(matrix.indptr, matrix.indices, threads=threads)
    solver.factorise(matrix.data)
    return solver


def test_single_factors_are_refined_to_the_residual_that_is_asked_for() -> None:
    """A condition of 1e6, of which single precision alone leaves more; several right-hand sides of any size."""
    pytest.importorskip("pypardiso")
    matrix, rhs = system(symmetric=False)
    scaled = (sp.diags(np.geomspace(1.0, 1e6, 60)) @ matrix).tocsr()
    scaled.sort_indices()
    several = np.array([rhs, 1e-30 * rhs, 0.0 * rhs])
    alone = Pardiso(scaled.indptr, scaled.indices, symmetric=False, threads=1, single=True)
    alone.factorise(scaled.data)
    solver = refined(scaled)
    for given, found in zip(several, solver.solve_all(several), strict=True):
        assert np.abs(scaled @ found - given).max() <= ENOUGH * np.abs(given).max()
    assert np.abs(scaled @ solver.solve(rhs) - rhs).max() < np.abs(scaled @ alone.solve(rhs).astype(float) - rhs).max()
    assert not solver._is_double


def test_what_single_factors_cannot_solve_is_factorised_in_double() -> None:
    """Two equations that differ by 1e-10 of themselves: in single precision they are the same."""
    pytest.importorskip("pypardiso")
    matrix, rhs = system(symmetric=False)
    whole = matrix.toarray()
    whole[1] = whole[0] * (1.0 + 1e-10)
    whole[1, 1] += 1e-9
    dense = sp.csr_matrix(whole)
    solver = refined(dense)
    found = solver.solve(rhs)
    np.testing.assert_allclose(whole @ found, rhs, atol=1e-4)
    assert solver._is_double
    solver.factorise(dense.data + 0.0)
    assert not solver._is_double


def test_the_bits_of_refined_solutions_do_not_depend_on_the_number_of_threads() -> None:
    pytest.importorskip("pypardiso")
    matrix, rhs = system(symmetric=False, n=2000)
    np.testing.assert_array_equal(*(refined(matrix, threads).solve(rhs) for threads in (1, 2)))


def test_the_library_is_looked_for_once_a_process(monkeypatch) -> None:
    """However many analyses follow; it takes longer than a small one."""
    need_pardiso()
    looked, find = [], direct._find_mkl
    monkeypatch.setattr(direct, "_find_mkl", lambda: (looked.append(1), find())[1])
    direct._load_mkl.cache_clear()
    matrix, rhs = system(symmetric=False)
    for _ in range(3):
        solver = make_solver(matrix.indptr, matrix.indices, symmetric=False, threads=1)
        solver.factorise(matrix.data)
        np.testing.assert_allclose(matrix @ solver.solve(rhs), rhs, atol=1e-10)
    assert len(looked) == 1


def test_library_elsewhere_is_found_by_pypardiso(monkeypatch, tmp_path) -> None:
    wrapper = pytest.importorskip("pypardiso.pardiso_wrapper", exc_type=ImportError)
    library = direct._find_mkl()
    monkeypatch.delenv("PYPARDISO_MKL_RT", raising=False)
    monkeypatch.setattr(direct.sys, "prefix", str(tmp_path))
    monkeypatch.setattr(direct, "_list_mkl_of_package", list)
    monkeypatch.setattr(wrapper, "find_library", lambda name: library)
    assert direct._find_mkl() == library


def test_library_of_the_environment_beneath_is_found_by_its_package(monkeypatch, tmp_path) -> None:
    """As in a virtual environment that sees the packages of another one."""
    need_pardiso()
    library = direct._find_mkl()
    monkeypatch.delenv("PYPARDISO_MKL_RT", raising=False)
    monkeypatch.setattr(direct.sys, "prefix", str(tmp_path))
    found = direct._find_mkl()
    assert found is not None
    assert Path(found).resolve() == Path(library).resolve()


def test_a_singular_matrix_is_an_error() -> None:
    matrix = sp.csr_matrix(np.array([[1.0, 1.0], [1.0, 1.0]]))
    solver = SuperLU(matrix.indptr, matrix.indices, symmetric=False)
    with pytest.raises(SolverError):
        solver.factorise(matrix.data)


def test_superlu_serves_where_pardiso_is_missing(monkeypatch) -> None:
    def missing(*args, **kwargs):
        raise ImportError

    monkeypatch.setattr("presswork.implicit.linear.choose.Pardiso", missing)
    matrix, _ = system(symmetric=False)
    assert "SuperLU" in make_solver(matrix.indptr, matrix.indices, symmetric=False, threads=1).name
