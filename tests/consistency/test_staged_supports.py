# SPDX-License-Identifier: Apache-2.0
"""Supports that hold in some stages alone, in the plane, in space and of shells, implicit and explicit.

Outside truth: a bar that is drawn elastically and let go takes its length again, linearly as its support is released;
one that is held again stays where it is.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from presswork import CaseError, build_model
from presswork.case import Case
from presswork.case.description import describe
from presswork.case.shell.schema import ShellCase
from presswork.case.space.schema import SpaceCase
from presswork.implicit.stepping import ImplicitProcedure
from presswork.process.begin import begin

DRAWN = 0.002


def bar(analysis: str) -> dict[str, Any]:
    """A bar whose right end is drawn, held, let go over a stage, and held again."""
    space, shell = analysis == "solid", analysis == "shell"
    data: dict[str, Any] = {
        "title": "a bar that is let go",
        "analysis": analysis,
        "workpiece": {"material": "steel", "mesh": {"size": [1.0] * (2 + space), "cells": [2] * (2 + space)}},
        "materials": {"steel": {"young": 200000.0, "poisson": 0.3}},
        "boundary": {
            "x": {"set": "left", "fix": ["x"]},
            "y": {"set": "bottom", "fix": ["y"]},
            "grip": {"set": "right", "fix": ["x"], "stages": ["hold", "again"]},
        },
        "stages": [
            {"name": "draw", "displacement": [{"set": "right", "component": "x", "value": DRAWN}]},
            {"name": "hold", "duration": 1.0},
            {"name": "open"},
            {"name": "again", "duration": 1.0},
        ],
        "solver": {"initial_increment": 0.5, "max_increment": 0.5},
    }
    if space:
        data["boundary"]["z"] = {"set": "back", "fix": ["z"]}
    if shell:
        data["workpiece"] |= {"element": "shell4_mitc", "section": {"thickness": 0.1}}
        data["boundary"]["x"]["fix"] = ["x", "z", "rx", "ry", "rz"]
    return data


KINDS = {"plane_strain": Case, "solid": SpaceCase, "shell": ShellCase}


@pytest.mark.parametrize("analysis", KINDS)
def test_what_a_support_bears_goes_to_zero_over_the_stage_that_releases_it(analysis: str) -> None:
    model = build_model(KINDS[analysis].model_validate(bar(analysis)))
    assert "held on right (3 nodes), in stage hold and again alone" in describe(model).replace("(9", "(3")
    procedure = ImplicitProcedure(model, threads=1)
    right, along, pull = model.mesh.node_sets["right"], [], []
    for _ in procedure.advance():
        along.append(float(procedure.state.nodes.displacement[right, 0].mean()) / DRAWN)
        pull.append(float(procedure.state.nodes.reaction[right, 0].sum()))
    np.testing.assert_allclose(along, [0.5, 1.0, 1.0, 1.0, 0.5, 0.0, 0.0, 0.0], atol=2e-3)
    assert abs(pull[-1]) < 1e-6 * pull[3]


def test_a_grip_that_is_no_symmetry_plane_may_be_released_in_an_explicit_run() -> None:
    data = bar("plane_strain") | {"procedure": "explicit"}
    del data["solver"]
    data["workpiece"]["element"] = "quad4_1pt"
    data["materials"]["steel"]["density"] = "7850 kg/m^3"
    data["stages"] = [{**stage, "duration": "1 us"} for stage in data["stages"][:3]]
    data["boundary"]["grip"]["stages"] = ["hold"]
    run = begin(build_model(Case.model_validate(data)), threads=1)
    right = run.model.mesh.node_sets["right"]
    x = {}
    for report in run.advance():
        x[report.stage] = float(run.solids.position[right, 0].mean()) - 1.0
    assert x["hold"] == pytest.approx(DRAWN, rel=1e-9)
    assert x["open"] < 0.9 * DRAWN


def test_a_stage_that_there_is_not_is_refused() -> None:
    data = bar("plane_strain")
    data["boundary"]["grip"]["stages"] = ["hod"]
    with pytest.raises(CaseError, match=r"boundary\.grip\.stages = \"hod\": no such stage; did you mean `hold`"):
        build_model(Case.model_validate(data))


def test_a_plane_that_is_released_is_no_symmetry_plane() -> None:
    data = bar("plane_strain")
    data["boundary"]["grip"]["symmetry"] = True
    with pytest.raises(CaseError, match=r"boundary\.grip\.symmetry"):
        build_model(Case.model_validate(data))
