# SPDX-License-Identifier: Apache-2.0
"""Patch tests: every element reproduces a homogeneous deformation of a distorted mesh, also at finite strain.

The closed form: without rotation the sum of the increments' ln U is the total logarithmic strain, so that the elastic
Cauchy stress is lambda tr(ln U) + 2 mu ln U for any number of increments.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.problems.plane_solids import (
    ELEMENTS,
    block_mesh,
    distort,
    drive_boundary,
    elastic,
    fixed_increments,
    run,
)

YOUNG, POISSON = 200e3, 0.3
LAMBDA = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
MU = YOUNG / (2 * (1 + POISSON))


def patch(element, analysis):
    """A distorted 4 x 3 patch of 8 x 6 mm; in axisymmetry at radius 5 mm."""
    origin = (5.0, -2.0) if analysis == "axisymmetric" else (0.0, 0.0)
    return distort(block_mesh(element, (4, 3), origin=origin, size=(8.0, 6.0)), 0.45)


def hooke(log_strain):
    """Cauchy stress xx, yy, zz, xy of the logarithmic strain xx, yy, zz, xy (tensor component)."""
    e = np.asarray(log_strain, dtype=float)
    s = 2 * MU * e
    s[:3] += LAMBDA * e[:3].sum()
    return s


def assert_homogeneous(procedure, stress, displacement):
    state = procedure.state
    scale = np.abs(stress).max()
    for block in state.cells.stress:
        np.testing.assert_allclose(block, np.broadcast_to(stress, block.shape), rtol=0, atol=1e-7 * scale)
    np.testing.assert_allclose(state.nodes.displacement, displacement, rtol=0, atol=1e-7 * np.abs(displacement).max())


@pytest.mark.parametrize("element", ELEMENTS)
def test_element_passes_small_strain_patch_test_in_plane_strain(element):
    """Gradient of 1e-5: what distinguishes the configurations changes the stress by no more than a few 1e-5."""
    gradient = 1e-5 * np.array([[1.0, 0.7], [-0.4, 2.0]])
    solver = fixed_increments(1, strain_measure="small", force_tolerance=1e-9)
    model = drive_boundary(
        patch(element, "plane_strain"),
        [np.eye(2) + gradient],
        elastic(YOUNG, POISSON),
        analysis="plane_strain",
        solver=solver,
    )
    procedure, _ = run(model)
    exact = hooke([gradient[0, 0], gradient[1, 1], 0.0, 0.5 * (gradient[0, 1] + gradient[1, 0])])
    for block in procedure.state.cells.stress:
        np.testing.assert_allclose(block, np.broadcast_to(exact, block.shape), rtol=0, atol=5e-5 * np.abs(exact).max())


@pytest.mark.parametrize("element", ELEMENTS)
def test_element_passes_patch_test_at_30_percent_stretch_in_plane_strain(element):
    F = np.diag([1.3, 0.85])
    mesh = patch(element, "plane_strain")
    model = drive_boundary(mesh, [F], elastic(YOUNG, POISSON), analysis="plane_strain", solver=fixed_increments(3))
    procedure, _ = run(model)
    exact = hooke([np.log(1.3), np.log(0.85), 0.0, 0.0])
    assert_homogeneous(procedure, exact, mesh.points @ (F - np.eye(2)).T)


@pytest.mark.parametrize("element", ELEMENTS)
def test_element_passes_finite_shear_patch_test_in_plane_strain(element):
    """Stretch with shear in one increment: stress R C:ln U R^T, which is C:ln V, from the eigenvectors of F F^T."""
    F = np.array([[1.25, 0.35], [-0.1, 0.9]])
    mesh = patch(element, "plane_strain")
    model = drive_boundary(mesh, [F], elastic(YOUNG, POISSON), analysis="plane_strain", solver=fixed_increments(1))
    procedure, _ = run(model)
    squares, axes = np.linalg.eigh(F @ F.T)
    log_v = axes @ np.diag(0.5 * np.log(squares)) @ axes.T
    exact = hooke([log_v[0, 0], log_v[1, 1], 0.0, log_v[0, 1]])
    assert_homogeneous(procedure, exact, mesh.points @ (F - np.eye(2)).T)


AXISYMMETRIC_F = np.diag([0.88, 1.3])
AXISYMMETRIC_STRESS = hooke([np.log(0.88), np.log(1.3), np.log(0.88), 0.0])


def squeeze_ring(mesh):
    """u_r = -0.12 r, u_z = 0.3 z on the boundary of the mesh."""
    material, solver = elastic(YOUNG, POISSON), fixed_increments(3)
    procedure, _ = run(drive_boundary(mesh, [AXISYMMETRIC_F], material, analysis="axisymmetric", solver=solver))
    return procedure


@pytest.mark.parametrize("element", ELEMENTS)
def test_element_passes_patch_test_at_30_percent_stretch_in_axisymmetry(element):
    mesh = patch(element, "axisymmetric")
    displacement = mesh.points @ (AXISYMMETRIC_F - np.eye(2)).T
    assert_homogeneous(squeeze_ring(mesh), AXISYMMETRIC_STRESS, displacement)
