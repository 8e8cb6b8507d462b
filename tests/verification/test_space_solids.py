# SPDX-License-Identifier: Apache-2.0
"""Solids in space against closed forms, the solids in the plane, and published values."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from presswork import model
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.inertia import InertiaArrays
from presswork.mesh.make.structured import mesh_rectangle
from presswork.model import (
    EdgeForce,
    FaceForce,
    FacePressure,
    Hardening,
    Material,
    Model,
    OutputSettings,
    PrescribedDisplacement,
    Stage,
    Support,
)
from tests.problems.space_solids import (
    STEEL,
    SYMMETRY,
    box,
    compute,
    cook_in_space,
    cook_mesh,
    cook_plane_stress,
    cook_plastic,
    make_model,
    mean_rise,
    middle_rise,
    thick_cylinder,
    upper_rise,
)

HEXAHEDRA = ["hex8", "hex8_fbar"]
ELEMENTS = [*HEXAHEDRA, "tet4_mini", "tet10"]


def pull(value: float) -> Stage:
    return Stage("pull", prescribed=(PrescribedDisplacement("right", 0, value),))


@pytest.mark.parametrize("element", ELEMENTS)
def test_distorted_cells_pass_the_patch_test_of_uniaxial_tension(element) -> None:
    """Homogeneous large plastic stretch: the logarithmic strain is exact, and so is the stress, in every cell."""
    mesh = box(element, (12.0, 8.0, 10.0), (3, 3, 3), distort=0.25)
    state = compute(make_model(mesh, SYMMETRY, pull(3.6))).state
    stress = state.cells.stress[0].reshape(-1, 6)
    flow = 565.0 * (0.007 + state.cells.eqps[0]) ** 0.26
    np.testing.assert_allclose(stress[:, 0], flow.ravel(), rtol=1e-9)
    np.testing.assert_allclose(stress[:, 1:], 0.0, atol=1e-4)
    np.testing.assert_allclose(state.cells.eqps[0], np.log(1.3) - stress[:, 0].mean() / 200e3, rtol=1e-8)


@pytest.mark.parametrize("element", ELEMENTS)
def test_pressure_all_round_gives_an_even_hydrostatic_stress(element) -> None:
    mesh = box(element, (5.0, 4.0, 6.0), (2, 3, 2), distort=0.2)
    faces = tuple(FacePressure(side, 300.0) for side in ("right", "top", "front"))
    state = compute(make_model(mesh, SYMMETRY, Stage("press", face_pressures=faces), increments=2)).state
    stress = state.cells.stress[0].reshape(-1, 6)
    np.testing.assert_allclose(stress, np.tile([-300.0, -300.0, -300.0, 0.0, 0.0, 0.0], (len(stress), 1)), atol=1e-5)


def test_traction_on_a_face_is_held_by_the_supports() -> None:
    mesh = box("hex8", (10.0, 2.0, 2.0), (4, 1, 2))
    load = Stage("load", face_forces=(FaceForce("right", (5.0, -2.0, 3.0)),))
    state = compute(make_model(mesh, [Support("left", (True, True, True))], load, increments=2)).state
    np.testing.assert_allclose(state.nodes.reaction[mesh.node_sets["left"]].sum(axis=0), [-20.0, 8.0, -12.0], rtol=1e-8)


def test_a_membrane_held_across_its_plane_is_that_of_quadrilaterals_in_plane_strain() -> None:
    """hex8 with one cell through the thickness against quad4, elastic-plastic and large: the same answer."""
    n, material = 6, Material("soft", 206.9, 0.29, Hardening("linear_voce", np.array([0.45, 0.715, 16.93, 0.12924])))
    held = [Support("left", (True, True, True)), Support("all", (False, False, True))]
    load = Stage("load", face_forces=(FaceForce("right", (0.0, 0.3, 0.0)),))
    in_space = compute(make_model(cook_mesh("hex8", n), held, load, material=material))
    lines = np.linspace(0.0, 1.0, n + 1)
    flat = mesh_rectangle(lines, lines, element="quad4")
    x, y = flat.points.T
    points = np.column_stack([48.0 * x, 44.0 * x + y * (44.0 - 28.0 * x)])
    mesh = model.Mesh(points, flat.blocks, flat.node_sets, flat.edge_sets, flat.boundary_edges)
    plane = Model(
        title="Cook", analysis="plane_strain", depth=1.0, mesh=mesh, materials=(material,), tools=(),
        supports=(Support("left", (True, True)),),
        stages=(Stage("load", edge_forces=(EdgeForce("right", (0.0, 0.3)),)),),
        solver=in_space.model.solver, output=OutputSettings(steps=1),
    )  # fmt: skip
    procedure = ImplicitProcedure(plane, threads=1)
    for _ in procedure.advance():
        pass
    assert in_space.state.cells.eqps[0].max() > 0.01
    assert upper_rise(in_space) == pytest.approx(upper_rise(procedure), rel=1e-8)


@pytest.mark.parametrize(("element", "rise"), [("hex8", 23.21), ("hex8_fbar", 23.58)])
def test_cooks_membrane_in_plane_stress(element, rise) -> None:
    """Published 23.96 in the middle of the end; 16 x 16 cells, one through the thickness, faces free."""
    found = middle_rise(compute(cook_plane_stress(element, 16)))
    assert found == pytest.approx(rise, rel=1e-3)
    assert found == pytest.approx(23.96, rel=0.035)


def test_cooks_membrane_in_space_nearly_incompressible() -> None:
    """8.477 to 8.500 by converged quadratic tetrahedra; 8 x 8 x 2 cells, 16 x 16 x 4 give 8.462."""
    rises = {element: mean_rise(compute(cook_in_space(element, 8, 2))) for element in HEXAHEDRA}
    assert rises["hex8_fbar"] == pytest.approx(8.182, rel=1e-3)
    assert rises["hex8_fbar"] == pytest.approx(8.489, rel=0.04)
    assert rises["hex8"] < 0.4 * 8.489


def test_cooks_membrane_elastic_plastic_does_not_lock_with_fbar() -> None:
    """About 6.9 by enhanced strains on fine meshes (Simo & Armero 1992); 8 x 8 cells, 32 x 32 give 6.867."""
    rises = {element: upper_rise(compute(cook_plastic(element, 8))) for element in ELEMENTS}
    assert rises["hex8_fbar"] == pytest.approx(6.9, rel=0.1)
    assert rises["hex8"] < 0.4 * 6.9


def test_thick_cylinder_yields_as_hill_says() -> None:
    """Outer displacement k c^2 / (2 G b) with the plastic front at c = 1.5 a."""
    procedure = compute(thick_cylinder(16, 16, front=15.0))
    model = procedure.model
    nodes = model.mesh.node_sets["outside"]
    x = model.mesh.points[nodes]
    moved = (procedure.state.nodes.displacement[nodes] * x)[:, :2].sum(axis=1) / 20.0
    shear_modulus = 200e3 / (2.0 * 1.4999)
    closed = 300.0 / np.sqrt(3.0) * 15.0**2 / (2.0 * shear_modulus * 20.0)
    np.testing.assert_allclose(moved, closed, rtol=5e-3)
    radii = np.linalg.norm(model.mesh.points[model.mesh.blocks[0].connectivity].mean(axis=1)[:, :2], axis=1)
    plastic = procedure.state.cells.eqps[0].max(axis=1) > 0.0
    assert 14.5 < radii[plastic].max() < 15.5


@pytest.mark.parametrize("element", ELEMENTS)
def test_newton_converges_quadratically(element) -> None:
    """With the whole tangent each residual is about the square of the one before, relative to 1, or round-off."""
    mesh = box(element, (12.0, 8.0, 10.0), (3, 2, 2), distort=0.2)
    stage = Stage("shear", prescribed=tuple(PrescribedDisplacement("right", a, v) for a, v in ((0, 0.8), (2, 0.8))))
    held = [Support("left", (True, True, True)), Support("right", (False, True, False))]
    procedure = ImplicitProcedure(make_model(mesh, held, stage, symmetric=False), threads=1)
    *_, last = procedure.advance()
    residuals = last.log.residual
    assert len(residuals) <= 5
    assert residuals[-1] < 1e-10
    for before, after in itertools.pairwise(residuals[1:]):
        assert after < 10.0 * before**2 + 1e-11


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_body_that_is_pulled_and_turned_is_as_one_that_is_pulled(element) -> None:
    """Superposed rotation: the same elastic-plastic stretch along x and, turned with the ends, in another frame."""
    mesh = box(element, (6.0, 4.0, 5.0), (2, 2, 2), distort=0.2)
    plain = compute(make_model(mesh, SYMMETRY, pull(1.2))).state
    # a quarter turn about z in the names of the axes: x -> y, y -> -x
    turned_points = np.column_stack([-mesh.points[:, 1], mesh.points[:, 0], mesh.points[:, 2]])
    turned = model.Mesh(
        turned_points, mesh.blocks, mesh.node_sets, {}, mesh.boundary_edges, face_sets=mesh.face_sets,
        boundary_faces=mesh.boundary_faces,
    )  # fmt: skip
    held = [Support("left", (False, True, False)), Support("bottom", (True, False, False)), SYMMETRY[2]]
    stage = Stage("pull", prescribed=(PrescribedDisplacement("right", 1, 1.2),))
    other = compute(make_model(turned, held, stage)).state
    np.testing.assert_allclose(other.cells.stress[0][..., 1], plain.cells.stress[0][..., 0], rtol=1e-9)
    np.testing.assert_allclose(other.cells.eqps[0], plain.cells.eqps[0], rtol=1e-9)


def test_elastic_energy_and_work_balance() -> None:
    mesh = box("hex8_fbar", (10.0, 4.0, 4.0), (4, 2, 2))
    held = [Support("left", (True, True, True))]
    stage = Stage("bend", prescribed=(PrescribedDisplacement("right", 2, 1.5),))
    procedure = compute(make_model(mesh, held, stage, material=STEEL, increments=40))
    assert abs(procedure.energy_balance()["error_percent"]) < 0.3


def test_a_free_block_that_is_pushed_gains_its_impulse() -> None:
    """Backward Euler with the body's mass: force times time is mass times velocity, with nothing to hold it."""
    mesh = box("hex8_fbar", (4.0, 2.0, 3.0), (2, 1, 2))
    material = replace(STEEL, density=7.85e-9)
    push = Stage("push", duration=1e-3, face_forces=(FaceForce("right", (0.5, 0.0, 0.0)),))
    state = compute(
        make_model(mesh, [], push, material=material, increments=5, inertia=1.0, force_tolerance=1e-6)
    ).state
    mass, parts = 7.85e-9 * 24.0, np.arange(1, 6) / 5.0  # the force grows linearly
    np.testing.assert_allclose(
        state[InertiaArrays].velocity.mean(axis=0), [(parts * 3.0 * 2e-4).sum() / mass, 0.0, 0.0], rtol=1e-3, atol=1.0
    )
