# SPDX-License-Identifier: Apache-2.0
"""Loads on shells: totals, the stiffness of a pressure, moments on rotation vectors, what stages release."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import EdgeForce, PrescribedDisplacement, ShellPressure, Stage
from tests.problems.plane_solids import elastic
from tests.problems.shells import CLAMPED, RY, Z, patch, shell_model


def procedure_of(*stages: Stage, thickness: float = 0.5) -> ImplicitProcedure:
    mesh = patch(lambda u, v: np.column_stack([u, v, 0.05 * u * v]), np.linspace(0, 4, 4), np.linspace(0, 3, 3),
                 thickness=thickness)  # fmt: skip
    model = shell_model(mesh, elastic(1e5, 0.3), [("left", CLAMPED)], stages=stages, initial_increment=0.25,
                        max_increment=0.25)  # fmt: skip
    return ImplicitProcedure(model, threads=1)


def test_totals_are_force_per_length_area_and_volume() -> None:
    from presswork.model import BodyForce

    flat = patch(lambda u, v: np.column_stack([u, v, 0 * u]), np.linspace(0, 4, 4), np.linspace(0, 3, 3), thickness=0.5)
    stage = Stage("load", edge_forces=(EdgeForce("right", (2.0, 0, 1.0)),), body_forces=(BodyForce((0, 3.0, 0)),),
                  shell_pressures=(ShellPressure("all", 0.7),))  # fmt: skip
    procedure = ImplicitProcedure(shell_model(flat, elastic(1e5, 0.3), [("left", CLAMPED)], stages=[stage]), threads=1)
    loads = procedure.interactions.loads.at(procedure.state, np.zeros((len(flat.points), 6)), 0, 0.5)
    total = loads.force.sum(axis=0)
    np.testing.assert_allclose(total, [0.5 * 6, 0.5 * 3 * 4 * 3 * 0.5, 0.5 * (3 + 0.7 * 12), 0, 0, 0], atol=1e-12)


def test_stiffness_of_a_pressure_is_its_derivative() -> None:
    procedure = procedure_of(Stage("press", shell_pressures=(ShellPressure("all", 0.7),)))
    n = len(procedure.model.mesh.points)
    increment = np.random.default_rng(0).normal(size=(n, 6)) * 0.1
    loads = procedure.interactions.loads.at(procedure.state, increment, 0, 1.0)
    dense = np.zeros((n, 6, n, 6))
    for (a, b), block in zip(loads.pairs, loads.blocks, strict=True):
        dense[a, :, b] += block
    step = 1e-5
    for a in range(n):
        for i in range(3):
            change = np.zeros_like(increment)
            change[a, i] = step
            sides = (procedure.interactions.loads.at(procedure.state, increment + s * change, 0, 1.0) for s in (1, -1))
            forces = [side.force for side in sides]
            np.testing.assert_allclose(-dense[:, :, a, i], (forces[0] - forces[1]) / (2 * step), atol=1e-8)


def test_a_moment_does_the_work_of_a_spin() -> None:
    """Its force on the rotation vector times a small change is the moment times the spin that the change makes."""
    procedure = procedure_of(Stage("twist", edge_forces=(EdgeForce("right", (0, 0, 0, 0.3, -0.4, 0.0)),)))
    n = len(procedure.model.mesh.points)
    increment = np.zeros((n, 6))
    theta = np.array([0.4, 0.7, 0.0])
    increment[:, 3:] = theta
    force = procedure.interactions.loads.at(procedure.state, increment, 0, 1.0).force
    mesh = procedure.model.mesh
    node = mesh.node_sets["bottom_right"][0]
    edge = mesh.edge_sets["right"][(mesh.edge_sets["right"] == node).any(axis=1)][0]
    share = 0.5 * np.linalg.norm(np.diff(mesh.points[edge], axis=0))
    moment = share * np.array([0.3, -0.4, 0.0])
    found = procedure.mechanics.directors
    director = Rotation.from_rotvec(theta).apply(found.vectors[found.node == node][0])
    moment = moment - (moment @ director) * director  # about the director it does nothing
    for i in range(3):
        change = np.zeros(3)
        change[i] = 1e-6
        spin = (Rotation.from_rotvec(theta + change) * Rotation.from_rotvec(theta - change).inv()).as_rotvec() / 2e-6
        assert force[node, 3 + i] == pytest.approx(float(moment @ spin), rel=1e-6)


def test_what_a_stage_holds_is_released_over_the_next() -> None:
    """Let go of, the end of a strip comes back with the stage, not at its first increment."""
    bend = Stage("bend", prescribed=(PrescribedDisplacement("right", Z, 0.4),))
    procedure = procedure_of(bend, Stage("release"))
    tip = procedure.model.mesh.node_sets["right"]
    seen = []
    for report in procedure.advance():
        if report.stage == "release":
            seen.append(procedure.state.nodes.displacement[tip, Z].mean())
    np.testing.assert_allclose(seen, [0.3, 0.2, 0.1, 0.0], atol=0.01)
    assert np.abs(procedure.state.nodes.displacement[tip, RY]).max() < 1e-4
