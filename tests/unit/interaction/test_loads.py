# SPDX-License-Identifier: Apache-2.0
"""Pressure, edge and point forces: totals, and the follower stiffness as the derivative of the force."""

from dataclasses import replace

import numpy as np
import pytest

from presswork import Case, CaseError, build_model
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.loads import evaluate_loads
from presswork.model import Model, OutputSettings, Support


def model_with(element: str, analysis: str, **stage) -> Model:
    case = Case(
        title="loads",
        analysis=analysis,
        workpiece={
            "material": "steel",
            "element": element,
            "mesh": {"kind": "rectangle", "origin": [5, 0], "size": [4, 6], "cells": [2, 3]},
        },
        materials={
            "steel": {
                "young": 200e3,
                "poisson": 0.3,
                "hardening": {"law": "linear", "yield_stress": 700, "modulus": 300},
            }
        },
        boundary={"bottom": {"set": "bottom", "fix": ["x", "y"]}},
        stages=[{"name": "load", **stage}],
    )
    return build_model(case)


@pytest.mark.parametrize("element", ["quad4", "quad8_2x2"])
@pytest.mark.parametrize("analysis", ["axisymmetric", "plane_strain"])
def test_follower_stiffness_is_the_derivative_of_the_pressure_force(element, analysis) -> None:
    model = model_with(element, analysis, pressure=[{"set": "right", "value": 100.0}])
    rng = np.random.default_rng(1)
    points = model.mesh.points + 0.1 * rng.standard_normal(model.mesh.points.shape)
    loads = evaluate_loads(model, points, [0.7])
    n = points.size
    stiffness = np.zeros((n, n))
    for (a, b), block in zip(loads.pairs, loads.blocks, strict=True):
        stiffness[2 * a : 2 * a + 2, 2 * b : 2 * b + 2] += block
    for j in range(n):
        move = np.zeros(n)
        move[j] = 1e-6
        ahead = evaluate_loads(model, points + move.reshape(-1, 2), [0.7]).force
        behind = evaluate_loads(model, points - move.reshape(-1, 2), [0.7]).force
        derivative = -(ahead - behind).ravel() / 2e-6
        np.testing.assert_allclose(stiffness[:, j], derivative, atol=1e-5 * np.abs(stiffness).max())


@pytest.mark.parametrize("element", ["quad4", "quad8_2x2"])
def test_pressure_adds_up_to_its_resultant(element) -> None:
    model = model_with(element, "axisymmetric", pressure=[{"set": "top", "value": 50.0}])
    force = evaluate_loads(model, model.mesh.points, [1.0]).force
    assert force[:, 1].sum() == pytest.approx(-50.0 * np.pi * (9**2 - 5**2))


def test_point_force_is_shared_by_the_set() -> None:
    model = model_with("quad4", "plane_strain", force=[{"set": "top", "value": [30.0, -60.0]}])
    force = evaluate_loads(model, model.mesh.points, [0.5]).force
    np.testing.assert_allclose(force.sum(axis=0), [15.0, -30.0])


@pytest.mark.parametrize("element", ["tri3", "tri6_6pt", "quad4", "quad8", "quad9"])
@pytest.mark.parametrize("analysis", ["axisymmetric", "plane_strain"])
def test_edge_force_is_a_uniform_stress_and_force_on_the_nodes_is_not(element, analysis) -> None:
    """Of a ring and of a slab on rollers: the stress along the force is the load on the edge, everywhere."""
    area = np.pi * (9**2 - 5**2) if analysis == "axisymmetric" else 4.0
    loads = {
        "value": {"edge_force": [{"set": "top", "value": [0, 100]}]},
        "total": {"edge_force": [{"set": "top", "total": [0, 100 * area]}]},
        "nodes": {"force": [{"set": "top", "value": [0, 100 * area]}]},
    }
    scatter = {}
    for name, load in loads.items():
        model = model_with(element, analysis, **load)
        rollers = (
            Support("bottom", (False, True)),
            *([Support("left", (True, False))] if analysis != "axisymmetric" else []),
        )
        solver = replace(
            model.solver, displacements="small", initial_increment=1.0, max_increment=1.0, force_tolerance=1e-9
        )
        model = replace(model, supports=rollers, solver=solver, output=OutputSettings(every=1))
        procedure = ImplicitProcedure(model, threads=1)
        assert len(list(procedure.advance())) == 1
        stress = np.concatenate([s[..., 1].ravel() for s in procedure.state.cells.stress])
        scatter[name] = np.abs(stress - 100.0).max()
    assert scatter["value"] < 1e-6
    assert scatter["total"] < 1e-6
    assert scatter["nodes"] > 5.0


def test_edge_force_needs_one_of_value_and_total() -> None:
    for load in ({}, {"value": [0, 1], "total": [0, 1]}):
        with pytest.raises(CaseError, match="give either value or total"):
            model_with("quad4", "plane_strain", edge_force=[{"set": "top", **load}])


def test_pressure_stiffness_saves_iterations() -> None:
    counts = {}
    model = model_with("quad4", "plane_strain", pressure=[{"set": "right", "value": 700.0}])
    for on in (True, False):
        solver = replace(model.solver, pressure_stiffness=on, force_tolerance=1e-8, symmetric=False)
        procedure = ImplicitProcedure(replace(model, solver=solver), threads=1)
        counts[on] = sum(len(report.log) for report in procedure.advance())
    assert counts[True] < counts[False]
