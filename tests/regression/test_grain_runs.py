# SPDX-License-Identifier: Apache-2.0
"""Grain size in sheets and in explicit solids, against Avrami's closed form; pauses, resume, new shells, springback."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import Case, build_model
from presswork.case import CaseError, StampingCase
from presswork.case.material.grain import Grain
from presswork.case.space.schema import SpaceCase
from presswork.evolution.grain import GAS
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts, run_stamping, run_to_end
from tests.verification.test_grain import STATIC_SIZE, STATIC_TIME, fraction, value

CELSIUS = 1000.0
LAW = {
    "initial": 80,
    "temperature": CELSIUS,
    "static": {
        "half_time": {"A": 1e-16, "grain": 2, "strain": -2, "energy": 260e3},
        "size": {"A": 0.25, "grain": 0.67, "strain": -1},
        "exponent": 1.5,
    },
}
STEEL = {"young": "100 GPa", "poisson": 0.3, "density": "7850 kg/m^3",
         "hardening": {"law": "linear", "yield_stress": 60, "modulus": 200}, "grain": LAW}  # fmt: skip
PULL, PAUSE = 1.105, 2.0
STRIP: dict[str, Any] = {
    "title": "strip drawn, and left alone",
    "analysis": "stamping",
    "blank": {"shape": "rectangle", "size": [20, 8], "thickness": 0.8, "element_size": 4, "points": 3,
              "material": "steel", "symmetry": ["x", "y"]},
    "materials": {"steel": STEEL},
    "boundary": {"flat": {"set": "all", "fix": ["z"]}},
    "stages": [
        {"name": "pull", "process_time": 0.1, "velocity": "0.5 m/s",
         "displacement": [{"set": "right", "component": "x", "value": 10 * (PULL - 1)}]},
        {"name": "hold", "process_time": PAUSE, "duration": 0.001,
         "displacement": [{"set": "right", "component": "x", "value": 1e-6}]},
    ],
    "output": {"rows": 10, "steps": 1, "checkpoint_every": 3},
}  # fmt: skip


def check_pause(strain: np.ndarray, found: np.ndarray, size: np.ndarray, within: float) -> None:
    """Compare with Avrami's formula at the strain that there was; the rate does not count in this law."""
    each = [fraction(PAUSE / value(STATIC_TIME, 80.0, float(e), 1.0, CELSIUS), 1.5) for e in strain]
    assert 0.05 < np.mean(each) < 0.95
    np.testing.assert_allclose(found, each, rtol=within)
    grown = [
        x * value(STATIC_SIZE, 80.0, float(e), 1.0, CELSIUS) + (1 - x) * 80.0 for x, e in zip(each, strain, strict=True)
    ]
    np.testing.assert_allclose(size, grown, rtol=within)


@pytest.mark.parametrize("procedure", ["implicit", "explicit"])
def test_a_strip_recrystallises_in_the_pause_after_the_pull(procedure: str, tmp_path: Path) -> None:
    result = run_stamping(STRIP, tmp_path / "whole", procedure=procedure)
    strain = result.field("total_plastic_strain", 1)
    np.testing.assert_allclose(strain, np.log(PULL), rtol=0.05)
    assert result.field("recrystallised_fraction", 1).max() < 0.02
    check_pause(strain, result.field("recrystallised_fraction"), result.field("grain_size"), 0.03)
    model = build_model(StampingCase.model_validate({**copy.deepcopy(STRIP), "procedure": procedure}))
    run_in_two_parts(model, tmp_path / "parts", 7)
    assert_same_bits(tmp_path / "parts", tmp_path / "whole")


def test_a_part_that_springs_back_keeps_its_grains(tmp_path: Path) -> None:
    result = run_stamping(STRIP, tmp_path / "out", procedure="explicit", springback={})
    formed, released = (result.field("grain_size", step) for step in (-2, -1))
    np.testing.assert_allclose(released, formed, rtol=1e-3)


@pytest.mark.parametrize("procedure", ["implicit", "explicit"])
def test_what_is_recrystallised_softens_a_sheet(procedure: str, tmp_path: Path) -> None:
    """A second pull goes on from the strain that is retained, (1 - X) e."""
    case = copy.deepcopy(STRIP)
    case["materials"]["steel"]["grain"]["softens"] = True
    case["stages"].append({**case["stages"][0], "name": "again"})
    result = run_stamping(case, tmp_path / "out", procedure=procedure)
    first, x = result.field("total_plastic_strain", 1).mean(), result.field("recrystallised_fraction", 2).mean()
    kept = result.field("total_plastic_strain").mean() - x * first
    assert x * first > 0.01
    np.testing.assert_allclose(result.field("effective_stress").mean(), 60.0 + 200.0 * kept, rtol=0.01)


SOLID: dict[str, Any] = {
    "title": "billet struck, and left alone",
    "analysis": "axisymmetric",
    "procedure": "explicit",
    "workpiece": {"material": "steel", "element": "quad4_1pt", "mesh": {"size": [10, 10], "cells": [2, 2]}},
    "materials": {"steel": STEEL},
    "boundary": {"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
    "stages": [
        {"name": "blow", "duration": 5e-4, "displacement": [{"set": "top", "component": "y", "value": -1}]},
        {"name": "rest", "duration": 5e-4, "displacement": [{"set": "top", "component": "y", "value": -1e-9}]},
    ],
    "explicit": {"damping": 2000},
    "output": {"rows": 10, "steps": 1, "checkpoint_every": 3},
}


def test_an_explicit_solid_recrystallises_after_the_blow(tmp_path: Path) -> None:
    """The pause is of milliseconds, so the law is a thousand times as fast as a steel's."""
    case = copy.deepcopy(SOLID)
    case["materials"]["steel"]["grain"]["static"]["half_time"]["A"] = 1e-16 * 5e-4 / PAUSE
    model = build_model(Case.model_validate(case))
    result = run_to_end(model, tmp_path / "whole")
    strain = result.field("total_plastic_strain", 1)
    np.testing.assert_allclose(strain, np.log(10 / 9), rtol=0.1)
    check_pause(strain, result.field("recrystallised_fraction"), result.field("grain_size"), 0.1)
    run_in_two_parts(model, tmp_path / "parts", 13)
    assert_same_bits(tmp_path / "parts", tmp_path / "whole")


def block_in_space(element: str) -> dict[str, Any]:
    """SOLID as a block in space."""
    return {
        **SOLID,
        "analysis": "solid",
        "workpiece": {"material": "steel", "element": element,
                      "mesh": {"kind": "box", "size": [10, 10, 10], "cells": [2, 2, 2]}},
        "boundary": {"x": {"set": "left", "fix": ["x"]}, "y": {"set": "bottom", "fix": ["y"]},
                     "z": {"set": "back", "fix": ["z"]}},
    }  # fmt: skip


@pytest.mark.parametrize("kind", ["axisymmetric", "tri3", "hex8_1pt", "hex8_fbar"])
def test_what_is_recrystallised_softens_an_explicit_solid(kind: str, tmp_path: Path) -> None:
    """A second blow goes on from the strain that is retained, (1 - X) e, and harder without `softens`."""
    schema = SpaceCase if kind.startswith("hex8") else Case
    case = copy.deepcopy(block_in_space(kind) if kind.startswith("hex8") else SOLID)
    if kind == "tri3":
        case["workpiece"]["element"] = kind
    grain = case["materials"]["steel"]["grain"]
    grain["static"]["half_time"]["A"] = 1e-16 * 5e-4 / PAUSE
    case["stages"].append({**case["stages"][0], "name": "again"})
    stress = {}
    for softens in (False, True):
        grain["softens"] = softens
        result = run_to_end(build_model(schema.model_validate(case)), tmp_path / str(softens))
        stress[softens] = result.field("effective_stress").mean()
        first, x = result.field("total_plastic_strain", 1).mean(), result.field("recrystallised_fraction", 2).mean()
        kept = result.field("total_plastic_strain").mean() - softens * x * first
        assert x * first > 0.01
        np.testing.assert_allclose(stress[softens], 60.0 + 200.0 * kept, rtol=0.03)
    assert stress[True] < 0.97 * stress[False]
    run_in_two_parts(build_model(schema.model_validate(case)), tmp_path / "parts", 23)
    assert_same_bits(tmp_path / "parts", tmp_path / "True")


def test_a_missing_temperature_is_named() -> None:
    for data, kind in ((STRIP | {"procedure": "explicit"}, StampingCase), (SOLID, Case)):
        case = copy.deepcopy(data)
        case["materials"]["steel"]["grain"]["temperature"] = None
        with pytest.raises(CaseError) as error:
            build_model(kind.model_validate(case))
        assert "materials.steel.grain.temperature" in [problem.key for problem in error.value.problems]


def test_a_named_steel_has_its_laws_and_keys_beside_it_replace_them() -> None:
    """Hodgson & Gibbs (1992) at 1000 degrees C, 100 um and a strain of 0.2, and at 1100 degrees C and 1 1/s."""
    law = Grain.model_validate({"steel": "C-Mn", "initial": 100}).to_model()
    assert law.static is not None
    assert law.metadynamic is not None
    assert law.dynamic is not None
    cold, hot = 1273.15, 1373.15
    half = 2.3e-15 * 0.2**-2.5 * 100.0**2 * np.exp(230e3 / (GAS * cold))
    assert value(law.static.half_time, 100.0, 0.2, 1.0, 1000.0) == pytest.approx(half, rel=1e-12)
    assert 2.0 < half < 6.0
    Z = np.exp(300e3 / (GAS * hot))
    found = [value(part, 100.0, 0.5, 1.0, 1100.0) for part in (law.metadynamic.half_time, law.metadynamic.size)]
    assert found == pytest.approx([1.1 * Z**-0.8 * np.exp(230e3 / (GAS * hot)), 2.6e4 * Z**-0.23], rel=1e-12)
    assert value(law.dynamic.critical_strain, 100.0, 0.5, 1.0, 1100.0) == pytest.approx(5.6e-4 * 100**0.3 * Z**0.17)
    own = Grain.model_validate({"steel": "C-Mn", "initial": 100, "static": {**LAW["static"]}}).to_model()
    assert own.static is not None
    assert own.static.exponent == 1.5
    assert own.dynamic == law.dynamic
