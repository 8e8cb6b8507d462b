# SPDX-License-Identifier: Apache-2.0
"""Inertia and damping of solids in the implicit procedure: their force in closed form, and a snap."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from presswork import Case, CaseError, build_model
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.supports import NotHeldError
from presswork.model import FloatArray, Mesh, Model, PointForce, PrescribedDisplacement, SolverSettings, Stage, Support
from presswork.outcome import GaveUpError
from tests.problems.plane_solids import block_mesh, elastic, make_model, map_points, run

DENSITY = 7.85e-9
RADIUS, HEIGHT, VELOCITY, DAMPING = 4.0, 6.0, 100.0, 1e5


@pytest.mark.parametrize("analysis", ["plane_strain", "axisymmetric"])
@pytest.mark.parametrize("element", ["tri3", "tri6_7pt", "quad4_fbar", "quad8_2x2", "quad9"])
def test_damping_of_a_block_carried_along_is_its_mass_times_velocity(element, analysis) -> None:
    """c m v at the side that carries it, which nothing else holds; its work is that times the way, and m v^2 at first.

    Half of that is kinetic energy, the other what backward Euler loses when the velocity jumps.
    """
    mesh = block_mesh(element, (3, 4), origin=(0.0, 0.0), size=(RADIUS, HEIGHT))
    n, duration = 20, 0.01
    model = make_model(
        mesh,
        replace(elastic(2e5, 0.3), density=DENSITY),
        analysis=analysis,
        supports=[Support("left", (True, False))] if analysis == "axisymmetric" else [],
        stages=[Stage("carry", duration=duration, prescribed=(PrescribedDisplacement("top", 1, VELOCITY * duration),))],
        solver=SolverSettings(initial_increment=1 / n, max_increment=1 / n, inertia=2.0, damping=DAMPING),
    )
    if analysis == "plane_strain":
        with pytest.raises(NotHeldError, match="nothing holds the workpiece in x"):
            ImplicitProcedure(replace(model, solver=replace(model.solver, inertia=0.0, damping=0.0)))
    procedure, _ = run(model)
    volume = np.pi * RADIUS**2 * HEIGHT if analysis == "axisymmetric" else RADIUS * HEIGHT
    mass = 2.0 * DENSITY * volume
    force = procedure.state.nodes.reaction[mesh.node_sets["top"], 1].sum()
    assert force == pytest.approx(DAMPING * mass * VELOCITY, rel=1e-4)
    first = mass * (VELOCITY**2 - 0.5 * DAMPING * VELOCITY**2 * duration / n)  # the trapezoidal rule begins at rest
    energy = procedure.energy_balance()
    assert energy["inertia_work"] == pytest.approx(first + DAMPING * mass * VELOCITY**2 * duration, rel=1e-3)
    assert abs(energy["error_percent"]) < 0.1


LENGTH, RISE, THICK = 20.0, 1.5, 0.5


def strut() -> Mesh:
    """Half of a shallow roof of two straight struts, its apex at x = 0."""
    mesh = block_mesh("quad8_2x2", (20, 2), origin=(0.0, 0.0), size=(LENGTH, THICK))
    x, y = mesh.points.T
    return map_points(mesh, np.column_stack([x, y + RISE * (1.0 - x / LENGTH)]))


def press_roof(stage: Stage, **settings: object) -> tuple[Model, ImplicitProcedure]:
    mesh = strut()
    solver = SolverSettings(initial_increment=0.0025, max_increment=0.005, symmetric=False, **settings)  # type: ignore[arg-type]
    supports = [Support("left", (True, False)), Support("right", (True, True))]
    material = replace(elastic(2e5, 0.3), density=DENSITY)
    model = make_model(mesh, material, supports=supports, stages=[stage], solver=solver)
    return model, ImplicitProcedure(model, threads=1)


def curve() -> tuple[FloatArray, FloatArray]:
    """Way and force of the apex pressed down by a prescribed displacement, far beyond the snap: statics alone."""
    way = 2.2 * RISE
    stage = Stage("press", prescribed=(PrescribedDisplacement("left", 1, -way),))
    model, procedure = press_roof(stage)
    rows = [(0.0, 0.0)]
    for report in procedure.advance():
        rows.append((report.fraction * way, -procedure.state.nodes.reaction[model.mesh.node_sets["left"], 1].sum()))
    ways, forces = np.array(rows).T
    return ways, forces


def test_a_roof_that_snaps_under_its_load_comes_to_rest_beyond() -> None:
    """Pressed by 1.3 times its limit, where statics gives up, it comes to rest as prescribed displacements find."""
    ways, forces = curve()
    peak = int(np.argmax(np.diff(forces) < 0.0))
    middle = peak + int(np.argmin(forces[peak:]))
    limit = float(forces[peak])
    load = 1.3 * limit
    wanted = float(np.interp(load, forces[middle:], ways[middle:]))
    assert wanted > 1.5 * RISE
    stage = Stage("load", duration=0.01, forces=(PointForce("left", (0.0, -load)),))
    with pytest.raises(GaveUpError, match="finds no equilibrium"):
        list(press_roof(stage)[1].advance())
    model, procedure = press_roof(stage, inertia=1.0, damping=1e4)
    list(procedure.advance())
    assert -procedure.state.nodes.displacement[model.mesh.node_sets["left"], 1].mean() == pytest.approx(
        wanted, rel=0.01
    )
    energy = procedure.energy_balance()
    assert energy["inertia_work"] > 0.3 * energy["external_work"], "what the snap sets free"
    assert abs(energy["error_percent"]) < 6.0


def case(**solver: float) -> Case:
    return Case(
        title="block",
        analysis="plane_strain",
        workpiece={"material": "steel", "element": "quad4", "mesh": {"size": [4, 4], "cells": [2, 2]}},
        materials={"steel": {"young": 2e5, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 300,
                                                                          "modulus": 10}}},
        boundary={"floor": {"set": "bottom", "fix": ["x", "y"]}},
        stages=[{"name": "press", "displacement": [{"set": "top", "component": "y", "value": -0.1}]}],
        solver=solver,
    )  # fmt: skip


def test_inertia_asks_for_density_and_damping_for_inertia() -> None:
    with pytest.raises(CaseError, match=r"materials.steel.density.*missing key.*solver.inertia needs it"):
        build_model(case(inertia=1.0))
    with pytest.raises(CaseError, match=r"solver.damping.*inertia is 0.*inertia = 1"):
        case(damping=10.0)
