# SPDX-License-Identifier: Apache-2.0
"""Damage per unit of plastic strain on known paths, in every family; its quadrature; where a barrel cracks first.

Closed forms for a nearly incompressible, hardening material: with x the mean stress over the effective stress, tension
has x = 1/3, plane-strain tension 1/sqrt(3), shear 0, compression -1/3, each with its largest principal stress.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from presswork import _core, run_model
from presswork.body.laws_of_solids import make_law
from presswork.case import StampingCase, build_model
from presswork.evolution.contract import PointChange
from presswork.evolution.damage import DamageLaw
from presswork.evolution.points import EvolvedArrays
from presswork.explicit.blocks import Solids
from presswork.explicit.motion import SmoothStroke
from presswork.explicit.solid_material import SolidMaterial
from presswork.explicit.solids import ExplicitSolids
from presswork.explicit.space import SpaceDynamics
from presswork.model import Damage, Hardening, Material, PrescribedDisplacement, SolverSettings, Stage, Support
from tests.problems import plane_solids, space_solids

STEEL = Material("steel", 200e3, 0.49, Hardening("linear", np.array([300.0, 100.0])))
ROOT3 = np.sqrt(3.0)
JOHNSON_COOK = {"d1": 0.05, "d2": 3.44, "d3": -2.12, "d4": 0.0, "d5": 0.0}
"""Of 4340 steel (Johnson & Cook 1985), at the reference rate and temperature."""
MOHR_COULOMB = {"A": 1275.9, "n": 0.2655, "c1": 0.12, "c2": 720.0, "c3": 1.095}
"""Of the steel TRIP690 (Bai & Wierzbicki 2010)."""
BESIDE = {"reference_rate": 1.0, "reference": 20.0, "melting": 1520.0}


def mohr_coulomb(triaxiality: float) -> float:
    """Return the strain at which that steel breaks in tension, plane strain, shear and compression."""
    angle = {1 / 3: 1.0, -1 / 3: -1.0}.get(triaxiality, 0.0) * np.pi / 6
    A, n, c1, c2, c3 = MOHR_COULOMB.values()
    shape = c3 + ROOT3 / (2 - ROOT3) * (1 - c3) * (1 / np.cos(angle) - 1)
    strength = np.sqrt((1 + c1**2) / 3) * np.cos(angle) + c1 * (triaxiality + np.sin(angle) / 3)
    return float((A / c2 * shape * strength) ** (-1 / n))


def rates(triaxiality: float, principal: float) -> dict[tuple[str, tuple[tuple[str, float], ...]], float]:
    """Return the damage per strain of every criterion with parameters, at a triaxiality and s1/q."""
    return {
        ("cockcroft_latham", ()): max(principal, 0.0),
        ("rice_tracey", (("exponent", 1.5), ("factor", 0.283))): 0.283 * np.exp(1.5 * triaxiality),
        ("oyane", (("A", 0.4),)): max(1.0 + triaxiality / 0.4, 0.0),
        ("johnson_cook", tuple((JOHNSON_COOK | BESIDE).items())): 1.0 / (0.05 + 3.44 * np.exp(-2.12 * triaxiality)),
        ("modified_mohr_coulomb", tuple(MOHR_COULOMB.items())): 1.0 / mohr_coulomb(triaxiality),
    }


PATHS = {
    "tension": (1 / 3, 1.0),
    "plane_strain_tension": (1 / ROOT3, 2 / ROOT3),
    "shear": (0.0, 1 / ROOT3),
    "compression": (-1 / 3, 0.0),
}


def test_rice_tracey_in_tension_is_the_published_number() -> None:
    named = {name: value for (name, _), value in rates(*PATHS["tension"]).items()}
    assert named["rice_tracey"] == pytest.approx(0.4666, abs=5e-5)


def evolve(procedure) -> float:
    """Return the largest damage over the largest plastic strain."""
    values = procedure.state[EvolvedArrays].values
    chosen = [name for name in values if name != "damage_cockcroft_latham"] or list(values)
    return float(values[chosen[0]][0].max() / procedure.state.cells.eqps[0].max())


def plane(path: str, element: str, damage: Damage, *, axisymmetric: bool, increments: int = 10):
    mesh = plane_solids.block_mesh(element, (1, 1), origin=(0.0, 0.0), size=(1.0, 1.0))
    supports = [Support("left", (True, False)), Support("bottom", (False, True))]
    motion = {"tension": 0.3, "plane_strain_tension": 0.3, "compression": -0.3}[path]
    return plane_solids.run(
        plane_solids.make_model(
            mesh,
            replace(STEEL, damage=damage),
            analysis="axisymmetric" if axisymmetric else "plane_strain",
            supports=supports,
            prescribed=[PrescribedDisplacement("top", 1, motion)],
            solver=SolverSettings(initial_increment=1.0 / increments, max_increment=1.0 / increments, symmetric=False),
        )
    )[0]


def in_space(path: str, element: str, damage: Damage):
    mesh = space_solids.box(element, (1.0, 1.0, 1.0), (1, 1, 1))
    supports = list(space_solids.SYMMETRY)
    if path == "plane_strain_tension":
        supports.append(Support("front", (False, False, True)))
    motion = -0.3 if path == "compression" else 0.3
    stage = Stage("pull", prescribed=(PrescribedDisplacement("right", 0, motion),))
    return space_solids.compute(space_solids.make_model(mesh, supports, stage, material=replace(STEEL, damage=damage)))


@pytest.mark.parametrize("path", ["tension", "compression"])
@pytest.mark.parametrize("element", plane_solids.ELEMENTS)
def test_damage_per_strain_in_axisymmetry(path: str, element: str) -> None:
    for (name, parameters), exact in rates(*PATHS[path]).items():
        found = evolve(plane(path, element, Damage(name, dict(parameters)), axisymmetric=True))
        assert found == pytest.approx(exact, rel=2e-4, abs=1e-6)


@pytest.mark.parametrize("element", plane_solids.ELEMENTS)
def test_damage_per_strain_in_plane_strain_tension(element: str) -> None:
    for (name, parameters), exact in rates(*PATHS["plane_strain_tension"]).items():
        found = evolve(plane("plane_strain_tension", element, Damage(name, dict(parameters)), axisymmetric=False))
        assert found == pytest.approx(exact, rel=2e-4)


@pytest.mark.parametrize("path", ["tension", "plane_strain_tension", "compression"])
@pytest.mark.parametrize("element", ["hex8", "hex8_fbar"])
def test_damage_per_strain_in_space(path: str, element: str) -> None:
    for (name, parameters), exact in rates(*PATHS[path]).items():
        found = evolve(in_space(path, element, Damage(name, dict(parameters))))
        assert found == pytest.approx(exact, rel=2e-4, abs=1e-6)


@pytest.mark.parametrize("components", [3, 4, 6])
def test_damage_per_strain_in_shear(components: int) -> None:
    stress = np.zeros((1, components))
    stress[0, 2 if components == 3 else 3] = 100.0
    for (name, parameters), exact in rates(*PATHS["shear"]).items():
        kernel = _core.Damage(_core.DamageCriterion[name], dict(parameters))
        found = kernel.advance(np.zeros(1), stress, stress, np.zeros(1), np.full(1, 0.5), dt=1.0)
        assert found[0] == pytest.approx(0.5 * exact, rel=1e-12)


def test_the_largest_principal_stress_is_that_of_an_eigenvalue_solver() -> None:
    stress = np.random.default_rng(1).standard_normal((500, 6)) * 300.0
    stress[:3] = [[-5.0, -5.0, -5.0, 0, 0, 0], [1.0, 1.0, -2.0, 0, 0, 0], [2.0, -1.0, -1.0, 0, 0, 0]]
    tensor = stress[:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(-1, 3, 3)
    principal = np.linalg.eigvalsh(tensor)
    deviator = tensor - principal.mean(axis=1)[:, None, None] * np.eye(3)
    effective = np.sqrt(1.5 * (deviator**2).sum(axis=(1, 2)))
    kernel = _core.Damage(_core.DamageCriterion.cockcroft_latham, {})
    found = kernel.advance(np.zeros(500), stress, stress, np.zeros(500), np.ones(500), dt=1.0)
    np.testing.assert_allclose(found[1:], np.maximum(principal[1:, 2], 0.0) / effective[1:], rtol=1e-11)
    assert found[0] == 0.0


def test_rate_and_temperature_delay_fracture_as_johnson_and_cook_have_it() -> None:
    parameters = {"d1": 0.05, "d2": 3.44, "d3": -2.12, "d4": 0.002, "d5": 0.61, **BESIDE}
    law = DamageLaw(Damage("johnson_cook", parameters))
    stress, zero = np.array([[300.0, 0.0, 0.0, 0.0]]), np.zeros(1)
    warm = np.full(1, 520.0)
    change = PointChange(stress, stress, zero, np.full(1, 0.2), 1e-3, warm, warm)
    found = law.advance({"damage_johnson_cook": zero}, change)["damage_johnson_cook"][0]
    fracture = (0.05 + 3.44 * np.exp(-2.12 / 3.0)) * (1.0 + 0.002 * np.log(200.0)) * (1.0 + 0.61 / 3.0)
    assert found == pytest.approx(0.2 / fracture, rel=1e-12)


def test_freudenthal_is_the_plastic_work_and_converges_with_the_square_of_increments() -> None:
    """Plastic work per volume is 300 p + 50 p^2, with p the plastic strain reached."""
    errors = []
    for n in (5, 10, 20):
        procedure = plane("tension", "quad4", Damage("freudenthal"), axisymmetric=True, increments=n)
        p = procedure.state.cells.eqps[0].max()
        found = procedure.state[EvolvedArrays].values["damage_freudenthal"][0].max()
        errors.append(abs(found / (300.0 * p + 50.0 * p**2) - 1.0))
    assert errors[-1] < 1e-3
    assert errors[0] / errors[2] > 10.0


@pytest.mark.parametrize("element", ["tri3", "quad4_1pt"])
@pytest.mark.parametrize(("path", "axisymmetric"), [("tension", True), ("plane_strain_tension", False)])
def test_damage_per_strain_in_explicit_solids_in_the_plane(element: str, path: str, axisymmetric: bool) -> None:
    for (name, parameters), exact in rates(*PATHS[path]).items():
        mesh = plane_solids.block_mesh(element, (1, 1), origin=(0.0, 0.0), size=(1.0, 1.0))
        damage = Damage(name, dict(parameters))
        material = SolidMaterial(young=200e3, poisson=0.49, density=7.85e-9, hardening=STEEL.hardening, damage=damage)
        solids = ExplicitSolids(mesh, [material], axisymmetric=axisymmetric)
        solids.fix("left", "u")
        solids.fix("bottom", "v")
        solids.fix("top", "v", 300.0)
        solids.run_to(1e-3, motion=SmoothStroke(1e-3, 1e-3, rise=5e-4))
        found = solids.damage[f"damage_{name}"][0].max() / solids.equivalent_plastic_strain.max()
        assert found == pytest.approx(exact, rel=0.02)


@pytest.mark.parametrize("element", ["hex8", "hex8_fbar"])
def test_damage_in_explicit_hexahedra_is_that_of_plane_strain_tension(element: str) -> None:
    mesh = space_solids.box(element, (1.0, 1.0, 1.0), (1, 1, 1))
    law = make_law(STEEL, SolverSettings(), 6)
    cells = mesh.blocks[0].connectivity
    run = SpaceDynamics(mesh.points, [Solids(connectivity=cells, law=law, density=7.85e-9, element=element)])
    for name, parameters in rates(*PATHS["plane_strain_tension"]):
        run._loop.add_damage(0, name, _core.Damage(_core.DamageCriterion[name], dict(parameters)))
    for side, freedom in (("left", "u"), ("bottom", "v"), ("back", "w"), ("front", "w")):
        run.fix(mesh.node_sets[side], freedom)
    run.fix(mesh.node_sets["right"], "u", 300.0)
    run.run_to(1e-3, motion=SmoothStroke(1e-3, 1e-3, rise=5e-4))
    strain = run.solid_state(0).equivalent_plastic_strain.max()
    assert strain > 0.2
    for (name, _), exact in rates(*PATHS["plane_strain_tension"]).items():
        assert run._loop.damage(0, name).max() / strain == pytest.approx(exact, rel=0.02)


def strip(path: str, damage: dict[str, object], *, procedure: str = "explicit", precision: str = "double"):
    """Return the end of a strip pulled by a tenth of its length."""
    moves = [{"set": "right", "component": "x", "value": 1}]
    if path == "plane_strain_tension":
        moves += [{"set": side, "component": "y", "value": 0} for side in ("top", "bottom")]
    case = {
        "title": "strip",
        "analysis": "stamping",
        "blank": {"shape": "rectangle", "size": [20, 8], "thickness": 0.8, "element_size": 4, "material": "steel",
                  "symmetry": ["x", "y"]},
        "materials": {"steel": {"young": "206 GPa", "poisson": 0.49, "damage": damage,
                                "hardening": {"law": "swift", "K": 565.32, "e0": 0.007117, "n": 0.2589}}},
        "stages": [{"name": "pull", "velocity": "0.5 m/s", "displacement": moves}],
        "output": {"rows": 20, "steps": 2},
        procedure: {"precision": precision} if procedure == "explicit" else {},
        "boundary": {"flat": {"set": "left", "fix": ["z"]}},
    }  # fmt: skip
    if procedure == "implicit":
        case["procedure"] = "implicit"
    return build_model(StampingCase.model_validate(case))


@pytest.mark.parametrize("path", ["tension", "plane_strain_tension"])
@pytest.mark.parametrize(
    ("procedure", "precision"), [("explicit", "double"), ("explicit", "single"), ("implicit", "double")]
)
def test_damage_per_strain_in_a_sheet(path: str, procedure: str, precision: str, tmp_path) -> None:
    for (name, parameters), exact in rates(*PATHS[path]).items():
        model = strip(path, {"criterion": name, **dict(parameters)}, procedure=procedure, precision=precision)
        result = run_model(model, tmp_path / name, threads=1).result
        strain = result.field("equivalent_plastic_strain").max()
        assert result.field(f"damage_{name}").max() / strain == pytest.approx(exact, rel=0.02)
        assert result.history[f"damage_{name}_max"][-1] == pytest.approx(result.field(f"damage_{name}").max())
