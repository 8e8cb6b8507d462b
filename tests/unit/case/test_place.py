# SPDX-License-Identifier: Apache-2.0
"""Bulk tools are placed by `position`, and brought to the workpiece by `position = "touch"`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.case import Case, CaseError, build_model
from presswork.geometry.pose import start_centre, start_profile
from presswork.model import Model
from presswork.recorder import run_model
from tests.unit.case.test_magnitudes import SOLID, STEEL


def billet(*, analysis: str = "plane_strain", motion: dict[str, Any] | None = None, **punch: Any) -> Model:
    """A billet 10 wide and 15 high, and a punch with keys of its own."""
    case: dict[str, Any] = {**SOLID, "analysis": analysis, "materials": {"steel": STEEL}}
    case["tools"] = {"punch": {"contact": "frictionless", **punch}}
    case["stages"] = [{"name": "upset", "tools": {"punch": motion or {"stroke": 1, "direction": [0, -1]}}}]
    return build_model(Case(**case))


FLAT = [[-5, 0], [30, 0]]
ROUND = [[-20, 30], {"to": [20, 30], "centre": [0, 30], "turn": "left"}]


def test_a_tool_is_drawn_about_its_own_origin_and_placed() -> None:
    np.testing.assert_allclose(
        start_profile(billet(profile=FLAT, position=[1, 15]).tools[0])[:, :4], [[31, 15, -4, 15]]
    )
    placed = billet(profile=ROUND, position=[0, "0.5 cm"], centre=[0, 30]).tools[0]
    assert start_centre(placed).tolist() == [0.0, 35.0]
    np.testing.assert_allclose(start_profile(placed)[0, 4:6], [0, 35])


@pytest.mark.parametrize("height", [15.0, 16.0, 400.0])
def test_a_flat_tool_is_brought_down_to_touch(height: float) -> None:
    profile = [[x, y + height] for x, y in FLAT]
    np.testing.assert_allclose(
        start_profile(billet(profile=profile, position="touch").tools[0])[:, [1, 3]], 15, atol=1e-7
    )


@pytest.mark.parametrize("motion", [{"move": [0, -2]}, {"force": 100, "direction": [0, -3]}])
def test_any_motion_says_from_where_a_tool_comes(motion: dict[str, Any]) -> None:
    built = billet(profile=[[-5, 20], [30, 20]], position="touch", motion=motion)
    np.testing.assert_allclose(start_profile(built.tools[0])[:, [1, 3]], 15, atol=1e-7)


def test_a_round_tool_touches_the_corner_that_comes_first() -> None:
    """A roll of radius 20 about (0, 60) comes down on nodes at x = 0, 5, 10 of the top: at x = 0, its lowest point."""
    roll = [[0, 40], {"to": [0, 80], "centre": [0, 60], "turn": "left"},
            {"to": [0, 40], "centre": [0, 60], "turn": "left"}]  # fmt: skip
    assert start_centre(billet(profile=roll, position="touch").tools[0])[1] == pytest.approx(35.0, abs=1e-6)
    beside = [[30, 40], {"to": [30, 80], "centre": [30, 60], "turn": "left"},
              {"to": [30, 40], "centre": [30, 60], "turn": "left"}]  # fmt: skip
    motion = {"stroke": 1, "direction": [-1, 0]}
    with pytest.raises(CaseError, match=r"tools\.punch\.position = .touch.*passes the workpiece"):
        billet(profile=beside, position="touch", motion=motion)


def test_a_tool_that_never_moves_cannot_be_brought() -> None:
    case = {**SOLID, "materials": {"steel": STEEL}, "tools": {"punch": {"profile": FLAT, "contact": "sticking",
            "position": "touch"}}, "stages": [{"name": "pull", "displacement": [
                {"set": "top", "component": "y", "value": 1}]}]}  # fmt: skip
    with pytest.raises(CaseError, match=r"tools\.punch\.position.*no tool moves"):
        build_model(Case(**case))


def test_a_tool_that_stands_comes_against_the_motion_of_the_others() -> None:
    """A die drawn 9 mm below the billet is raised to its bottom at y = 0, as the punch comes down to its top."""
    case: dict[str, Any] = {**SOLID, "materials": {"steel": STEEL}}
    touching = {"contact": "frictionless", "position": "touch"}
    case["tools"] = {
        "punch": {"profile": [[-5, 20], [30, 20]], **touching},
        "die": {"profile": [[-5, -9], [30, -9]], **touching},
    }
    case["stages"] = [{"name": "upset", "tools": {"punch": {"stroke": 1, "direction": [0, -1]}}}]
    punch, die = (start_profile(tool)[0, [1, 3]] for tool in build_model(Case(**case)).tools)
    np.testing.assert_allclose(punch, 15, atol=1e-7)
    np.testing.assert_allclose(die, 0, atol=1e-7)


def test_no_increment_is_spent_in_the_air(tmp_path: Path) -> None:
    """The punch drawn 5 mm above presses from the first increment on, as the one drawn on the billet."""
    runs = []
    for name, profile in (("on", [[-5, 15], [30, 15]]), ("above", [[-5, 20], [30, 20]])):
        runs.append(run_model(billet(profile=profile, position="touch"), tmp_path / name, threads=1).result.history)
    assert runs[1]["punch.force"][0] > 0
    np.testing.assert_allclose(runs[1]["punch.force"], runs[0]["punch.force"], rtol=1e-6)
