# SPDX-License-Identifier: Apache-2.0
"""Thermal expansion, and elastic constants that depend on temperature, against closed forms in every family."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from presswork import model
from presswork.case import Case, ShellCase, build_model
from presswork.case.space.schema import SpaceCase
from presswork.explicit.solid_material import SolidMaterial
from presswork.explicit.solids import ExplicitSolids
from presswork.implicit.stepping import ImplicitProcedure
from presswork.law.elastic_plastic import make_plane_law, make_sheet_law, make_solid_law
from presswork.model import FloatArray
from tests.verification.test_hot_laws import shell, solid, space

YOUNG, POISSON, START = 200e3, 0.3, 20.0
ALPHA = 1.2e-5
STEEL: dict[str, Any] = {
    "young": YOUNG,
    "poisson": POISSON,
    "hardening": {"law": "linear", "yield_stress": 1e4},
    "expansion": {"coefficient": ALPHA},
    "heating": {"start": START},
    "magnitudes": "any",
}
BY_TEMPERATURE: dict[str, Any] = STEEL | {
    "expansion": {"coefficient": [[20, 1.1e-5], [420, 1.5e-5]]},
    "young_factor": [[20, 1], [420, 0.5]],
    "poisson_by_temperature": [[20, 0.3], [420, 0.34]],
}
END = 220.0
GROWN = (1.1e-5 + 1.3e-5) / 2 * 200.0
"""Thermal strain of BY_TEMPERATURE at END."""
FAMILIES = {"axisymmetric": (Case, solid, 1), "space": (SpaceCase, space, 0), "shell": (ShellCase, shell, 0)}


def heat(data: dict[str, Any], kind: Any, temperature: Callable[[ImplicitProcedure, float], FloatArray]) -> Any:
    """Run a case while its points follow a temperature of the procedure and the fraction; return the procedure."""
    procedure = ImplicitProcedure(build_model(kind.model_validate(data)))
    n = 4
    procedure.state.cells.temperature[0][:] = temperature(procedure, 1 / n)
    for k, _ in enumerate(procedure.advance(), 2):
        procedure.state.cells.temperature[0][:] = temperature(procedure, min(k, n) / n)
    return procedure


def bar(make: Any, material: dict[str, Any]) -> dict[str, Any]:
    """Return a bar that is held at both ends."""
    data = copy.deepcopy(make(1e-13))
    data["materials"]["steel"] = material
    data["solver"] = {"initial_increment": 0.25, "max_increment": 0.25, "force_tolerance": 1e-10}
    return data


@pytest.mark.parametrize(("material", "grown", "young"), [(STEEL, ALPHA * 200, YOUNG), (BY_TEMPERATURE, GROWN, 150e3)])
@pytest.mark.parametrize("family", FAMILIES)
def test_a_bar_held_at_its_ends_bears_the_stress_of_its_thermal_strain(
    family: str, material: dict[str, Any], grown: float, young: float
) -> None:
    kind, make, axis = FAMILIES[family]
    procedure = heat(bar(make, material), kind, lambda _, part: START + part * (END - START))
    stress = procedure.state.cells.stress[0]
    np.testing.assert_allclose(stress[..., axis], -young * grown, rtol=1e-7)
    others = [i for i in range(min(stress.shape[-1], 3)) if i != axis and not (family == "shell" and i == 2)]
    np.testing.assert_allclose(stress[..., others], 0.0, atol=1e-4)
    assert abs(procedure.energy_balance()["error_percent"]) < 3.0
    assert procedure.energy_balance()["thermal_work"] != 0.0


@pytest.mark.parametrize(("material", "grown", "young"), [(STEEL, ALPHA * 200, YOUNG), (BY_TEMPERATURE, GROWN, 150e3)])
@pytest.mark.parametrize("family", FAMILIES)
def test_a_bar_that_is_drawn_lightly_grows_without_further_stress(
    family: str, material: dict[str, Any], grown: float, young: float
) -> None:
    kind, make, axis = FAMILIES[family]
    data = bar(make, material)
    load = {"shell": "edge_force", "axisymmetric": "edge_force", "space": "face_force"}[family]
    side = "top" if family == "axisymmetric" else "right"
    value = [0.0, 1.0] if family == "axisymmetric" else [1.0, 0.0, 0.0]
    data["solver"]["force_tolerance"] = 1e-8
    data["stages"][0] = {"name": "heat", "duration": 1.0, load: [{"set": side, "value": value}]}
    procedure = heat(data, kind, lambda _, part: START + part * (END - START))
    stress = procedure.state.cells.stress[0]
    along = float(stress[..., axis].mean())
    assert along == pytest.approx(1.0, rel=0.01)
    np.testing.assert_allclose(np.delete(stress, axis, axis=-1), 0.0, atol=1e-4)
    moved = procedure.state.nodes.displacement[:, axis]
    assert moved.max() == pytest.approx(10 * np.expm1(grown + along / young), rel=1e-7)


def test_a_thick_cylinder_with_a_gradient_bears_timoshenkos_stresses() -> None:
    """Timoshenko & Goodier, Theory of Elasticity, art. 151: a logarithmic temperature, ends held in plane strain."""
    a, b, rise = 10.0, 20.0, 100.0
    data = bar(solid, STEEL)
    data["workpiece"] = {
        "material": "steel", "element": "quad8",
        "mesh": {"size": [b - a, 1.0], "cells": [24, 1], "origin": [a, 0.0]},
    }  # fmt: skip
    data["boundary"] = {"end": {"set": "bottom", "fix": ["y"]}}
    data["stages"][0]["displacement"][0]["value"] = 1e-12

    def temperature(procedure: ImplicitProcedure, part: float) -> FloatArray:
        return np.asarray(START + part * rise * np.log(b / radius(procedure)) / np.log(b / a))

    def radius(procedure: ImplicitProcedure) -> FloatArray:
        mesh = procedure.model.mesh
        points = mesh.points[mesh.blocks[0].connectivity[:, :4], 0]
        middle, half = points.mean(axis=1), 0.5 * np.ptp(points, axis=1)
        gauss = np.sqrt(0.6) * np.array([-1, 0, 1])
        xi = np.tile(gauss, 3)
        return np.asarray(middle[:, None] + half[:, None] * xi)

    procedure = heat(data, Case, temperature)
    r = radius(procedure)
    stress = procedure.state.cells.stress[0]
    scale = YOUNG * ALPHA * rise / (2 * (1 - POISSON) * np.log(b / a))
    ratio = a**2 / (b**2 - a**2)
    radial = scale * (-np.log(b / r) - ratio * (1 - b**2 / r**2) * np.log(b / a))
    hoop = scale * (1 - np.log(b / r) - ratio * (1 + b**2 / r**2) * np.log(b / a))
    size = np.abs(hoop).max()
    np.testing.assert_allclose(stress[..., 0], radial, atol=3e-3 * size)
    np.testing.assert_allclose(stress[..., 2], hoop, atol=3e-3 * size)


def test_a_plate_that_is_hotter_above_bends_without_stress() -> None:
    """A temperature linear through the thickness bends a free plate to the curvature alpha dT/t."""
    data = bar(shell, STEEL)
    data["workpiece"]["mesh"] = {"size": [10, 10], "cells": [4, 4]}
    data["boundary"] = {
        "x": {"set": "left", "hold": "symmetry_x"}, "y": {"set": "bottom", "hold": "symmetry_y"},
        "z": {"set": "bottom_left", "fix": ["z"]},
    }  # fmt: skip
    data["solver"]["force_tolerance"] = 1e-6
    data["stages"][0] = {
        "name": "heat", "duration": 1.0, "force": [{"set": "top_right", "value": [1e-9, 0.0, 0.0]}]
    }  # fmt: skip
    rise = 10.0
    heights = np.array([-np.sqrt(0.6), 0.0, np.sqrt(0.6)])

    def temperature(procedure: ImplicitProcedure, part: float) -> FloatArray:
        shape = procedure.state.cells.temperature[0].shape
        return np.asarray(START + part * 0.5 * rise * np.resize(np.tile(heights, shape[1] // 3), shape))

    procedure = heat(data, ShellCase, temperature)
    moved = procedure.state.nodes.displacement
    points = procedure.model.mesh.points
    curvature = ALPHA * rise / 1.0
    corner = np.argmax(points[:, 0] + points[:, 1])
    drop = 0.5 * curvature * (points[corner, 0] ** 2 + points[corner, 1] ** 2)
    assert abs(moved[corner, 2]) == pytest.approx(drop, rel=2e-3)
    assert np.abs(procedure.state.cells.stress[0]).max() < 0.02 * YOUNG * ALPHA * rise


@pytest.mark.parametrize(("make", "components"), [(make_sheet_law, 3), (make_plane_law, 4), (make_solid_law, 6)])
def test_tangent_is_right_where_everything_depends_on_temperature(make: Any, components: int) -> None:
    material = build_model(Case.model_validate(bar(solid, BY_TEMPERATURE))).materials[0]
    hardening = model.Hardening("swift", np.array([500.0, 0.01, 0.2]))
    law = make(model.Material(**{**vars(material), "hardening": hardening}))
    rng = np.random.default_rng(4)
    n = 40
    history, degrees = np.zeros((n, law.history_size)), rng.uniform(50, 400, n)
    stress, strain = 80 * rng.standard_normal((n, components)), 4e-3 * rng.standard_normal((n, components))
    degrees[:10], strain[:10] = 25.0, 0.01 * strain[:10]  # elastic
    _, after, _, tangent, failed = law.update(strain, stress, history, temperature=degrees)
    exact = law.differentiate(strain, stress, history, temperature=degrees)
    assert not failed.any()
    assert (after[:, 0] > 0).any()
    assert (after[:, 0] == 0).any()
    np.testing.assert_allclose(after[:, -1], degrees - START)
    assert np.abs(tangent - exact).max() < 1e-7 * np.abs(exact).max()


def test_stress_follows_the_modulus_and_comes_back_with_it() -> None:
    material = build_model(Case.model_validate(bar(solid, BY_TEMPERATURE))).materials[0]
    law = make_plane_law(material)
    stress, history = np.zeros((1, 4)), np.zeros((1, law.history_size))
    strain = np.array([[3e-4, 1e-3, -2e-4, 5e-4]])
    stress, history, *_ = law.update(strain, stress, history, temperature=np.array([START]))
    cold = stress.copy()
    grown = 0.5 * (1.1e-5 + 1.5e-5) * 400.0
    free = grown * np.array([[1.0, 1.0, 1.0, 0.0]])
    hot, history, *_ = law.update(free, stress, history, temperature=np.array([420.0]))
    assert hot[0, 3] == pytest.approx(5e-4 * 100e3 / (2 * 1.34), rel=1e-12)
    back, *_ = law.update(-free, hot, history, temperature=np.array([START]))
    np.testing.assert_allclose(back, cold, rtol=1e-10)


def test_a_mean_coefficient_counts_from_its_own_temperature() -> None:
    secant = STEEL | {"expansion": {"coefficient": [[20, 1.1e-5], [420, 1.5e-5]], "secant_from": 0}}
    law = make_plane_law(build_model(Case.model_validate(bar(solid, secant))).materials[0])
    stress, *_ = law.update(
        np.zeros((1, 4)), np.zeros((1, 4)), np.zeros((1, law.history_size)), temperature=np.array([END])
    )
    grown = 1.3e-5 * 220.0 - 1.1e-5 * 20.0
    np.testing.assert_allclose(stress[0, :3], -YOUNG * grown / (1 - 2 * POISSON), rtol=1e-10)


def test_an_explicit_cell_that_is_held_all_round_is_pressed_by_heat() -> None:
    data = bar(solid, STEEL)
    data["materials"]["steel"] = STEEL | {"density": "7850 kg/m^3"}
    data["workpiece"]["element"] = "quad4_1pt"
    built = build_model(Case.model_validate(data))
    run = ExplicitSolids(built.mesh, [SolidMaterial.from_model(built.materials[0])], axisymmetric=False)
    run.fix("all", "uv", np.zeros(len(built.mesh.points)))
    run.prescribed_temperature = np.full(len(run.stress), END)
    run.dt = 1e-7
    run.advance(2)
    pressure = YOUNG * ALPHA * (END - START) / (1 - 2 * POISSON)
    np.testing.assert_allclose(run.stress[0], [-pressure, -pressure, -pressure, 0.0], rtol=1e-6)
