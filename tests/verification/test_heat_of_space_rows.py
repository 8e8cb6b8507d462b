# SPDX-License-Identifier: Apache-2.0
"""Heat of explicit solids in space: adiabatic upsetting, two half-spaces, hot upsetting against the plane."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest

from presswork.case import build_model
from presswork.case.plane.schema import Case
from presswork.case.space.schema import SpaceCase
from presswork.outcome import GaveUpError
from presswork.process.begin import begin
from tests.problems import sectors
from tests.regression.whole_runs import compare_with_restart
from tests.verification.test_heat_of_forming import ENTHALPY

Data = dict[str, Any]
STEEL = {"conductivity": 30, "specific_heat": "650 J/(kg*K)"}


def run(case: Data, kind: Any = SpaceCase) -> tuple[Any, list[Data]]:
    taken = begin(build_model(kind.model_validate({**case, "procedure": "explicit"})), threads=1)
    return taken, [taken.row(report) for report in taken.advance()]


@pytest.mark.parametrize("element", ["hex8_1pt", "hex8_fbar", "tet4_nodal"])
def test_adiabatic_upsetting(element: str) -> None:
    """700 + 300 e to 60 %, nine tenths of the work, density 7833, specific heat 586: 150.45 K in every node."""
    strain = np.log(1 / 0.4)
    closed = 0.9 * (700 * strain + 150 * strain**2) / ENTHALPY
    steel = {
        "young": "20e3 GPa", "poisson": 0.3, "magnitudes": "any", "density": "7833 kg/m^3",
        "hardening": {"law": "linear", "yield_stress": 700, "modulus": 300},
        "thermal": {"conductivity": 0.01, "specific_heat": "586 J/(kg*K)"},
    }  # fmt: skip
    taken, rows = run(
        {
            "title": "upsetting",
            "analysis": "solid",
            "workpiece": {"material": "steel", "element": element, "mesh": {"size": [5, 5, 5], "cells": [2, 2, 2]}},
            "materials": {"steel": steel},
            "boundary": {
                name: {"set": name, "fix": [axis]} for name, axis in (("left", "x"), ("bottom", "y"), ("back", "z"))
            },
            "tools": {
                "punch": {"shape": "plane", "normal": [0, 0, -1], "position": [0, 0, 5], "contact": "frictionless"}
            },
            "heat": {"initial_temperature": 20},
            "stages": [{"name": "upset", "duration": 0.1, "tools": {"punch": {"stroke": 3, "direction": [0, 0, -1]}}}],
            "explicit": {"target_step": 1e-5},
        }
    )
    rise = taken.heat.arrays.temperature - 20
    assert rise.mean() == pytest.approx(closed, rel=3e-3)
    assert np.ptp(rise) < 0.02 * closed
    assert rows[-1]["heat_stored"] == pytest.approx(rows[-1]["heat_plastic"], rel=1e-8)
    assert taken.solids.temperature.mean() == pytest.approx(20 + closed, rel=3e-3)


@pytest.mark.parametrize(("time", "hot"), [pytest.param(0.1, 1004.59, marks=pytest.mark.validation), (1.0, 851.37)])
def test_a_tool_that_warms_up_is_a_half_space(time: float, hot: float) -> None:
    """Steel at 1200 degrees C on steel at 200, 10 kW/m2K: the closed solution of two half-spaces."""
    heat = {"temperature": 200, "conductance": "10 kW/(m^2*K)", "warms_up": True, "density": "7800 kg/m^3", **STEEL}
    steel = {
        "young": "200 GPa", "poisson": 0.3, "density": "7800 kg/m^3", "thermal": STEEL,
        "hardening": {"law": "linear", "yield_stress": 700, "modulus": 300},
    }  # fmt: skip
    sides = (("left", "x"), ("right", "x"), ("bottom", "y"), ("top", "y"), ("front", "z"))
    taken, rows = run(
        {
            "title": "half-space",
            "analysis": "solid",
            "workpiece": {
                "material": "steel",
                "mesh": {"size": [1, 1, 20], "cells": [1, 1, 60], "grading": [1, 1, 20]},
            },
            "materials": {"steel": steel},
            "boundary": {name: {"set": name, "fix": [axis], "symmetry": False} for name, axis in sides},
            "tools": {"die": {"shape": "plane", "normal": [0, 0, 1], "contact": "frictionless", "heat": heat}},
            "heat": {"initial_temperature": 1200},
            "stages": [{"name": "press", "duration": time, "tools": {"die": {"stroke": 0.01, "direction": [0, 0, 1]}}}],
            "explicit": {"target_step": time / 2000, "damping": 20 / time},
            "output": {"rows": 200},
        }
    )
    surface = taken.heat.arrays.temperature[taken.model.mesh.node_sets["back"]]
    assert surface == pytest.approx(hot, abs=3.0)
    assert rows[-1]["heat_stored"] == pytest.approx(rows[-1]["heat_tools"] + rows[-1]["heat_plastic"], rel=1e-8)


def hot(cells: tuple[int, int, int], angle: float = 30.0) -> tuple[Data, Data]:
    """Return a hot cylinder upset between cold dies as cases in axisymmetry and in space."""
    die = {"temperature": 200, "conductance": "10 kW/(m^2*K)", "warms_up": True, "density": "7800 kg/m^3", **STEEL}
    flat, space = sectors.upsetting(angle, cells, {"contact": "coulomb", "mu": 0.2, "heat": die}, stroke=5.0)
    for case in (flat, space):
        case["materials"] = {"steel": {"library": "c45"}}
        case["heat"] = {"initial_temperature": 1100, "surroundings": {"ambient": 20, "emissivity": 0.8}}
        case["stages"][0]["duration"] = 0.1
        case["explicit"] = {"target_step": "20 us"}
        case["output"] = {"steps": 1, "rows": 40}
    flat["workpiece"]["element"] = "quad4_1pt"
    return flat, space


def test_a_hot_sector_is_upset_as_in_axisymmetry() -> None:
    """A third off in 0.1 s at 1100 degrees: force, heat by kind and the coldest node."""
    flat, space = hot((6, 4, 8))
    (plane, one), (sector, other) = run(flat, Case), run(space)
    for a, b in zip(one[10:36], other[10:36], strict=True):
        assert b["punch.force"] == pytest.approx(a["punch.force"], rel=0.01)
    for kind in ("plastic", "tools", "radiation"):
        whole = other[-1][f"heat_{kind}"] * 12.0
        assert whole == pytest.approx(one[-1][f"heat_{kind}"], rel=0.02), kind
    assert other[-1]["heat_friction"] * 12.0 == pytest.approx(one[-1]["heat_friction"], rel=0.05)
    coldest = [taken.heat.arrays.temperature.min() for taken in (plane, sector)]
    assert coldest[1] == pytest.approx(coldest[0], abs=0.01 * (1100 - coldest[0]))
    rows = {name: np.array([value]) for name, value in other[-1].items()}
    assert sector.summary(rows)["heat"]["balance_error"] < 1e-8


@pytest.mark.parametrize("threads", [2, 3])
def test_any_number_of_threads_and_a_restart_give_the_same_bits(threads: int) -> None:
    case = copy.deepcopy(hot((12, 12, 8), 60.0)[1]) | {"procedure": "explicit"}
    case["explicit"] = {}
    case["stages"][0] |= {"duration": "50 us", "tools": {"punch": {"stroke": 0.3, "direction": [0, 0, -1]}}}
    case["output"] = {"steps": 1, "rows": 4}
    one = compare_with_restart(build_model(SpaceCase.model_validate(case)), 2, threads)
    assert one["heat.temperature"].min() < 1100


def test_a_cell_whose_corners_are_turned_inside_out_ends_the_run_in_words() -> None:
    case = copy.deepcopy(hot((12, 12, 8), 60.0)[1])
    case["stages"][0]["duration"] = "1 ms"  # so that a step of 20 us moves the tool by half a cell
    with pytest.raises(GaveUpError, match=r"turned inside out at a corner .* so it conducts no heat: refine the mesh"):
        run(case)
