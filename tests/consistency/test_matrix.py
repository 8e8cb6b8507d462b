# SPDX-License-Identifier: Apache-2.0
"""Every feature of a law in every family, on one cell: it works and its tangent is right, or the case is refused.

What is refused, and why, stands in the table of docs/theory/material.md, which this test reads.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.case import Case, CaseError, OneStepCase, ShellCase, build_model
from presswork.case.onestep.schema import simplify_yield
from presswork.case.space.schema import SpaceCase
from presswork.explicit.options import ShellOptions
from presswork.explicit.shells import ExplicitShells
from presswork.explicit.solid_material import SolidMaterial
from presswork.explicit.solids import ExplicitSolids
from presswork.explicit.space_solids import ExplicitSpaceSolids
from presswork.implicit.stepping import ImplicitProcedure
from presswork.law.elastic_plastic import make_plane_law, make_sheet_law, make_solid_law
from presswork.law.umat import SheetUmat, open_sheet_law
from presswork.onestep.law import find_metric
from presswork.onestep.law import make_law as make_deformation_law
from presswork.process.explicit.begin_forming import begin_explicit_forming

TABLE = Path(__file__).parents[1] / "data" / "hot_curves.csv"
DOCS = Path(__file__).parents[2] / "docs" / "theory" / "material.md"
BASE: dict[str, Any] = {
    "young": 70e3,
    "poisson": 0.33,
    "hardening": {"law": "linear", "yield_stress": 150, "modulus": 300},
}
ALPHA = [0.4865, 1.3783, 0.7536, 1.0246, 1.0363, 0.9036, 1.2321, 1.4858]
POINTS = [[0, 150], [0.05, 220], [0.5, 300]]
YLD2004 = {
    "prime": [-0.069888, 0.936408, 0.079143, 1.003060, 0.524741, 1.363180, 1.023770, 1.069060, 0.954322],
    "double_prime": [0.981171, 0.476741, 0.575316, 0.866827, 1.145010, -0.079294, 1.051660, 1.147100, 1.404620],
}
R_VALUES = {"r00": 0.8, "r45": 0.4, "r90": 0.55}
VOCE = {"yield_stress": 150, "saturation_stress": 330, "rate": 12}
WINDOWS = {"strain_window": [0.002, 0.6], "rate_window": [0.01, 1e4], "temperature_window": [250, 550]}
HOT_HEATING = {"heat_capacity": "900 J/(kg*K)", "start": 400}
HEATING = {"melting": 660, "exponent": 1.1, "heat_capacity": "900 J/(kg*K)", "start": 40}
FEATURES: dict[str, dict[str, Any]] = {
    "linear": {},
    "swift": {"hardening": {"law": "swift", "K": 500, "e0": 0.007, "n": 0.25}},
    "ludwik": {"hardening": {"law": "ludwik", "yield_stress": 150, "K": 400, "n": 0.4}},
    "voce": {"hardening": {"law": "voce", **VOCE}},
    "linear_voce": {"hardening": {"law": "linear_voce", **VOCE, "modulus": 80}},
    "hockett_sherby": {"hardening": {"law": "hockett_sherby", **VOCE, "exponent": 0.7}},
    "swift_voce": {"hardening": {"law": "swift_voce", "voce_share": 0.4, "K": 500, "e0": 0.007, "n": 0.25, **VOCE}},
    "table": {"hardening": {"law": "table", "points": POINTS}},
    "monotone_table": {"hardening": {"law": "monotone_table", "points": POINTS}},
    "hensel_spittel": {
        "hardening": {
            "law": "hensel_spittel",
            "A": 500,
            "m1": -4e-3,
            "m2": 0.1,
            "m3": 0.1,
            "m4": -5e-4,
            "m5": -3e-4,
            "m7": 0.1,
            "m8": 1e-5,
            "m9": 0.1,
            **WINDOWS,
        },
        "heating": HOT_HEATING,
        "density": "2700 kg/m^3",
    },
    "norton_hoff": {
        "hardening": {"law": "norton_hoff", "K": 5, "e0": 0.01, "n": 0.1, "m": 0.12, "beta": 2000, **WINDOWS},
        "heating": {"start": 400},
    },
    "sinh_arrhenius": {
        "hardening": {"law": "sinh_arrhenius", "A": 1e10, "alpha": 0.02, "n": 5, "Q": "150 kJ/mol", **WINDOWS},
        "heating": {"start": 400},
    },
    "whole johnson_cook": {
        "hardening": {
            "law": "johnson_cook",
            "A": 100,
            "B": 200,
            "n": 0.4,
            "C": 0.02,
            "reference_rate": 1,
            "m": 1.1,
            "melting": 660,
            **WINDOWS,
        },
        "heating": HOT_HEATING,
        "density": "2700 kg/m^3",
    },
    "hot_table": {"hardening": {"law": "hot_table", "file": str(TABLE)}, "heating": {"start": 400}},
    "cowper_symonds": {"rate": {"law": "cowper_symonds", "D": 40, "q": 5}},
    "johnson_cook": {"rate": {"law": "johnson_cook", "C": 0.02, "reference_rate": 1e-3}},
    "logarithmic": {"rate": {"law": "logarithmic", "C": 0.02, "reference_rate": 1e-3}},
    "given temperature": {"heating": {"melting": 660, "exponent": 1.1, "start": 200}},
    "adiabatic heating": {"heating": HEATING, "density": "2700 kg/m^3"},
    "hill1948": {"yield_function": {"law": "hill1948", **R_VALUES}},
    "barlat1989": {"yield_function": {"law": "barlat1989", **R_VALUES, "exponent": 8}},
    "yld2000": {"yield_function": {"law": "yld2000", "alpha": ALPHA, "exponent": 8}},
    "yld2004": {"yield_function": {"law": "yld2004", **YLD2004, "exponent": 8}},
    "chaboche": {"kinematic": {"law": "chaboche", "C": [3000, 800], "gamma": [60, 0]}},
    "yoshida_uemori": {
        "hardening": {"law": "linear", "yield_stress": 150},
        "kinematic": {"law": "yoshida_uemori", "B": 190, "C": 200, "m": 12, "b": 40, "Rsat": 190, "h": 0.4},
    },
    "expansion": {
        "expansion": {"coefficient": [[20, 2.2e-5], [500, 2.9e-5]]},
        "heating": HEATING,
        "density": "2700 kg/m^3",
    },
    "young_factor": {"young_factor": [[20, 1], [500, 0.6]], "heating": HEATING, "density": "2700 kg/m^3"},
    "poisson_by_temperature": {
        "poisson_by_temperature": [[20, 0.33], [100, 0.36]],
        "heating": HEATING,
        "density": "2700 kg/m^3",
    },
    "young_decrease": {"young_decrease": {"saturated": 60e3, "rate": 50}},
    "all of them": {
        "hardening": {"law": "voce", **VOCE},
        "yield_function": {"law": "yld2004", **YLD2004, "exponent": 8},
        "kinematic": {"law": "chaboche", "C": [3000, 800], "gamma": [60, 0]},
        "rate": {"law": "logarithmic", "C": 0.02, "reference_rate": 1e-3},
        "heating": HEATING,
        "density": "2700 kg/m^3",
        "young_decrease": {"saturated": 60e3, "rate": 50},
    },
    "user law": {"umat": "laws"},
    "jaumann_kirchhoff": {"umat": "laws"},
}
ONE_POINT = "implicit quad4_1pt"
SPACE = ("implicit space", "explicit space")
SOLIDS = ("implicit plane strain", "implicit axisymmetric", ONE_POINT, "explicit solids", *SPACE)
SHELLS = ("implicit shells", "explicit shells")
FAMILIES = (*SOLIDS, *SHELLS, "one step")
BULK = "is a yield function of plane stress alone"
ONE_STEP = "one step has no"
USER = ("user law", "jaumann_kirchhoff")
CLOSED_FORM = "gives no strain for a stress in closed form"
HOT = ("hensel_spittel", "norton_hoff", "sinh_arrhenius", "whole johnson_cook", "hot_table")
REFUSED: dict[tuple[str, str], str] = {
    **{(name, family): BULK for name in ("barlat1989", "yld2000") for family in SOLIDS},
    **{(name, "one step"): CLOSED_FORM for name in ("barlat1989", "yld2004", "all of them")},
    **{
        (name, "one step"): ONE_STEP
        for name in (
            "cowper_symonds", "johnson_cook", "logarithmic", "given temperature", "adiabatic heating", "chaboche",
            "yoshida_uemori", "young_decrease", "expansion", "young_factor", "poisson_by_temperature",
        )
    },
    **{(name, "one step"): "one step has no strain rate and temperature" for name in HOT},
    **{(name, "one step"): "takes no UMAT" for name in USER},
    **{(name, ONE_POINT): "its hourglass control needs a flow stress" for name in USER},
    **{("jaumann_kirchhoff", family): "no shell takes it" for family in SHELLS},
}  # fmt: skip
DT = 0.02


def material(feature: str, family: str, libraries: tuple[Path, Path]) -> dict[str, Any]:
    """Return a feature's table in a family; libraries: of solids and of sheets."""
    if feature == "jaumann_kirchhoff":
        return {"umat": str(libraries[0]), "props": [2, 8e3, 2e4], "jacobian": feature, "density": "2700 kg/m^3"}
    if feature == "user law" and family in SHELLS:
        props = [70e3, 0.33, 150, 300]
        return {"umat": str(libraries[1]), "props": props, "state_variables": 7, "plastic_strain": 1}
    if feature == "user law":
        props = [1, 70e3, 0.33, 500, 0.007, 0.25]  # Swift
        return {"umat": str(libraries[0]), "props": props, "state_variables": 1, "plastic_strain": 1}
    return {**BASE, **FEATURES[feature]}


def solid_case(table: dict[str, Any], family: str) -> dict[str, Any]:
    explicit = family == "explicit solids"
    case: dict[str, Any] = {
        "title": "cell",
        "analysis": "axisymmetric" if family == "implicit axisymmetric" else "plane_strain",
        "workpiece": {
            "material": "metal",
            "element": "quad4_1pt" if explicit or family == ONE_POINT else "quad4_fbar",
            "mesh": {"size": [1, 1], "cells": [1, 1], "origin": [1, 0]},
        },
        "materials": {"metal": {"density": "2700 kg/m^3", **table} if explicit else table},
        "boundary": {"bottom": {"set": "bottom", "fix": ["y"]}, "left": {"set": "left", "fix": ["x"]}},
        "stages": [
            {"name": "pull", "duration": 1.0, "displacement": [{"set": "top", "component": "y", "value": 0.05}]}
        ],
    }
    if explicit:
        case["procedure"] = "explicit"
    return case


def space_case(table: dict[str, Any], family: str = "implicit space") -> dict[str, Any]:
    explicit = family == "explicit space"
    return {
        **({"procedure": "explicit"} if explicit else {}),
        "title": "cell",
        "analysis": "solid",
        "workpiece": {
            "material": "metal",
            "element": "hex8_1pt" if explicit else "hex8_fbar",
            "mesh": {"size": [1, 1, 1], "cells": [1, 1, 1]},
        },
        "materials": {"metal": {"density": "2700 kg/m^3", **table} if explicit else table},
        "boundary": {"end": {"set": "left", "fix": ["x", "y", "z"]}},
        "stages": [
            {"name": "pull", "duration": 1.0, "displacement": [{"set": "right", "component": "x", "value": 0.05}]}
        ],
    }


def shell_case(table: dict[str, Any]) -> dict[str, Any]:
    return {
        "title": "cell",
        "analysis": "shell",
        "workpiece": {
            "material": "metal",
            "element": "shell4_mitc",
            "section": {"thickness": 1, "points": 3},
            "mesh": {"size": [5, 5], "cells": [1, 1]},
        },
        "materials": {"metal": table},
        "boundary": {"end": {"set": "left", "hold": "clamped"}},
        "stages": [
            {"name": "pull", "duration": 1.0, "displacement": [{"set": "right", "component": "x", "value": 0.2}]}
        ],
    }


def build(feature: str, family: str, libraries: tuple[Path, Path]) -> Any:
    table = material(feature, family, libraries)
    if family in SPACE:
        return build_model(SpaceCase.model_validate(space_case(table, family)))
    if family in SOLIDS:
        return build_model(Case.model_validate(solid_case(table, family)))
    if family in SHELLS:
        return build_model(ShellCase.model_validate(shell_case(table)))
    table.pop("density", None)
    case = OneStepCase.model_validate(
        {
            "title": "part",
            "analysis": "onestep",
            "part": {"path": "part.stl"},
            "blank": {"material": "metal", "thickness": 1},
            "materials": {"metal": table},
        }
    )
    return simplify_yield(case.materials["metal"]).to_model("metal")


def error_of_tangent(model: Any, freedoms: int, size: float, *, hottest: float | None = None) -> tuple[float, float]:
    """Largest error of a cell's stiffness over its largest entry, after flow; and the plastic strain.

    hottest: temperature of the last point, to which that of the points rises from 40 degrees C.
    """
    model = replace(model, solver=replace(model.solver, symmetric=False))
    mechanics = ImplicitProcedure(model).mechanics
    cell = model.mesh.blocks[0].connectivity[0]
    n = len(model.mesh.points)
    rng = np.random.default_rng(3)
    state = mechanics.at_rest()
    if hottest is not None:
        shape = state.cells.eqps[0].shape
        state.cells.temperature[0][:] = np.linspace(40, hottest, state.cells.eqps[0].size).reshape(shape)
    increment = np.zeros((n, freedoms))

    def force(by: np.ndarray, start: Any, *, with_stiffness: bool = False) -> np.ndarray:
        found = mechanics.evaluate(start, trial, by, with_stiffness=with_stiffness, dt=DT)
        assert isinstance(found, np.ndarray), str(found)
        return found[cell].ravel().copy()

    for _ in range(3):
        trial = state.duplicate()
        d = min(freedoms, 3)
        increment[:, :d] = size * (model.mesh.points[:, :d] * [0.3, 0.6, -0.2][:d] + 0.2 * rng.standard_normal((n, d)))
        force(increment, state)
        trial.nodes.displacement = state.nodes.displacement + increment
        trial.nodes.increment = increment.copy()
        mechanics.end_increment(state, trial, DT)
        state, trial = trial, state
    trial = state.duplicate()
    increment = increment + 0.1 * size * rng.standard_normal(increment.shape)
    force(increment, state, with_stiffness=True)
    stiffness = mechanics._stiffness[0][0, :, :, 0].copy()
    numerical = np.zeros_like(stiffness)
    step = 3e-6
    for j in range(freedoms * len(cell)):
        move = np.zeros_like(increment)
        move[cell[j // freedoms], j % freedoms] = step
        numerical[:, j] = (force(increment + move, state) - force(increment - move, state)) / (2 * step)
    return float(np.abs(stiffness - numerical).max() / np.abs(stiffness).max()), float(trial.cells.eqps[0].max())


def run_explicit_solid(model: Any) -> None:
    """Stretch a cell evenly: its stress is that of the law at the same strains."""
    data = model.materials[0]
    own = SolidMaterial.from_model(data)
    run = ExplicitSolids(model.mesh, [own], axisymmetric=False)
    run.fix("all", "uv", np.zeros(len(model.mesh.points)))
    speed = 100.0
    for letter, along in (("u", 0.0), ("v", speed)):
        run.fix("all", letter, along * model.mesh.points[:, 1])
    run.dt = 2e-6
    run.advance(100)
    if data.umat is not None:
        assert np.isfinite(run.stress).all()
        assert run.stress[0, 1] > 100
        return
    assert run.equivalent_plastic_strain[0] > 0.005
    compare_with_law(run, make_plane_law(data), components=4)


def compare_with_law(run: ExplicitSolids | ExplicitSpaceSolids, law: Any, components: int) -> None:
    """The law alone, along y at 100 mm/s on 1 mm through a hundred cycles, has the stress of the run."""
    stress, history = np.zeros((1, components)), np.zeros((1, law.history_size))
    for change in np.diff(np.log(1 + 100.0 * run.dt * np.arange(101))):
        strain = change * np.eye(components)[[1]]
        stress, history, *_ = law.update(strain, stress, history, dt=run.dt, tangent=False)
    np.testing.assert_allclose(run.stress[0], stress[0], rtol=1e-6, atol=1e-6)


def stretch_in_space(model: Any) -> ExplicitSpaceSolids:
    """Stretch a cell along y evenly by 2 % in a hundred cycles."""
    run = begin_explicit_forming(model).solids
    run.release()
    run.fix("all", "uw", 0.0)
    run.fix("all", "v", 100.0 * model.mesh.points[:, 1])
    run.dt = 2e-6
    run.advance(100)
    return run


def run_explicit_space(model: Any) -> None:
    """Stretch a cell evenly: its stress is that of the law at the same strains."""
    data, run = model.materials[0], stretch_in_space(model)
    if data.umat is not None:
        assert np.isfinite(run.stress).all()
        assert run.stress[0, 1] > 100
        return
    assert run.equivalent_plastic_strain[0] > 0.005
    compare_with_law(run, make_solid_law(data), components=6)


def run_explicit_shell(model: Any) -> None:
    """Stretch a cell evenly: its stress is that of the law at the same strains, to the order of the step."""
    data, points = model.materials[0], np.array([[0, 0, 0], [5, 0, 0], [5, 5, 0], [0, 5, 0]], dtype=float)
    given = open_sheet_law(data)
    run = ExplicitShells(points, [[0, 1, 2, 3]], 1.0, given, 2.7e-9, options=ShellOptions(n_points=3))
    for node, x in enumerate(points):
        run.fix([node], "u", 200.0 * x[0])
        run.fix([node], "vwpqr")
    run.dt = 1e-6
    run.advance(200)
    law = given
    if isinstance(given, SheetUmat):  # that of von Mises with the hardening `linear`
        law = make_sheet_law(build("linear", "explicit shells", (Path(), Path())).materials[0])
    stress, history = np.zeros((1, 3)), np.zeros((1, law.history_size))
    for change in np.diff(np.log(1 + 200.0 * run.dt * np.arange(201))):
        stress, history, *_ = law.update(np.array([[change, 0.0, 0.0]]), stress, history, dt=run.dt, tangent=False)
    np.testing.assert_allclose(run.stress.reshape(-1, 3)[0], stress[0], rtol=2e-3, atol=0.05)
    assert history[0, 0] > 0.01


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("feature", FEATURES)
def test_a_feature_works_in_a_family_or_is_refused(
    feature: str, family: str, umat_laws: Path, umat_sheet: Path
) -> None:
    reason = REFUSED.get((feature, family))
    if reason is not None:
        with pytest.raises(CaseError, match=re.escape(reason)):
            build(feature, family, (umat_laws, umat_sheet))
        return
    model = build(feature, family, (umat_laws, umat_sheet))
    flows = feature != "jaumann_kirchhoff"  # it is elastic
    if family in ("implicit plane strain", "implicit axisymmetric", ONE_POINT):
        error, plastic = error_of_tangent(model, 2, 0.02)
        assert plastic > 0.01 or not flows
        assert error < 2e-6
    elif family == "implicit space":
        error, plastic = error_of_tangent(model, 3, 0.02)
        assert plastic > 0.005 or not flows
        assert error < 2e-6
    elif family == "implicit shells":
        error, plastic = error_of_tangent(model, 6, 0.02)
        assert plastic > 0.005
        assert error < 2e-6
    elif family == "explicit solids":
        run_explicit_solid(model)
    elif family == "explicit space":
        run_explicit_space(model)
    elif family == "explicit shells":
        run_explicit_shell(model)
    else:
        law = make_deformation_law(model, find_metric(model, 0.0))
        strain = np.linspace(0.01, 0.3, 10)
        slope = (law.flow_curve(strain + 1e-7)[0] - law.flow_curve(strain - 1e-7)[0]) / 2e-7
        np.testing.assert_allclose(law.flow_curve(strain)[1], slope, rtol=1e-5, atol=1e-3)


PLACES = {
    "solids": SOLIDS,
    "shells": SHELLS,
    "one step": ("one step",),
    "implicit `quad4_1pt`": (ONE_POINT,),
}
"""What the documents call families."""


def test_the_documents_list_every_refusal_and_no_other() -> None:
    text = DOCS.read_text(encoding="utf-8")
    table = text[text.index("| feature | refused in | reason |") :].split("\n\n")[0]
    listed = set()
    for line in table.splitlines()[2:]:
        features, places, reason = (cell.strip() for cell in line.strip("|").split("|"))
        assert reason
        if features.startswith("`solver."):
            continue  # no feature of a material; tests/unit/case has it
        names = [name.strip().strip("`") for name in features.split(",")]
        assert set(names) <= set(FEATURES), f"{names} are no features of the matrix"
        listed |= {(name, family) for name in names for place in places.split(", ") for family in PLACES[place]}
    assert listed == {(feature, family) for feature, family in REFUSED if feature != "all of them"}


ANGLE = 30.0
DIRECTIONS = {
    "implicit plane strain": ANGLE,
    "explicit solids": ANGLE,
    **{family: [np.cos(np.radians(ANGLE)), np.sin(np.radians(ANGLE)), 0.0] for family in SPACE},
}


@pytest.mark.parametrize("family", DIRECTIONS)
def test_a_solid_answers_along_its_own_rolling_direction(family: str) -> None:
    """A cell stretched along y has the stress of the law at the strain seen from the rolling direction."""
    table = {**BASE, "yield_function": {"law": "hill1948", "r00": 0.8, "r45": 2.0, "r90": 0.4}, "density": 2.7e-9}
    table["rolling_direction"] = DIRECTIONS[family]
    size = 6 if family in SPACE else 4
    case = space_case(table, family) if size == 6 else solid_case(table, family)
    model = build_model((SpaceCase if size == 6 else Case).model_validate(case))
    law = (make_solid_law if size == 6 else make_plane_law)(model.materials[0])
    stretch = 0.02
    if family == "explicit solids":
        run = ExplicitSolids(model.mesh, [SolidMaterial.from_model(model.materials[0])], axisymmetric=False)
        run.fix("all", "u", 0.0)
        run.fix("all", "v", 100.0 * model.mesh.points[:, 1])
        run.dt = 2e-6
        run.advance(100)
        found, steps = run.stress[0], np.diff(np.log(1 + stretch * np.linspace(0, 1, 101)))
    elif family == "explicit space":
        found, steps = stretch_in_space(model).stress[0], np.diff(np.log(1 + stretch * np.linspace(0, 1, 101)))
    else:
        mechanics = ImplicitProcedure(model).mechanics
        state = mechanics.at_rest()
        trial, increment = state.duplicate(), np.zeros_like(model.mesh.points)
        increment[:, 1] = stretch * model.mesh.points[:, 1]
        mechanics.evaluate(state, trial, increment, with_stiffness=False, dt=DT)
        found, steps = trial.cells.stress[0][0, 0], np.array([np.log1p(stretch)])
    c, s = np.cos(np.radians(ANGLE)), np.sin(np.radians(ANGLE))
    along = np.zeros((1, size))
    along[0, [0, 1, 3]] = s * s, c * c, 2 * s * c  # the strain along y, in the law's axes
    stress, history = np.zeros((1, size)), np.zeros((1, law.history_size))
    for step in steps:
        stress, history, *_ = law.update(step * along, stress, history, tangent=False)
    xx, yy, _, xy = stress[0, :4]
    turned = [c * c * xx + s * s * yy - 2 * s * c * xy, s * s * xx + c * c * yy + 2 * s * c * xy]
    np.testing.assert_allclose(found[:2], turned, rtol=1e-6)
    assert abs(found[3]) > 1.0  # it is turned against the cell
