# SPDX-License-Identifier: Apache-2.0
"""Tools of a section that stand on one side of the middle alone."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from presswork.case import CaseError, StampingCase, build_model
from presswork.model import Triangulation

CORNERS = [[5, -20], [15, -20], [15, 0], [5, 0]]
FLANGE: dict[str, Any] = {
    "title": "one edge bent down", "analysis": "stamping",
    "blank": {"shape": "rectangle", "size": [50, 20], "thickness": 1, "element_size": 2.5, "material": "dc04"},
    "tools": {
        "die": {"kind": "die", "shape": "section", "plan": "one_sided", "corners": CORNERS, "radius": [0, 0, 4, 0]},
        "pad": {"kind": "holder", "shape": "section", "plan": "one_sided",
                "corners": [[5, 0], [13, 0], [13, 20], [5, 20]]},
        "punch": {"kind": "punch", "shape": "section", "plan": "one_sided", "radius": 3,
                  "corners": [[16.1, 0], [30, 0], [30, 20], [16.1, 20]]},
    },
    "stages": [{"name": "down", "tools": {"pad": {"force": 5000}, "punch": {"stroke": 12}}}],
}  # fmt: skip


def test_a_one_sided_tool_is_laid_on_the_blank_and_reaches_beyond_it() -> None:
    die, pad, punch = build_model(StampingCase.model_validate(FLANGE)).tools
    assert [tool.position for tool in (die, pad, punch)] == [(0, 0, -0.5), (0, 0, 0.5), (0, 0, 0.5)]
    for tool, (low, high) in ((die, (5, 15)), (pad, (5, 13)), (punch, (16.1, 30))):
        assert isinstance(tool.shape, Triangulation)
        x, y = tool.shape.points[:, 0], tool.shape.points[:, 1]
        assert [x.min(), x.max()] == pytest.approx([low, high])
        assert np.abs([y.min(), y.max()]).min() > 25.0


def test_it_may_go_aslant_and_stand_off_a_symmetry_plane() -> None:
    punch = FLANGE["tools"]["punch"] | {"direction": [-1, 0, -1], "position": [5, 0, 0.5]}
    blank = FLANGE["blank"] | {"symmetry": ["x"]}
    tools = FLANGE["tools"] | {"punch": punch}
    stages = [{"name": "bend", "tools": {"pad": {"force": 5000}, "punch": {"stroke": 4}}}]
    build_model(StampingCase.model_validate(FLANGE | {"tools": tools, "blank": blank, "stages": stages}))


def test_a_strip_drawn_on_the_left_is_told_how_to_stand_there_alone() -> None:
    die = FLANGE["tools"]["die"] | {"plan": "strip", "corners": [[-x, z] for x, z in CORNERS]}
    with pytest.raises(CaseError, match=r'die.corners .*beyond the middle; .*plan = "one_sided"'):
        StampingCase.model_validate(FLANGE | {"tools": FLANGE["tools"] | {"die": die}})
