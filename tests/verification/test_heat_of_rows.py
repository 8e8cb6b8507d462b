# SPDX-License-Identifier: Apache-2.0
"""Heat of explicit solids: adiabatic upsetting, half-spaces, a meshed die, hot upsetting against implicit forming."""

import tomllib
from importlib.resources import files
from typing import Any

import numpy as np
import pytest

from presswork.case import build_model
from presswork.case.plane.schema import Case
from presswork.implicit.heat_of_forming import HeatArrays
from presswork.process.explicit.begin_forming import begin_explicit_forming
from presswork.process.explicit.forming import ExplicitForming
from presswork.process.implicit.forming import ImplicitForming
from tests.verification.test_heat_of_forming import ENTHALPY

STEEL = {"conductivity": 30, "specific_heat": "650 J/(kg*K)"}


def run_explicit(case: dict[str, Any]) -> tuple[ExplicitForming, dict[str, float]]:
    """Return an explicit run at its end, and the last row of its history."""
    run = begin_explicit_forming(build_model(Case.model_validate({**case, "procedure": "explicit"})), threads=1)
    *_, last = run.advance()
    return run, run.row(last)


def test_adiabatic_upsetting() -> None:
    """700 + 300 e to 60 %, nine tenths of the work, density 7833, specific heat 586: 150.45 K in every node."""
    strain = np.log(1 / 0.4)
    closed = 0.9 * (700 * strain + 150 * strain**2) / ENTHALPY
    steel = {
        "young": "20e3 GPa",
        "poisson": 0.3,
        "magnitudes": "any",
        "density": "7833 kg/m^3",
        "hardening": {"law": "linear", "yield_stress": 700, "modulus": 300},
        "thermal": {"conductivity": 0.01, "specific_heat": "586 J/(kg*K)"},
    }
    run, _ = run_explicit(
        {
            "title": "upsetting",
            "analysis": "axisymmetric",
            "workpiece": {"material": "steel", "element": "quad4_1pt", "mesh": {"size": [10, 15], "cells": [2, 3]}},
            "materials": {"steel": steel},
            "boundary": {"axis": {"set": "left", "fix": ["x"]}, "bottom": {"set": "bottom", "fix": ["y"]}},
            "tools": {"punch": {"profile": [[0, 15], [40, 15]], "contact": "frictionless"}},
            "heat": {"initial_temperature": 20},
            "stages": [{"name": "upset", "duration": 0.1, "tools": {"punch": {"stroke": 9, "direction": [0, -1]}}}],
            "explicit": {"target_step": 2e-6},
        }
    )
    assert run.heat is not None
    rise = run.heat.arrays.temperature - 20
    assert rise.mean() == pytest.approx(closed, rel=2e-3)
    assert np.ptp(rise) < 0.01 * closed, "a cell gives its nodes by what they stand for"


def press(time: float, heat: dict[str, Any]) -> tuple[ExplicitForming, dict[str, float]]:
    """Press a die softly onto steel at 1200 degrees C."""
    return run_explicit(
        {
            "title": "half-space",
            "analysis": "plane_strain",
            "workpiece": {
                "material": "steel",
                "element": "quad4_1pt",
                "mesh": {"zones_x": [[1, 1, 1]], "zones_y": [[60, 60, 300]]},
            },
            "materials": {
                "steel": {
                    "young": "200 GPa",
                    "poisson": 0.3,
                    "density": "7800 kg/m^3",
                    "hardening": {"law": "linear", "yield_stress": 700, "modulus": 300},
                    "thermal": STEEL,
                }
            },
            "boundary": {"side": {"set": "left", "fix": ["x"]}, "top": {"set": "top", "fix": ["y"]}},
            "tools": {"die": {"profile": [[-5, 0], [6, 0]], "contact": "frictionless", "heat": heat}},
            "heat": {"initial_temperature": 1200},
            "stages": [{"name": "press", "duration": time, "tools": {"die": {"stroke": 0.01, "direction": [0, 1]}}}],
            "explicit": {"target_step": time / 2000, "damping": 20 / time},
            "output": {"rows": 200},
        }
    )


@pytest.mark.parametrize(("time", "hot"), [(0.1, 1004.59), (1.0, 851.37)])
def test_a_tool_that_warms_up_is_a_half_space(time, hot) -> None:
    """Steel at 1200 degrees C on steel at 200, 10 kW/m2K: the closed solution of two half-spaces."""
    die = {"temperature": 200, "conductance": "10 kW/(m^2*K)", "warms_up": True, "density": "7800 kg/m^3"}
    run, row = press(time, {**die, **STEEL})
    assert run.heat is not None
    surface = run.heat.arrays.temperature[run.model.mesh.node_sets["bottom"]]
    assert surface == pytest.approx(hot, abs=3.0)
    assert row["heat_stored"] == pytest.approx(row["heat_tools"] + row["heat_plastic"], rel=1e-8)


def test_what_a_body_loses_a_meshed_die_has() -> None:
    die = {"temperature": 200, "conductance": "10 kW/(m^2*K)", "density": "7800 kg/m^3", **STEEL}
    run, row = press(0.1, {**die, "mesh": {"size": 0.25, "depth": 20}})
    assert run.heat is not None
    heat = run.heat.arrays.heat
    assert row["dies_heat_stored"] == pytest.approx(-heat[2], rel=1e-8)
    face = run.heat.arrays.dies.max()
    assert 300 < face < 1400 - 1004.59, "heat spreads beside the body, too"
    assert run.snapshot().dies["die"][2].max() == face


def test_hot_upsetting_is_that_of_implicit_forming() -> None:
    """The example hot_upsetting with one-point cells in both: force and temperatures within 1 %."""
    case = tomllib.loads(files("presswork").joinpath("examples/hot_upsetting.toml").read_text())
    case["workpiece"] |= {"element": "quad4_1pt"}
    case["workpiece"]["mesh"]["cells"] = [10, 16]
    die = {key: value for key, value in case["tools"]["die"].items() if key != "m"}
    die["heat"] = {**die["heat"], "conductance": "10 kW/(m^2*K)"}
    case["tools"] = {"die": {**die, "contact": "coulomb", "mu": 0.2}}
    implicit = ImplicitForming(build_model(Case.model_validate(case)), threads=1)
    for report in implicit.advance():
        other = implicit.row(report)
    own, row = run_explicit({**case, "explicit": {"target_step": 6e-6}, "output": {"rows": 100}})
    assert own.heat is not None
    degrees, expected = own.heat.arrays.temperature, implicit.procedure.state[HeatArrays].temperature
    points = own.model.mesh.points
    for place in ((0, 0), (20, 0), (0, 30), (20, 30)):
        node = int(np.argmin(np.hypot(*(points - place).T)))
        assert degrees[node] - 200 == pytest.approx(expected[node] - 200, rel=1e-2), place
    assert row["kinetic_energy"] < 1e-4 * row["internal_energy"], "inertia is small"
    assert row["die.force"] == pytest.approx(other["die.force"], rel=1e-2)
    for kind in ("plastic", "tools", "radiation"):
        assert row[f"heat_{kind}"] == pytest.approx(other[f"heat_{kind}"], rel=1e-2), kind
    assert row["heat_friction"] == pytest.approx(other["heat_friction"], rel=0.1)
    own_effusivity, steel = own.model.heat.effusivity[0], np.sqrt(25 * 460e6 * 7800e-12)
    share = own_effusivity / (own_effusivity + steel)
    assert row["heat_friction"] == pytest.approx(share * row["friction_energy"], rel=1e-6), "all that friction takes"
    assert own.summary({k: np.array([v]) for k, v in row.items()})["heat"]["balance_error"] < 1e-8
