# SPDX-License-Identifier: Apache-2.0
"""States carried from explicit shells to implicit ones and back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from presswork.body.shell_arrays import ShellArrays
from presswork.explicit.shells import ExplicitShells, ShellOptions
from presswork.implicit.stepping import ImplicitProcedure
from presswork.law.elastic_plastic import make_sheet_law
from presswork.mesh.shells import mesh_shell_rectangle
from presswork.model import Hardening, Kinematic, Material, Mesh, Model, Section, Stage, YieldFunction
from presswork.process.mesh_change.transfer import TransferError, carry_to_explicit, carry_to_implicit
from tests.problems.bent_strip import FIRST_YIELD, INERTIA, LENGTH, YOUNG, moment_of, steel, strip
from tests.problems.shells import CLAMPED, RY, RZ, X, Y, Z, fixing, shell_model

STEEL = Material(
    "steel",
    207e3,
    0.3,
    Hardening("swift", np.array([565.0, 0.007, 0.26])),
    yield_function=YieldFunction("hill1948", (0.3, 0.4, 0.6, 1.5, 1.5, 1.8)),
    kinematic=Kinematic("chaboche", {"C": (3000.0, 800.0), "gamma": (40.0, 0.0)}),
    density=7.85e-9,
)
THICKNESS = 1.2
OPTIONS = ShellOptions(n_points=5, rule="lobatto")
ONE = "shell4_1pt"


def make_mesh(points: int = 5, cells: int = 3) -> Mesh:
    lines = np.linspace(0.0, 6.0, cells + 1)
    return mesh_shell_rectangle(
        lines, 0.7 * lines, element="shell4_mitc_plus", section=Section(THICKNESS, points, "lobatto")
    )


def make_model(mesh: Mesh, material: Material = STEEL) -> Model:
    return shell_model(mesh, material, [("left", CLAMPED)])


def _gradient(t: float, axis: np.ndarray) -> np.ndarray:
    """Deformation gradient at t of 1: stretch and shear in the plane, then a rotation in space."""
    stretch = np.eye(3) + t * np.array([[0.06, 0.05, 0.0], [0.0, -0.01, 0.0], [0.0, 0.0, 0.0]])
    return Rotation.from_rotvec(t * axis).as_matrix() @ stretch


def deform(
    mesh: Mesh, *, bend: float = 0.0, material: Material = STEEL, options: ShellOptions = OPTIONS
) -> ExplicitShells:
    """Stretch, shear, bend to a curvature and turn a patch in space, all nodes prescribed."""
    shells = ExplicitShells(
        mesh.points, mesh.blocks[0].connectivity, THICKNESS, make_sheet_law(material), 7.85e-9, options=options
    )
    n, axis = 600, np.array([0.4, 0.7, -0.3])
    every = np.arange(len(mesh.points))
    for step in range(n):
        here, after = (_gradient(t, axis) for t in (step / n, (step + 1) / n))
        velocity = mesh.points @ (after - here).T / shells.dt
        turning = _gradient((step + 0.5) / n, axis)[:, 1]
        spin = (axis + bend * mesh.points[:, :1] * turning) / (n * shells.dt)
        for i in range(3):
            shells.fix(every, "uvw"[i], velocity[:, i])
            shells.fix(every, "pqr"[i], spin[:, i])
        shells.advance(1)
    return shells


def carried(shells: ExplicitShells, mesh: Mesh, material: Material = STEEL) -> ImplicitProcedure:
    procedure = ImplicitProcedure(make_model(mesh, material), threads=1)
    carry_to_implicit(shells, procedure)
    return procedure


@pytest.mark.parametrize(("bend", "element"), [(0.0, ONE), (0.08, ONE), (0.08, "shell4_mitc_plus")])
def test_round_trip_keeps_the_state(bend, element) -> None:
    """Of fully integrated shells at every point."""
    mesh, options = make_mesh(), replace(OPTIONS, element=element)
    shells = deform(mesh, bend=bend, options=options)
    assert shells.equivalent_plastic_strain.max() > 0.03
    assert (np.ptp(shells.stress[..., 0], axis=1) > 50).all() == (bend > 0)
    back = carry_to_explicit(carried(shells, mesh), options=options)
    np.testing.assert_allclose(back.position, shells.position, atol=1e-12)
    np.testing.assert_allclose(back.stress_at_points, shells.stress_at_points, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(back.thickness, shells.thickness, rtol=1e-12)
    np.testing.assert_allclose(back.history_at_points, shells.history_at_points, rtol=1e-9, atol=1e-12)
    assert not back.velocity.any()


def test_forces_of_a_homogeneous_patch_are_the_same() -> None:
    """Stress is as it was in space, whatever frames it is kept in: stretched, sheared and turned, all three states have
    the same nodal forces.
    """
    mesh = make_mesh()
    shells = deform(mesh)
    procedure = carried(shells, mesh)
    state = procedure.state
    wanted = shells.internal_force[:, :3]
    size = np.abs(wanted).max()
    assert size > 100
    np.testing.assert_allclose(
        state.nodes.reaction[:, :3] + state.nodes.external_force[:, :3], wanted, atol=1.5e-4 * size
    )
    back = carry_to_explicit(procedure, options=OPTIONS)
    np.testing.assert_allclose(back.internal_force[:, :3], wanted, atol=1.5e-4 * size)


def test_from_implicit_and_back() -> None:
    """What explicit shells take over from an implicit state they give back to one on their own mesh."""
    mesh = make_mesh()
    first = carried(deform(mesh, bend=0.08), mesh)
    shells = carry_to_explicit(first, options=OPTIONS)
    second = carried(shells, mesh)
    np.testing.assert_allclose(second.state.cells.stress[0], first.state.cells.stress[0], atol=1e-9)
    np.testing.assert_allclose(second.state.cells.history[0], first.state.cells.history[0], atol=1e-9)
    np.testing.assert_allclose(
        second.state[ShellArrays].thickness[0], first.state[ShellArrays].thickness[0], rtol=1e-12
    )
    np.testing.assert_allclose(second.state[ShellArrays].direction[0], first.state[ShellArrays].direction[0], atol=2e-3)


def test_further_cycles_are_those_of_the_state() -> None:
    """Shells begun anew in a deformed state answer as those do that have come there."""
    mesh = make_mesh()
    shells = deform(mesh)
    back = carry_to_explicit(carried(shells, mesh), options=OPTIONS)
    increment = 1e-3 * np.random.default_rng(3).uniform(-1, 1, (len(mesh.points), 6)) * [1, 1, 1, 0, 0, 0]
    one = shells.trial_force(increment) - shells.trial_force(0 * increment)
    other = back.trial_force(increment) - back.trial_force(0 * increment)
    np.testing.assert_allclose(other[:, :3], one[:, :3], atol=2e-3 * np.abs(one[:, :3]).max())


def test_a_state_that_does_not_fit_is_refused() -> None:
    mesh = make_mesh()
    shells = deform(mesh)
    with pytest.raises(TransferError, match="is not that of the explicit shells"):
        carried(shells, make_mesh(cells=4))
    with pytest.raises(TransferError, match="7 points of the lobatto rule, the explicit shells 5"):
        carried(shells, make_mesh(points=7))
    with pytest.raises(TransferError, match="keeps another history"):
        carried(shells, mesh, replace(STEEL, kinematic=None))
    procedure = carried(shells, mesh)
    next(procedure.advance())
    with pytest.raises(TransferError, match="has begun already"):
        carry_to_implicit(shells, procedure)
    simpson = replace(mesh, blocks=(replace(mesh.blocks[0], section=Section(THICKNESS, 5, "simpson")),))
    with pytest.raises(TransferError, match="no Simpson rule"):
        carry_to_explicit(ImplicitProcedure(make_model(simpson), threads=1))


@pytest.mark.parametrize("kinematic", [False, True])
def test_springback_of_a_strip_bent_explicitly(kinematic) -> None:
    """Bent by explicit dynamics, released by the implicit procedure: the strip keeps the curvature k - M(k)/E I, as it
    does when both are implicit (test_shell_plastic.py). Curvatures are those of the circle through the nodes.
    """
    curvature, modulus = 6 * FIRST_YIELD, 0.1 * YOUNG  # with less hardening little moment makes much curvature
    mesh, material = strip(21, "lobatto"), replace(steel(modulus=modulus, kinematic=kinematic), density=7.85e-9)
    held_moment = moment_of(curvature, modulus)
    shells = bend_explicitly(mesh, material, curvature)
    assert shells.energies().kinetic < 1e-4 * shells.energies().internal
    assert curvature_of(shells.position) == pytest.approx(curvature, rel=1e-3)
    held = [("left", fixing(X, Z, RY, RZ)), ("bottom_left", fixing(Y))]
    procedure = ImplicitProcedure(shell_model(mesh, material, held, stages=[Stage("release")]), threads=1)
    carry_to_implicit(shells, procedure)
    moment = procedure.state.nodes.external_force[mesh.node_sets["right"], RY].sum()
    assert moment == pytest.approx(held_moment, rel=1.5e-3)
    for _ in procedure.advance():
        pass
    kept = curvature - held_moment / (YOUNG * INERTIA)
    now = mesh.points + procedure.state.nodes.displacement[:, :3]
    assert curvature_of(now) == pytest.approx(kept, rel=1.5e-3)
    assert procedure.state.nodes.displacement[mesh.node_sets["right"], RY] == pytest.approx(
        (kept - curvature) * LENGTH, rel=1.5e-3
    )
    assert np.abs(procedure.state.nodes.external_force).max() == 0.0
    assert procedure.energy_balance()["error_percent"] == pytest.approx(0.0, abs=0.05)


def bend_explicitly(mesh: Mesh, material: Material, curvature: float) -> ExplicitShells:
    """Turn the right end smoothly in ten periods of the strip's lowest vibration."""
    section = mesh.blocks[0].section
    assert section is not None
    shells = ExplicitShells(
        mesh.points, mesh.blocks[0].connectivity, section.thickness, make_sheet_law(material), material.density,
        options=ShellOptions(n_points=section.points, rule=section.rule),
    )  # fmt: skip
    duration = 5e-3
    n = int(duration / shells.dt)
    shells.fix(mesh.node_sets["left"], "uwqr")
    shells.fix(mesh.node_sets["bottom_left"], "v")
    shells.fix(mesh.node_sets["right"], "q", curvature * LENGTH / (n * shells.dt))
    shells.advance(n, velocity_scale=1 - np.cos(2 * np.pi * (np.arange(n) + 0.5) / n), damping=2e3)
    return shells


def curvature_of(points: np.ndarray) -> float:
    """Curvature of the circle through nodes in the x-z plane, by least squares."""
    x, z = points[:, 0], points[:, 2]
    (a, b, c), *_ = np.linalg.lstsq(np.column_stack([x, z, np.ones_like(x)]), x**2 + z**2, rcond=None)
    return float(1 / np.sqrt(c + 0.25 * (a**2 + b**2)))
