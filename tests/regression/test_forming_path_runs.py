# SPDX-License-Identifier: Apache-2.0
"""A sheet stretched evenly, then in plane strain, by both procedures: the limit along its path against closed forms."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import Result
from presswork.case import ShellCase, StampingCase, build_model
from presswork.recorder import run_model
from presswork.study.measures import measure_run
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts

FLD0 = 0.12
SWIFT = (565.32, 0.007117, 0.2589)
SHEET = {"young": "206 GPa", "poisson": 0.3,
         "hardening": dict(zip(("law", "K", "e0", "n"), ("swift", *SWIFT), strict=True)),
         "forming_limit": {"law": "points", "points": [[-0.2, 0.32], [0, FLD0], [0.3, 0.35]]}}  # fmt: skip
BALANCED, PLANE = 0.04, 0.07
"""Strains along x of the first stage, in both directions, and of the second."""
LIMIT = 2 / np.sqrt(3) * FLD0
"""Of the equivalent plastic strain in plane strain."""


def stages(size: tuple[float, float], **extra: Any) -> list[dict[str, Any]]:
    def pull(name: str, x: float, y: float) -> dict[str, Any]:
        way = {"right": ("x", x), "top": ("y", y)}
        return {"name": name, **extra,
                "displacement": [{"set": s, "component": c, "value": v} for s, (c, v) in way.items()]}  # fmt: skip

    x, y = (s * np.expm1(BALANCED) for s in size)
    return [pull("balanced", x, y), pull("plane", size[0] * np.exp(BALANCED) * np.expm1(PLANE), 0.0)]


def make_case(procedure: str) -> ShellCase | StampingCase:
    if procedure == "implicit":
        return ShellCase.model_validate({
            "title": "sheet", "analysis": "shell",
            "workpiece": {"material": "steel", "element": "shell4_mitc", "section": {"thickness": 0.8},
                          "mesh": {"size": [10, 10], "cells": [2, 2]}},
            "materials": {"steel": SHEET},
            "boundary": {"x": {"set": "left", "fix": ["x"]}, "y": {"set": "bottom", "fix": ["y"]},
                         "z": {"set": "all", "fix": ["z"]}},
            "solver": {"max_increment": 0.05},
            "stages": stages((10, 10)),
        })  # fmt: skip
    return StampingCase.model_validate({
        "title": "sheet", "analysis": "stamping",
        "blank": {"shape": "rectangle", "size": [20, 20], "thickness": 0.8, "element_size": 2.5,
                  "material": "steel", "symmetry": ["x", "y"]},
        "materials": {"steel": SHEET},
        "stages": stages((10, 10), velocity="1 m/s"),
        "output": {"rows": 100, "steps": 1},
    })  # fmt: skip


@pytest.fixture(scope="module", params=["implicit", "explicit"])
def stretched(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Result:
    folder = tmp_path_factory.mktemp("sheet") / request.param
    return run_model(build_model(make_case(request.param)), folder, threads=1).result


def test_the_margins_along_the_path_are_those_of_the_closed_form(stretched: Result) -> None:
    """p = 2 e balanced and 2/sqrt(3) e in plane strain, less the elastic strain of 0.002 to 0.004."""
    p = stretched.field("equivalent_plastic_strain_middle")
    np.testing.assert_allclose(p, 2 * BALANCED + 2 / np.sqrt(3) * PLANE - 0.003, atol=0.003)
    assert p.min() > LIMIT  # beyond, though the major strain of 0.11 is below every point of the curve
    np.testing.assert_allclose(stretched.field("forming_limit_margin_polar"), 1 - p / LIMIT, atol=2e-3)
    flow = ((SWIFT[1] + p) / (SWIFT[1] + LIMIT)) ** SWIFT[2]
    np.testing.assert_allclose(stretched.field("forming_limit_margin_stress"), 1 - flow, atol=5e-4)
    assert stretched.field("forming_limit_margin").min() > 0.2


def test_the_verdict_and_the_measures_say_that_the_path_has_split_the_part(stretched: Result) -> None:
    found = stretched.summary["formability"]
    cells = len(stretched.field("forming_limit_margin"))
    assert (found["failing_cells"], found["failing_cells_by_path"]) == (0, cells)
    assert f"by their paths {cells} of {cells} elements have passed it" in found["verdict"]
    assert any("by their paths" in warning for warning in stretched.summary["warnings"])
    numbers, _ = measure_run(stretched.folder, stretched.summary)
    assert numbers["min_forming_limit_margin_polar"] == found["least_margin_polar"]["value"]
    assert numbers["cracked_cells_by_path"] == cells


@pytest.mark.validation
@pytest.mark.parametrize("procedure", ["implicit", "explicit"])
def test_a_run_that_is_stopped_on_its_second_path_goes_on_with_the_same_bits(procedure: str, tmp_path: Path) -> None:
    model = build_model(make_case(procedure))
    whole = run_model(model, tmp_path / "whole", threads=1).result
    reports = int(0.7 * len(whole.history["time"]))
    assert whole.history["stage"][reports] == "plane"
    assert_same_bits(run_in_two_parts(model, tmp_path / "parts", reports).folder, whole.folder)
