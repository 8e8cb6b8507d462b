# SPDX-License-Identifier: Apache-2.0
"""Elastic-plastic sheets against closed forms: bending and springback of a strip, stretching to a log strain of 0.5."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from problems import linear_hardening
from shell_problems import RX, RY, RZ, X, Y, Z, fixing, patch, run, shell_model

from presswork import case
from presswork.model import EdgeForce, Material, Mesh, PrescribedDisplacement, Stage
from presswork.procedure.implicit import ImplicitProcedure

YOUNG, YIELD, MODULUS, THICKNESS, LENGTH = 2e5, 200.0, 1000.0, 1.0, 20.0
TANGENT = YOUNG * MODULUS / (YOUNG + MODULUS)
INERTIA = THICKNESS**3 / 12


def strip(points: int, rule: str = "gauss", cells: int = 8) -> Mesh:
    return patch(lambda u, v: np.column_stack([u, v, 0 * u]), np.linspace(0, LENGTH, cells + 1), np.array([0.0, 1.0]),
                 thickness=THICKNESS, points=points, rule=rule)  # fmt: skip


def steel(poisson: float) -> Material:
    return Material("steel", YOUNG, poisson, linear_hardening(YIELD, MODULUS))


def moment_of(curvature: float) -> float:
    """Moment per width of a strip that is free to narrow, small strains: elastic core, linear hardening beyond."""
    half = THICKNESS / 2
    core = min(YIELD / (YOUNG * curvature), half)
    elastic = 2 / 3 * YOUNG * curvature * core**3
    outside = (YIELD * (1 - TANGENT / YOUNG) * (half**2 - core**2)) + 2 / 3 * TANGENT * curvature * (half**3 - core**3)
    return elastic + outside


def bend(points: int, curvatures: np.ndarray, *, release: bool = False, **section: Any):
    """Bend a strip by turning its end; without Poisson's effect it would not narrow as plastic flow does: nu = 0.4999,
    so that every layer is in uniaxial tension. Return curvatures and moments, and the procedure at the end.
    """
    mesh = strip(points, **section)
    held = [("left", fixing(X, Z, RY, RZ)), ("bottom_left", fixing(Y))]
    turn = PrescribedDisplacement("right", RY, float(curvatures[-1]) * LENGTH)
    stages = [Stage("bend", prescribed=(turn,)), *([Stage("release")] if release else [])]
    model = shell_model(mesh, steel(0.4999), held, stages=stages, initial_increment=1 / len(curvatures),
                        max_increment=1 / len(curvatures))  # fmt: skip
    procedure = ImplicitProcedure(model, threads=1)
    found = []
    for report in procedure.advance():
        state = procedure.state
        turned = state.displacement[mesh.node_sets["right"], RY].mean()
        found.append((turned / LENGTH, state.reaction[mesh.node_sets["right"], RY].sum(), report.stage))
    return found, procedure


def test_moment_of_an_elastic_plastic_strip() -> None:
    """Up to twenty times the curvature at first yield; 31 Gauss points, as the core's edges lie between points."""
    first = 2 * YIELD / (YOUNG * THICKNESS)
    curvatures = np.linspace(0.5, 10, 20) * first
    found, _ = bend(31, curvatures)
    for curvature, moment, _ in found:
        assert moment == pytest.approx(moment_of(curvature), rel=4e-3)


def test_moment_converges_with_the_number_of_points() -> None:
    """At five times first yield; Gauss's rule errs by 13 % with 3 points, 4 % with 5, 0.5 % with 9, 0.03 % with 51."""
    curvature = 5 * 2 * YIELD / (YOUNG * THICKNESS)
    errors = {n: abs(bend(n, np.linspace(0.25, 1, 4) * curvature)[0][-1][1] / moment_of(curvature) - 1)
              for n in (3, 5, 9, 51)}  # fmt: skip
    assert errors[3] < 0.13
    assert errors[5] < 0.045
    assert errors[9] < 0.006
    assert errors[51] < 5e-4


@pytest.mark.parametrize(("rule", "points"), [("gauss", 21), ("lobatto", 21), ("simpson", 41)])
def test_every_rule_gives_the_moment(rule, points) -> None:
    curvature = 4 * 2 * YIELD / (YOUNG * THICKNESS)
    found, _ = bend(points, np.linspace(0.25, 1, 4) * curvature, rule=rule)
    assert found[-1][1] == pytest.approx(moment_of(curvature), rel=5e-3)


def test_springback_of_a_bent_strip() -> None:
    """Released, the strip keeps the curvature k - M(k)/E I: unloading is elastic."""
    curvature = 6 * 2 * YIELD / (YOUNG * THICKNESS)
    found, procedure = bend(31, np.linspace(0.1, 1, 10) * curvature, release=True)
    kept, moment, stage = found[-1]
    assert stage == "release"
    assert moment == pytest.approx(0.0, abs=1e-3)
    wanted = curvature - moment_of(curvature) / (YOUNG * INERTIA)
    assert kept == pytest.approx(wanted, rel=4e-3)
    assert procedure.energy_balance()["error_percent"] == pytest.approx(0.0, abs=1.5)


def stretch(mesh: Mesh, held: list, moves: dict[tuple[str, int], float], poisson: float = 0.3) -> ImplicitProcedure:
    prescribed = tuple(PrescribedDisplacement(name, c, value) for (name, c), value in moves.items())  # type: ignore[arg-type]
    model = shell_model(mesh, steel(poisson), held, stages=[Stage("pull", prescribed=prescribed)],
                        initial_increment=0.01, max_increment=0.05, force_tolerance=1e-8)  # fmt: skip
    return run(model)


def square(distortion: float = 0.25) -> Mesh:
    return patch(lambda u, v: np.column_stack([u, v, 0 * u]), np.linspace(0, 4, 4), np.linspace(0, 4, 4),
                 thickness=THICKNESS, points=3, distortion=distortion)  # fmt: skip


GROWN = 4 * (np.exp(0.5) - 1)
FLAT = ("all", fixing(Z, RX, RY))


def test_uniaxial_stretching_to_half() -> None:
    """Log strain 0.5: stress from Y + H p with p = 0.5 - s/E; thickness and width strain -nu s/E - p/2."""
    mesh = square()
    procedure = stretch(mesh, [FLAT, ("left", fixing(X)), ("bottom", fixing(Y))], {("right", X): GROWN})
    stress = (YIELD + MODULUS * 0.5) / (1 + MODULUS / YOUNG)
    plastic = 0.5 - stress / YOUNG
    fields = procedure.mechanics.cell_fields(procedure.state)
    np.testing.assert_allclose(fields["lamina_stress_middle"], np.tile([stress, 0, 0], (9, 1)), atol=2e-3 * stress)
    np.testing.assert_allclose(fields["stress_top"], np.tile([stress, 0, 0, 0, 0, 0], (9, 1)), atol=2e-3 * stress)
    np.testing.assert_allclose(fields["equivalent_plastic_strain"], plastic, rtol=1e-4)
    np.testing.assert_allclose(fields["thickness_strain"], -0.3 * stress / YOUNG - plastic / 2, rtol=1e-4)
    np.testing.assert_allclose(fields["major_strain_top"], 0.5, rtol=1e-6)
    np.testing.assert_allclose(fields["minor_strain_top"], fields["thickness_strain"], rtol=1e-4)
    force = procedure.state.reaction[mesh.node_sets["right"], X].sum()
    area = 4 * THICKNESS * np.exp(2 * (-0.3 * stress / YOUNG - plastic / 2))
    assert force == pytest.approx(stress * area, rel=1e-3)


def test_equibiaxial_stretching_to_half() -> None:
    mesh = square()
    held = [FLAT, ("left", fixing(X)), ("bottom", fixing(Y))]
    procedure = stretch(mesh, held, {("right", X): GROWN, ("top", Y): GROWN})
    # p = 2 (0.5 - (1 - nu) s/E)
    stress = (YIELD + MODULUS) / (1 + 2 * MODULUS * 0.7 / YOUNG)
    plastic = 2 * (0.5 - 0.7 * stress / YOUNG)
    fields = procedure.mechanics.cell_fields(procedure.state)
    np.testing.assert_allclose(fields["lamina_stress_middle"][:, :2], stress, rtol=1e-6)
    np.testing.assert_allclose(fields["thickness_strain"], -0.6 * stress / YOUNG - plastic, rtol=1e-6)
    np.testing.assert_allclose(fields["thickness"], THICKNESS * np.exp(-0.6 * stress / YOUNG - plastic), rtol=1e-6)


def test_plane_strain_stretching_to_half() -> None:
    """s = (2/sqrt 3)(Y + H (2/sqrt 3) e_p), e_p = 0.5 - s (1 - nu/2)/E, but for the way from elastic to plastic."""
    mesh = square()
    held = [FLAT, ("left", fixing(X)), ("bottom", fixing(Y)), ("top", fixing(Y))]
    procedure = stretch(mesh, held, {("right", X): GROWN})
    factor = 2 / np.sqrt(3)
    fields = procedure.mechanics.cell_fields(procedure.state)
    stress = factor * (YIELD + MODULUS * factor * 0.5) / (1 + factor**2 * MODULUS * 0.85 / YOUNG)
    np.testing.assert_allclose(fields["lamina_stress_middle"][:, 0], stress, rtol=3e-3)
    np.testing.assert_allclose(fields["lamina_stress_middle"][:, 1], 0.5 * stress, rtol=3e-3)
    np.testing.assert_allclose(fields["thickness_strain"], -0.5, rtol=6e-3)


def test_volume_is_kept_by_plastic_flow() -> None:
    mesh = square()
    procedure = stretch(mesh, [FLAT, ("left", fixing(X)), ("bottom", fixing(Y))], {("right", X): GROWN}, 0.4999)
    assert procedure.volume() == pytest.approx(procedure.initial_volume, rel=2e-4)


def test_a_sheet_pulled_in_a_turned_direction_gives_the_same() -> None:
    """Its edge pulled and sheared, a sheet that lies flat and one that stands askew in space thin alike."""
    from scipy.spatial.transform import Rotation

    flat = square()
    edge = np.unique(flat.boundary_edges)
    moved = flat.points[edge] @ np.array([[0.2, 0.05, 0.0], [0.1, -0.08, 0.0], [0.0, 0.0, 0.0]])
    results = []
    for turn in (Rotation.identity(), Rotation.from_rotvec([0.6, -0.9, 0.4])):
        sets = {**flat.node_sets, **{f"n{n}": np.array([n], dtype=np.int32) for n in edge}}
        mesh = replace(flat, points=turn.apply(flat.points), node_sets=sets)
        moves = {(f"n{n}", c): float(turn.apply(u)[c]) for n, u in zip(edge, moved, strict=True) for c in range(3)}
        procedure = stretch(mesh, [], moves)
        results.append(procedure.mechanics.cell_fields(procedure.state))
    assert results[0]["equivalent_plastic_strain"].min() > 0.1
    for name in ("thickness", "equivalent_plastic_strain", "effective_stress"):
        np.testing.assert_allclose(results[1][name], results[0][name], rtol=1e-5)


def test_bending_moment_by_edge_load_and_release_agree_with_turning() -> None:
    """A moment of 1.3 times first yield, put on and taken off."""
    first = YIELD * THICKNESS**2 / 6
    mesh = strip(21)
    held = [("left", fixing(X, Z, RY, RZ)), ("bottom_left", fixing(Y))]
    load = Stage("load", edge_forces=(EdgeForce("right", (0, 0, 0, 0, 1.3 * first, 0)),))
    model = shell_model(mesh, steel(0.4999), held, stages=[load, Stage("release")], initial_increment=0.1,
                        max_increment=0.1)  # fmt: skip
    kept = run(model).state.displacement[mesh.node_sets["right"], RY].mean() / LENGTH
    curvatures = np.linspace(1, 4, 2000) * 2 * YIELD / (YOUNG * THICKNESS)
    curvature = np.interp(1.3 * first, [moment_of(k) for k in curvatures], curvatures)
    assert kept == pytest.approx(curvature - 1.3 * first / (YOUNG * INERTIA), rel=0.02)


def r_value(along: int, law: str) -> float:
    """Width strain over thickness strain, plastic, of a distorted mesh pulled along x (0) or y (1) by 20 %."""
    r00, r45, r90 = 1.79, 1.51, 2.27
    given = {"law": law, "r00": r00, "r45": r45, "r90": r90, **({} if law == "hill1948" else {"exponent": 6})}
    material = case.ShellMaterial.model_validate(
        {"young": YOUNG, "poisson": 0.3, "yield_function": given,
         "hardening": {"law": "linear", "yield_stress": YIELD, "modulus": MODULUS}})  # fmt: skip
    sheet = replace(steel(0.3), yield_function=material.yield_function.to_model())
    mesh = square()
    move = PrescribedDisplacement(("right", "top")[along], (X, Y)[along], 0.8)
    held = [FLAT, ("left", fixing(X)), ("bottom", fixing(Y))]
    procedure = run(shell_model(mesh, sheet, held, stages=[Stage("pull", prescribed=(move,))], initial_increment=0.02,
                                max_increment=0.1, force_tolerance=1e-8))  # fmt: skip
    fields = procedure.mechanics.cell_fields(procedure.state)
    stress = fields["effective_stress"].mean()
    elastic = -0.3 * fields["lamina_stress_middle"][:, along] / YOUNG
    assert stress > YIELD
    ratio = (fields["minor_strain_middle"] - elastic) / (fields["thickness_strain"] - elastic)
    np.testing.assert_allclose(ratio, ratio.mean(), rtol=1e-5)
    return float(ratio.mean())


@pytest.mark.parametrize("law", ["hill1948", "barlat1989"])
def test_r_values_of_anisotropic_sheets(law) -> None:
    """Tension along and across the rolling direction thins the sheet by the r-values that its material is made from."""
    assert r_value(0, law) == pytest.approx(1.79, rel=1e-3)
    assert r_value(1, law) == pytest.approx(2.27, rel=1e-3)
