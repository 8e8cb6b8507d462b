# SPDX-License-Identifier: Apache-2.0
"""A material without hardening is elastic, in the plane, in space and in shells, implicit and explicit.

Outside truth: Hooke's law of the logarithmic strain in a bar that is drawn.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from presswork import CaseError, Result, build_model, run_model
from presswork.case import Case
from presswork.case.description import describe
from presswork.case.shell.schema import ShellCase
from presswork.case.space.schema import SpaceCase

YOUNG, DRAWN = 200000.0, 0.02
ELASTIC = {"young": YOUNG, "poisson": 0.3, "density": "7850 kg/m^3"}
DRAW = {"name": "draw", "displacement": [{"set": "right", "component": "x", "value": DRAWN}]}


def bar(analysis: str, **changes: Any) -> dict[str, Any]:
    space = analysis == "solid"
    data: dict[str, Any] = {
        "title": "an elastic bar",
        "analysis": analysis,
        "workpiece": {"material": "rubber", "mesh": {"size": [1.0] * (2 + space), "cells": [2] * (2 + space)}},
        "materials": {"rubber": ELASTIC},
        "boundary": {"x": {"set": "left", "fix": ["x"]}, "y": {"set": "bottom", "fix": ["y"]}},
        "stages": [DRAW],
    }
    if space:
        data["boundary"]["z"] = {"set": "back", "fix": ["z"]}
    return data | changes


def shell() -> dict[str, Any]:
    data = bar("shell")
    data["workpiece"] |= {"element": "shell4_mitc", "section": {"thickness": 0.1}}
    data["boundary"] = {"x": {"set": "left", "fix": ["x", "z", "rx", "ry", "rz"]}, "y": {"set": "bottom", "fix": ["y"]}}
    return data


# plane strain: E / (1 - nu^2)
BARS = {
    "plane": (Case, bar("plane_strain"), YOUNG / (1.0 - 0.09)),
    "space": (SpaceCase, bar("solid"), YOUNG),
    "shell": (ShellCase, shell(), YOUNG),
}


@pytest.mark.parametrize("name", BARS)
def test_a_bar_without_hardening_obeys_hooke_s_law(name: str, tmp_path: Any) -> None:
    kind, data, modulus = BARS[name]
    model = build_model(kind.model_validate(data))
    assert "elastic" in describe(model)
    run_model(model, tmp_path / "out", threads=1)
    result = Result(tmp_path / "out")
    strain = np.log(1.0 + DRAWN)
    area = {"plane": 1.0, "space": 1.0, "shell": 0.1}[name] * np.exp(
        -strain * {"plane": 0.3 / 0.7, "space": 0.6, "shell": 0.6}[name]
    )
    assert result.history["x.force_x"][-1] == pytest.approx(-modulus * strain * area, rel=2e-3)
    assert result.field("equivalent_plastic_strain").max() == 0.0


def test_an_explicit_bar_without_hardening_springs_back(tmp_path: Any) -> None:
    """It rings, and gives all its energy back: none is plastic."""
    bar_thrown = bar("plane_strain", procedure="explicit", stages=[{"name": "fly", "duration": "1 us"}])
    bar_thrown["workpiece"] = bar_thrown["workpiece"] | {"velocity": [5000.0, 0.0], "element": "quad4_1pt"}
    run_model(build_model(Case.model_validate(bar_thrown)), tmp_path / "out", threads=1)
    result = Result(tmp_path / "out")
    assert result.field("effective_stress").max() > 50.0
    assert result.field("equivalent_plastic_strain").max() == 0.0


@pytest.mark.parametrize(
    ("law", "key"),
    [
        ({"rate": {"law": "cowper_symonds", "D": 40.0, "q": 5.0}}, "materials.rubber.hardening"),
        ({"heating": {"melting": 1500.0}}, "materials.rubber.heating.melting"),
    ],
)
def test_laws_of_flow_ask_for_a_hardening(law: dict[str, Any], key: str) -> None:
    with pytest.raises(CaseError, match=key):
        Case.model_validate(bar("plane_strain", materials={"rubber": ELASTIC | law}))


def test_friction_by_shear_on_an_elastic_body_is_refused() -> None:
    tool = {"profile": [[5, 1], [-5, 1]], "contact": "shear", "m": 0.2}
    press = {"name": "press", "tools": {"die": {"stroke": 0.1, "direction": [0, -1]}}}
    with pytest.raises(CaseError, match=r"tools\.die\.contact = \"shear\".*elastic"):
        build_model(Case.model_validate(bar("plane_strain", tools={"die": tool}, stages=[press])))
