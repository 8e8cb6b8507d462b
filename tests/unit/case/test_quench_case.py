# SPDX-License-Identifier: Apache-2.0
"""What a case of heat treatment is refused for, with key, value and remedy."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import pytest

from presswork.case import Case, CaseError, build_model
from presswork.case.space.schema import SpaceCase
from tests.problems.quenched_cylinder import cylinder

Change = Callable[[dict[str, Any]], None]


def phases(data: dict[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = data["materials"]["steel"]["transformation"]["phases"]
    return found


def steel(data: dict[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = data["materials"]["steel"]
    return found


def change(place: str, key: str, value: object) -> Change:
    """Set a key of the steel, of its transformation, or of a phase; None deletes it."""

    def apply(data: dict[str, Any]) -> None:
        if place == "steel":
            table = steel(data)
        elif place == "transformation":
            table = steel(data)["transformation"]
        else:
            table = phases(data) if place == "phases" else phases(data)[place]
        if value is None:
            del table[key]
        else:
            table[key] = value

    return apply


TABLE = [[350, 60, 900], [450, 10, 150]]
BAD: dict[str, tuple[Change, str, str]] = {
    "ms": (change("transformation", "ms", None), "transformation.ms", "start of martensite"),
    "austenite": (change("phases", "austenite", None), "phases.austenite", "missing"),
    "strain": (change("martensite", "strain", -0.009), "phases.martensite.strain", "-0.009"),
    "large strain": (change("martensite", "strain", 0.9), "phases.martensite.strain", "0.9"),
    "trip": (change("martensite", "trip", 0.05), "phases.martensite.trip", "0.05"),
    "expansion": (change("austenite", "expansion", 22.0), "phases.austenite.expansion", "22 1/K"),
    "yield of one": (change("martensite", "yield_stress", None), "phases.martensite.yield_stress", "another phase"),
    "no yield": (change("martensite", "yield_stress", [[20, 0.0]]), "phases.martensite.yield_stress.0.1", "0 MPa"),
    "twice": (change("steel", "expansion", {"coefficient": 1e-5}), "steel.expansion", "own coefficients"),
    "no hardening": (change("steel", "hardening", None), "steel.hardening", "hardening law"),
    "lacking": (change("transformation", "times", {"bainite": TABLE}), "phases.bainite", "forms by the kinetics"),
    "no times": (change("transformation", "times", {}), "times.bainite", "no table"),
    "fraction": (change("transformation", "times", {"bainite": [[400, 1, 9, 1.4], TABLE[1]]}), "bainite.0.3", "1.4"),
    "order": (change("transformation", "times", {"bainite": [[400, 9, 1], TABLE[1]]}), "bainite.0", "9 s to 1 %"),
    "kelvin": (change("transformation", "times", {"bainite": [[200, 1, 9], [300, 1, 9]]}), "times.bainite", "300"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_no_steel_has_is_refused(name: str) -> None:
    apply, key, text = BAD[name]
    data = cylinder("trip")
    apply(data)
    with pytest.raises(CaseError) as caught:
        build_model(Case.model_validate(data))
    assert any(problem.key.endswith(key) and text in str(problem) for problem in caught.value.problems), caught.value


def test_explicit_runs_refuse_phases_and_zones() -> None:
    data = cylinder("trip") | {"procedure": "explicit"}
    del data["solver"]
    with pytest.raises(CaseError) as caught:
        build_model(Case.model_validate(data))
    keys = {problem.key for problem in caught.value.problems}
    assert {"materials.steel.transformation.phases", "stages.0.convection"} <= keys


def test_zones_need_heat_and_a_set_that_there_is() -> None:
    data = cylinder("thermal")
    data["stages"][0]["convection"][0]["set"] = "rim"
    with pytest.raises(CaseError, match=r"stages\.0\.convection\.0\.set"):
        build_model(Case.model_validate(data))
    del data["heat"], steel(data)["thermal"]
    with pytest.raises(CaseError, match=r"stages\.0\.convection"):
        build_model(Case.model_validate(data))


def test_bodies_in_space_take_phases() -> None:
    data = copy.deepcopy(cylinder("trip")) | {"analysis": "solid"}
    data["workpiece"] = {"material": "steel", "mesh": {"size": [5, 5, 5], "cells": [1, 1, 1]}}
    data["boundary"] = {"x": {"set": "left", "fix": ["x"]}, "y": {"set": "bottom", "fix": ["y"]},
                        "z": {"set": "back", "fix": ["z"]}}  # fmt: skip
    built = build_model(SpaceCase.model_validate(data))
    assert built.materials[0].phases is not None
    assert built.stages[0].heat is not None
    del data["heat"]
    with pytest.raises(CaseError, match=r"materials\.steel\.transformation"):
        build_model(SpaceCase.model_validate(data))
