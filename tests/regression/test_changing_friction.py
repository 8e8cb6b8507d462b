# SPDX-License-Identifier: Apache-2.0
"""Friction by path and speed in runs that make new meshes, that are resumed, and of sheets."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.case import StampingCase, build_model
from presswork.interaction.sliding import SlidingArrays
from presswork.model import FloatArray
from presswork.process.implicit.begin_forming import begin_forming
from presswork.recorder import run_model
from tests.regression.test_implicit_stamping import CUP
from tests.regression.test_remeshed_runs import upsetting
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts, run_to_end

ROUGH = {"contact": "coulomb", "mu": 0.05, "friction": {"path": [[0, 1], [2, 3]], "speed": [[0, 1], [100, 0.5]]}}


def slid(remesh: dict[str, Any] | None) -> tuple[FloatArray, FloatArray]:
    """Return radius and path of the nodes that a billet's upsetting ends with, from the axis on."""
    run = begin_forming(build_model(upsetting(4.5, remesh=remesh, contact=ROUGH)), threads=1)
    for _ in run.advance():
        pass
    state, contact = run.procedure.state, run.procedure.interactions.tools.contact
    path = state[SlidingArrays].path
    radius = (run.procedure.model.mesh.points + state.nodes.moved)[contact.nodes, 0]
    touched = path > 0.0
    order = np.argsort(radius[touched])
    return radius[touched][order], path[touched][order]


def test_path_goes_on_through_new_meshes() -> None:
    one, other = slid(None), slid({"every": 0.3, "size": 1.0})
    at = np.linspace(2.0, 8.0, 7)
    np.testing.assert_allclose(np.interp(at, *other), np.interp(at, *one), rtol=0.02)


def test_resumed_run_has_the_same_bits(tmp_path: Path) -> None:
    output = {"steps": 2, "checkpoint_every": 1}
    model = build_model(upsetting(2.0, remesh={"every": 0.4}, contact=ROUGH, output=output))
    whole = run_to_end(model, tmp_path / "whole")
    run_in_two_parts(model, tmp_path / "parts", len(whole.history["time"]) // 2)
    assert_same_bits(tmp_path / "parts", tmp_path / "whole")


def draw(folder: Path, friction: dict[str, Any] | None) -> float:
    """Return the force at the end of a shallow cup [N]."""
    case = copy.deepcopy(CUP)
    case["stages"][0]["tools"]["punch"]["stroke"] = 2
    for tool in case["tools"].values():
        tool["mu"] = 0.15
        if friction:
            tool["friction"] = friction
    outcome = run_model(build_model(StampingCase.model_validate(case)), folder, threads=1)
    assert outcome.status == "completed", outcome.reason
    return float(outcome.result.history["punch.force"][-1])


def test_sheet_is_drawn_with_less_force_where_friction_falls(tmp_path: Path) -> None:
    half = draw(tmp_path / "half", {"pressure": [[0, 0.5], [1e4, 0.5]]})
    falls = draw(tmp_path / "falls", {"exponent": 0.95, "reference_pressure": 0.01, "speed": [[0, 1], [1e4, 0.9]]})
    assert half < falls < draw(tmp_path / "constant", None)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"pressure": [[0, 1], ["1 GPa", 0.5]]}, []),
        ({"pressure": [[0, 1], [4e8, 0.5]]}, ["friction.pressure changes nothing"]),
        ({"pressure": [[0, 1], [1, 0.5]]}, ["friction.pressure ends at 1 MPa"]),
        ({"pressure": [[0, 1], [400, 0.5], [500, 0.5]]}, []),
        ({"path": [[0, 1], [0.01, 0.5]]}, ["friction.path ends at 0.01 mm"]),
        ({"speed": [[0, 1], [1e5, 0.5]]}, ["friction.speed changes nothing"]),
    ],
)
def test_tables_that_a_run_leaves_are_warned_of(tmp_path: Path, table: dict[str, Any], words: list[str]) -> None:
    contact = {"contact": "coulomb", "mu": 0.05, "friction": table}
    run_to_end(build_model(upsetting(1.0, contact=contact)), tmp_path / "out")
    warned = json.loads((tmp_path / "out" / "summary.json").read_text())["warnings"]
    about = [text for text in warned if "friction." in text]
    assert len(about) == len(words), about
    assert all(word in text for word, text in zip(words, about, strict=True))
