# SPDX-License-Identifier: Apache-2.0
"""A part that tips onto dies by its weight, against geometry; a tool that closes on its die."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from presswork.case import StampingCase, build_model
from presswork.recorder import run_model
from tests.verification.test_press_line import STEEL

WAIT = {"duration": "0.01 ms"}
IDLE: dict[str, Any] = {"name": "idle", "stages": [{"name": "wait", **WAIT}], "springback": {}}


def lay_strip(folder, place: dict[str, Any], tools: dict[str, Any], stage: dict[str, Any] | None = None):
    """Lay a strip of 60 x 10 x 1 mm into an operation that waits; return the outcome."""
    data = {
        "title": "a strip",
        "analysis": "stamping",
        "blank": {"shape": "rectangle", "size": [60, 10], "thickness": 1.0, "element_size": 2.5, "material": "steel"},
        "materials": {"steel": STEEL},
        "operations": [
            IDLE,
            {"name": "on", "place": place, "tools": tools, "stages": [{"name": "act", **(stage or WAIT)}]},
        ],
        "output": {"rows": 2, "steps": 1},
    }
    return run_model(build_model(StampingCase.model_validate(data)), folder, threads=1)


def post(x: float, z: float, y: float = 0.0) -> dict[str, Any]:
    return {"kind": "die", "shape": "ring", "outer_diameter": 6, "outer_radius": 2.5, "position": [x, y, z]}


def slopes(points: np.ndarray) -> tuple[float, float]:
    """Return dz/dx and dz/dy of a flat part."""
    normal = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][2]
    return -normal[0] / normal[2], -normal[1] / normal[2]


@pytest.mark.parametrize("place", [{"tip": True}, {"tip": True, "over": "x", "move": [0, 0, 5]}])
def test_a_strip_lies_on_two_posts_of_different_height(tmp_path, place) -> None:
    """It falls by 2 mm over 40 mm: equal rounds are touched on the same side; and it does not roll."""
    along, across = slopes(lay_strip(tmp_path / "out", place, {"a": post(-20, 0), "b": post(20, -2)}).result.points(-2))
    assert along == pytest.approx(-2 / 40, abs=2e-5)
    assert across == pytest.approx(0.0, abs=1e-9)


def test_a_strip_lies_on_three_posts(tmp_path) -> None:
    """It rises by 0.6 mm over 4 mm; the sheet touches by points 0.6 mm apart, which lie up to 18 um off the round."""
    posts = {"a": post(-20, 0), "b": post(20, 0), "c": post(0, 0.6, 4)}
    along, across = slopes(lay_strip(tmp_path / "out", {"tip": True}, posts).result.points(-2))
    assert along == pytest.approx(0.0, abs=1e-4)
    assert across == pytest.approx(0.6 / 4, abs=0.018 / 4)


def test_a_strip_beside_its_supports_tips_off(tmp_path) -> None:
    outcome = lay_strip(tmp_path / "out", {"tip": True}, {"a": post(10, 0), "b": post(20, -2)})
    assert "operations.on.place.tip: its weight lies beyond what it rests on" in str(outcome.reason)


def test_a_punch_closes_on_its_die(tmp_path) -> None:
    """From 3 mm above a sheet of 1 mm it goes 1.5 mm to leave 2.5 mm; without a duration it takes as long as that."""
    tools = {
        "die": {"kind": "die", "shape": "ring", "outer_diameter": 20, "outer_radius": 2},
        "punch": {"kind": "punch", "shape": "ring", "outer_diameter": 20, "outer_radius": 2, "position": [0, 0, 3.5]},
    }
    stage = {"tools": {"punch": {"close": 2.5}}, "velocity": 2000}
    result = lay_strip(tmp_path / "out", {}, tools, stage).result
    assert result.history["on_punch.stroke"][-1] == pytest.approx(1.5, abs=2e-3)
    act = result.history["time"][result.history["stage"] == "on_act"]
    laid = result.history["time"][result.history["stage"] == "on_laid"]
    assert act[-1] - laid[0] == pytest.approx(1.5 / 2000 / 0.9, rel=2e-3)  # a tenth of it starts, a tenth stops


def test_a_punch_that_never_comes_near_its_die_ends_the_line_in_words(tmp_path) -> None:
    tools = {
        "die": {"kind": "die", "shape": "ring", "outer_diameter": 20, "outer_radius": 2},
        "punch": {**post(25, 3), "kind": "punch"},
    }
    outcome = lay_strip(tmp_path / "out", {}, tools, {**WAIT, "tools": {"punch": {"close": 1.0}}})
    assert "operations.on.stages.0.tools.on_punch.close = 1: the punch does not come so near" in str(outcome.reason)
