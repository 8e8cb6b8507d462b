# SPDX-License-Identifier: Apache-2.0
"""Rows that are prescribed all through a run are left out of the factors, and of shells these are the drilling."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

from presswork.implicit.linear.choose import make_solver
from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import Material
from tests.problems.plane_solids import linear_hardening
from tests.problems.shells import CLAMPED, X, join, patch, shell_model, symmetry


@pytest.mark.parametrize("symmetric", [True, False])
@pytest.mark.parametrize("ordered", [True, False])
def test_solutions_are_those_of_the_whole_system(symmetric, ordered) -> None:
    rng = np.random.default_rng(3)
    prescribed = np.tile([False, True, False], 20)
    prescribed[[3, 10]] = [True, False]
    matrix = sp.random(60, 60, density=0.2, random_state=rng).toarray()
    matrix = matrix + matrix.T if symmetric else matrix
    matrix[prescribed] = matrix[:, prescribed] = 0.0
    matrix += np.diag(rng.uniform(10.0, 20.0, 60))
    pattern = sp.csr_matrix(np.triu(np.ones((60, 60))) if symmetric else np.ones((60, 60)))
    data = matrix[np.repeat(np.arange(60), np.diff(pattern.indptr)), pattern.indices]
    points = rng.uniform(size=(20, 2)) if ordered else None
    solver = make_solver(
        pattern.indptr, pattern.indices, symmetric=symmetric, threads=1, points=points, prescribed=prescribed
    )
    solver.factorise(data)
    rhs = rng.standard_normal((2, 60))
    np.testing.assert_allclose(solver.solve_all(rhs) @ matrix.T, rhs, atol=1e-10)
    np.testing.assert_allclose(matrix @ solver.solve(rhs[0]), rhs[0], atol=1e-10)


def test_drilling_of_a_smooth_sheet_is_prescribed_and_that_of_a_fold_is_not() -> None:
    """Two panels at 60 degrees to each other, clamped at one end; the other lies on a plane of symmetry."""
    lines = np.linspace(0.0, 1.0, 4)
    flat = patch(lambda u, v: np.column_stack([u - 1.0, v, 0.0 * u]), lines, lines)
    risen = patch(lambda u, v: np.column_stack([0.5 * u, v, 0.75**0.5 * u]), lines, lines)
    mesh = join([flat, risen])
    x = mesh.points[:, 0]
    mesh = replace(mesh, node_sets={"clamp": np.flatnonzero(x < -0.99), "plane": np.flatnonzero(x > 0.49)})
    steel = Material("steel", 210e3, 0.3, linear_hardening(1e6, 0.0))
    model = shell_model(mesh, steel, [("clamp", CLAMPED), ("plane", symmetry(X))])
    procedure = ImplicitProcedure(model, threads=1)
    drilling = procedure.mechanics.drilling.reshape(-1, 6)
    assert np.array_equal(drilling.any(axis=1), np.abs(x) > 1e-9)
    state = procedure.state
    held = procedure.interactions.supports.prescribe(state, 0, 1.0, np.zeros_like(state.nodes.increment))
    assert held.mask[drilling].all()
