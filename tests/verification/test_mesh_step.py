# SPDX-License-Identifier: Apache-2.0
"""The stable step of a mesh of shells over that of its worst shell, against closed forms and LAPACK's eigenvalues."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eigvalsh

from presswork import _core
from presswork.explicit.mesh_step import MeshStep
from presswork.explicit.shells import ExplicitShells, ShellOptions
from presswork.explicit.space import Precision
from presswork.mesh.split import SplitMesh
from tests.problems.explicit_shells import DENSITY, POISSON, grid, mises, stiffness, triangles


def find(shells: ExplicitShells, last: float = 0.0, precision: Precision = "double") -> float:
    return MeshStep(shells, precision).find_factor(shells, last)


def by_matrix(shells: ExplicitShells) -> float:
    """The same from all eigenvalues of the assembled matrix."""
    matrix, mass = stiffness(shells), np.repeat(shells.mass, 3, axis=1).ravel()
    used = mass > 0
    root = np.sqrt(mass[used])
    highest = eigvalsh(0.5 * (matrix + matrix.T)[np.ix_(used, used)] / np.outer(root, root))[-1]
    return float(2.0 / np.sqrt(highest) / shells.stable_step())


@pytest.mark.parametrize("precision", ["double", "single"])
def test_squares_of_one_point_step_as_bars_do(precision: Precision) -> None:
    """The highest mode of a wide mesh, neighbours against each other along x, strains its squares in one direction.

    So w = 2 c/h, c^2 = E/(rho (1 - nu^2)); a square by itself is stretched both ways, w^2 = 4 (1 + nu) c^2/h^2.
    """
    shells = ExplicitShells(*grid(40, 40, 40, 40), 0.5, mises(), DENSITY, precision=precision)
    assert find(shells, precision=precision) == pytest.approx(np.sqrt(1 + POISSON), rel=4e-3)


@pytest.mark.parametrize("kind", ["distorted", "cylinder", "triangles", "mitc", "scaled", "oblong"])
def test_the_step_is_that_of_the_assembled_matrix(kind: str) -> None:
    """Of sheets in any shape, of any elements; from a first try, and from a last answer that is too low or too high."""
    points, cells = grid(5, 4, 10, 8, distort=0.25 if kind == "distorted" else 0.0)
    if kind == "cylinder":
        points = np.stack([6 * np.sin(points[:, 0] / 6), points[:, 1], 6 * np.cos(points[:, 0] / 6)], axis=1)
    if kind == "triangles":
        cells = triangles(cells, np.arange(len(cells)) % 3 == 0)
    options = ShellOptions(element="shell4_mitc_plus" if kind == "mitc" else "shell4_1pt")
    law = mises("swift", (50.0, 0.001, 0.2)) if kind == "oblong" else mises()  # soft: the motions must stay elastic
    if kind == "oblong":  # bears hardly more than its shells, so the first try is far too long
        points[:, 1] *= 3.5
    shells = ExplicitShells(points, cells, 0.5, law, DENSITY, options=options)
    if kind == "scaled":
        shells.scale_mass(1.3 * shells.stable_step())
    expected = by_matrix(shells)
    assert 1.0 < expected < (1.05 if kind == "oblong" else 1.5)
    for last in (0.0, 0.97 * expected, 1.2 * expected):
        assert find(shells, last) == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize(("factor", "grows"), [(0.98, False), (1.02, True)])
def test_a_sheet_with_hanging_nodes_is_stable_just_below_the_step(factor: float, grows: bool) -> None:
    points, cells = grid(5, 4, 10, 8)
    mesh = SplitMesh.begin(cells, len(points))
    step = mesh.split(np.arange(len(cells)) < 7)
    hanging = step.mesh.hanging()
    assert len(hanging) > 0
    shells = ExplicitShells(step.interpolate(points), step.mesh.cells, 0.5, mises(), DENSITY, hanging=hanging)
    found = find(shells)
    assert found > 1.05
    shells.velocity = 1e-12 * np.random.default_rng(2).standard_normal((len(shells.start), 6))
    first = np.abs(shells.velocity).max()
    shells.dt = factor * found * shells.stable_step()
    shells.advance(60)
    assert (np.abs(shells.velocity).max() > 100 * first) == grows


def test_it_rises_by_no_more_than_was_tried() -> None:
    shells = ExplicitShells(*grid(10, 10, 10, 10), 0.5, mises(), DENSITY)
    assert find(shells, 1.02) == pytest.approx(1.06 * 1.02, rel=1e-12)


def test_the_state_of_the_sheet_counts_as_little_as_it_is_changed() -> None:
    """A sheet that has yielded and moves steps like a new one in its place; it goes on with the same bits."""
    law = mises("swift", (565.0, 0.007, 0.26))
    pulled, other = (ExplicitShells(*grid(8, 8, 8, 8), 0.5, law, DENSITY) for _ in range(2))
    for shells in (pulled, other):
        shells.velocity = np.concatenate([40e3 * (shells.position - 4), 0 * shells.position], axis=1)
        shells.advance(60)
    assert (pulled.equivalent_plastic_strain > 0.01).any()
    new = ExplicitShells(pulled.position, pulled.connectivity, pulled.thickness, law, DENSITY)
    assert find(pulled) == pytest.approx(find(new), rel=5e-3)
    for shells in (pulled, other):
        shells.advance(60)
    assert (pulled.position == other.position).all()


def test_the_step_has_the_same_bits_with_any_number_of_threads() -> None:
    shells = ExplicitShells(*grid(40, 30, 40, 30, distort=0.2), 0.5, mises(), DENSITY)
    found, before = set(), _core.max_threads()
    try:
        for threads in (1, 2, 3):
            _core.set_threads(threads)
            found.add(find(shells))
    finally:
        _core.set_threads(before)
    assert len(found) == 1
