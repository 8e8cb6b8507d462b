# SPDX-License-Identifier: Apache-2.0
"""Elastic-plastic sheets against closed forms: bending and springback of a strip, stretching to a log strain of 0.5."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from presswork import case
from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import EdgeForce, Mesh, PrescribedDisplacement, Rate, Stage
from tests.problems.bent_strip import (
    FIRST_YIELD,
    INERTIA,
    LENGTH,
    MODULUS,
    THICKNESS,
    YIELD,
    YOUNG,
    bend,
    moment_after_reversal,
    moment_of,
    steel,
    strip,
)
from tests.problems.shells import RX, RY, RZ, X, Y, Z, fixing, patch, run, shell_model


def test_moment_of_an_elastic_plastic_strip() -> None:
    """Up to twenty times the curvature at first yield; 31 Gauss points, as the core's edges lie between points."""
    found, _ = bend(strip(31), steel(), [20 * FIRST_YIELD], increments=20)
    for curvature, moment, _ in found:
        assert moment == pytest.approx(moment_of(curvature), rel=4e-3)


def test_moment_converges_with_the_number_of_points() -> None:
    """At five times first yield; Gauss's rule errs by 13 % with 3 points, 4 % with 5, 0.5 % with 9, 0.03 % with 51."""
    errors = {n: abs(bend(strip(n), steel(), [5 * FIRST_YIELD], increments=4)[0][-1][1] / moment_of(5 * FIRST_YIELD)
                     - 1) for n in (3, 5, 9, 51)}  # fmt: skip
    assert errors[3] < 0.13
    assert errors[5] < 0.045
    assert errors[9] < 0.006
    assert errors[51] < 5e-4


@pytest.mark.parametrize(("rule", "points"), [("gauss", 21), ("lobatto", 21), ("simpson", 41)])
def test_every_rule_gives_the_moment(rule, points) -> None:
    found, _ = bend(strip(points, rule), steel(), [4 * FIRST_YIELD], increments=4)
    assert found[-1][1] == pytest.approx(moment_of(4 * FIRST_YIELD), rel=5e-3)


@pytest.mark.parametrize("kinematic", [False, True])
def test_springback_of_a_bent_strip(kinematic) -> None:
    """Released, the strip keeps the curvature k - M(k)/E I: unloading is elastic; bent but once, back stresses tell
    nothing.
    """
    curvature = 6 * FIRST_YIELD
    found, procedure = bend(strip(31), steel(kinematic=kinematic), [curvature], release=True)
    kept, moment, stage = found[-1]
    assert stage == "release"
    assert moment == pytest.approx(0.0, abs=1e-3)
    assert kept == pytest.approx(curvature - moment_of(curvature) / (YOUNG * INERTIA), rel=4e-3)
    assert procedure.energy_balance()["error_percent"] == pytest.approx(0.0, abs=1.5)


@pytest.mark.parametrize("kinematic", [False, True])
def test_springback_after_bending_and_reverse_bending(kinematic) -> None:
    """Bent to six times first yield and flattened, hardening by a tenth of Young's modulus; then it springs.

    The moment of the flat strip in closed form: -42.51 N with kinematic, -66.89 N with isotropic hardening.
    """
    modulus = 0.1 * YOUNG
    found, procedure = bend(strip(31), steel(modulus=modulus, kinematic=kinematic), [6 * FIRST_YIELD, 0.0],
                            increments=20, release=True)  # fmt: skip
    back = [(k, m) for k, m, stage in found if stage == "bend 1"]
    flat = moment_after_reversal(6 * FIRST_YIELD, 0.0, modulus, kinematic=kinematic)
    for curvature, moment in back:
        wanted = moment_after_reversal(6 * FIRST_YIELD, curvature, modulus, kinematic=kinematic)
        assert moment == pytest.approx(wanted, abs=4e-3 * abs(flat))
    kept, moment, _ = found[-1]
    assert moment == pytest.approx(0.0, abs=1e-3)
    assert kept == pytest.approx(-flat / (YOUNG * INERTIA), rel=4e-3)
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
    force = procedure.state.nodes.reaction[mesh.node_sets["right"], X].sum()
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


def plane_strain_stress(end: float, poisson: float = 0.3) -> np.ndarray:
    """Principal stresses in the plane at a log strain, none across: Prandtl-Reuss rates from first yield on."""
    elastic = YOUNG / (1 - poisson**2) * np.array([[1, poisson], [poisson, 1]])
    start = YIELD / np.sqrt(1 - poisson + poisson**2)

    def rate(_, stress):
        normal = np.array([2 * stress[0] - stress[1], 2 * stress[1] - stress[0]])
        normal /= 2 * np.sqrt(stress[0] ** 2 - stress[0] * stress[1] + stress[1] ** 2)
        plastic = normal @ elastic[:, 0] / (normal @ elastic @ normal + MODULUS)
        return elastic @ (np.array([1.0, 0.0]) - plastic * normal)

    way = (start * (1 - poisson**2) / YOUNG, end)
    result: np.ndarray = solve_ivp(rate, way, [start, poisson * start], "LSODA", rtol=1e-10, atol=1e-8).y[:, -1]
    return result


def test_plane_strain_stretching_to_half() -> None:
    """The stress turns from the elastic ratio towards 1/2; the thickness strain is -0.5 but for the elastic volume."""
    mesh = square()
    held = [FLAT, ("left", fixing(X)), ("bottom", fixing(Y)), ("top", fixing(Y))]
    procedure = stretch(mesh, held, {("right", X): GROWN})
    fields = procedure.mechanics.cell_fields(procedure.state)
    wanted = plane_strain_stress(0.5)
    np.testing.assert_allclose(fields["lamina_stress_middle"][:, :2], np.tile(wanted, (9, 1)), rtol=2e-5)
    np.testing.assert_allclose(fields["thickness_strain"], -0.5 + 0.4 * wanted.sum() / YOUNG, rtol=1e-6)


@pytest.mark.parametrize("duration", [0.02, 20.0])
def test_stress_follows_the_rate_of_strain(duration) -> None:
    """Stretched by a tenth in 20 ms or 20 s at a constant speed: Cowper-Symonds' factor on the flow stress."""
    material = replace(steel(0.3), rate=Rate("cowper_symonds", {"D": 40.0, "q": 5.0}))
    end = 4 * np.exp(0.1)
    pull = Stage("pull", duration=duration, prescribed=(PrescribedDisplacement("right", X, end - 4),))
    model = shell_model(square(), material, [FLAT, ("left", fixing(X)), ("bottom", fixing(Y))], stages=[pull],
                        initial_increment=0.02, max_increment=0.02, force_tolerance=1e-8)  # fmt: skip
    procedure = run(model)
    fields = procedure.mechanics.cell_fields(procedure.state)
    rate = (end - 4) / duration / end
    wanted = (YIELD + MODULUS * fields["equivalent_plastic_strain"]) * (1 + (rate / 40) ** 0.2)
    np.testing.assert_allclose(fields["lamina_stress_middle"][:, 0], wanted, rtol=1e-3)
    assert procedure.energy_balance()["error_percent"] == pytest.approx(0.0, abs=1.0)


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
    model = shell_model(mesh, steel(), held, stages=[load, Stage("release")], initial_increment=0.1,
                        max_increment=0.1)  # fmt: skip
    kept = run(model).state.nodes.displacement[mesh.node_sets["right"], RY].mean() / LENGTH
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
