# SPDX-License-Identifier: Apache-2.0
"""Shells that are too long for the tool that they are bent round: their middles lie in it, by hand."""

from __future__ import annotations

import copy
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from presswork.case import StampingCase, build_model
from presswork.observe.sheet_depth import CHORDS, SheetDepth
from tests.unit.case.round_cup import CUP

RADIUS, THICKNESS = 20.0, 0.8


def lay_on_a_ball(angle: float, number: int = 10) -> Any:
    """Return a run of one shell whose corners lie on a ball of 20 mm, each at an angle from its lowest point [rad]."""
    case = copy.deepcopy(CUP)
    case["tools"] = {"punch": {"kind": "punch", "shape": "hemispherical", "diameter": 2 * RADIUS}}
    case["blank"] |= {"symmetry": []}
    case["stages"] = [{"name": "draw", "tools": {"punch": {"stroke": 1}}}]
    model = build_model(StampingCase.model_validate(case))
    turn = np.pi / 2 * np.arange(4)
    aside, down = (RADIUS + THICKNESS / 2) * np.array([np.sin(angle), -np.cos(angle)])
    centre = np.array([0.0, 0.0, model.tools[0].position[2] + RADIUS])
    points = centre + np.column_stack([aside * np.cos(turn), aside * np.sin(turn), np.full(4, down)])
    block = SimpleNamespace(connectivity=np.array([[0, 1, 2, 3]]), thickness=np.array([THICKNESS]))
    return SimpleNamespace(
        model=model, number=number, positions=lambda: points, tool_depths=lambda: {"punch": 0.0},
        tool_displacements=lambda: {"punch": np.zeros(3)},
        mesh=SimpleNamespace(blocks=[block]),
    )  # fmt: skip


@pytest.mark.parametrize("angle", [0.3, 0.45, 0.7])
def test_the_middle_of_a_chord_is_as_deep_in_a_ball_as_circles_have_it(angle: float) -> None:
    """(R + t/2) (1 - cos(angle)): the corners' distance from the middle of the ball, and the middle's."""
    run, observer = lay_on_a_ball(angle), SheetDepth()
    observer.measures(run)
    deep = (RADIUS + THICKNESS / 2) * (1.0 - np.cos(angle))
    side = np.sqrt(2.0) * (RADIUS + THICKNESS / 2) * np.sin(angle)
    found = observer.warnings(run, {})
    assert len(found) == (deep > 0.1 * side)
    if found:
        assert f"punch lies {deep:.3g} mm deep in the middle of a shell of {side:.3g} mm" in found[0]
        assert "blank.element_size" in found[0]
        again = SheetDepth()
        again.load_arrays(observer.arrays())
        assert again.warnings(run, {}) == found


def test_a_shell_that_follows_its_tool_is_not_noted() -> None:
    observer = SheetDepth()
    observer.measures(lay_on_a_ball(0.15))
    observer.measures(lay_on_a_ball(0.7, number=11))
    assert observer.warnings(lay_on_a_ball(0.7), {}) == [], "every tenth increment is looked at"
    assert CHORDS not in observer.arrays()
