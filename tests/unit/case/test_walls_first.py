# SPDX-License-Identifier: Apache-2.0
"""A punch that comes to a wall of its die before it comes to the bottom, which then forms nothing."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.case import CaseError, StampingCase, build_model
from tests.unit.case.test_stamping_clashes import write_stl

THICKNESS, CLOSE, DEPTH = 0.8, 0.84, 12.0
SLOPE = np.radians(60.0)
"""Of the walls; 60 degrees: a gap along z is twice as wide as along the normal."""


def write_trench(path: Path, off: float) -> dict[str, Any]:
    """Write a trench of straight walls along y, moved by `off` along its normals towards the punch [mm]."""
    aside, width = off * np.tan(SLOPE / 2), np.array([20.0, 20.0 - DEPTH / np.tan(SLOPE)])
    x = np.array([-70.0, -width[0], -width[1], width[1], width[0], 70.0])
    x[1:5] += aside * np.array([1.0, 1.0, -1.0, -1.0])
    z = off + np.array([0.0, 0.0, -DEPTH, -DEPTH, 0.0, 0.0])
    points = np.array([[a, y, c] for y in (-70.0, 70.0) for a, c in zip(x, z, strict=True)])
    faces = np.array([t for i in range(5) for t in ((i, i + 1, i + 7), (i, i + 7, i + 6))])
    return write_stl(path, points, faces)


def press(folder: Path, off: float) -> Any:
    die = {"kind": "die", **write_trench(folder / "die.stl", 0.0)}
    punch = {"kind": "punch", **write_trench(folder / "punch.stl", off)}
    return build_model(StampingCase.model_validate({
        "title": "trench", "analysis": "stamping", "tools": {"die": die, "punch": punch},
        "blank": {"shape": "rectangle", "size": [90, 20], "thickness": THICKNESS, "element_size": 5,
                  "material": "dc04"},
        "stages": [{"name": "press", "tools": {"punch": {"close": CLOSE}}}],
    }))  # fmt: skip


def test_a_punch_that_is_the_die_moved_by_more_than_it_closes_to_goes_to_the_bottom(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """Moved by 1.1 thicknesses it comes down from the blank by the depth and one thickness, less `close`."""
    model = press(tmp_path, 1.1 * THICKNESS)
    stroke = -model.stages[0].tool_motion["punch"].move[2]
    assert stroke == pytest.approx(DEPTH + THICKNESS - CLOSE, abs=0.01)
    assert not [r for r in caplog.records if "level faces" in r.getMessage()]


@pytest.mark.parametrize(("off", "is_refused"), [(0.0, False), (-0.6, True)])
def test_one_that_is_not_is_told_how_far_the_bottom_is(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, off: float, is_refused: bool
) -> None:
    """Walls stop it at CLOSE along their normals: along z that is CLOSE / cos 60, and `off` the less there."""
    apart = (CLOSE - off) / np.cos(SLOPE) + off
    with caplog.at_level(logging.WARNING):
        if is_refused:
            with pytest.raises(CaseError, match=r"offset = 0\.88") as fault:
                press(tmp_path, off)
            text = str(fault.value)
        else:
            press(tmp_path, off)
            text = caplog.text
    assert "stages.0.tools.punch.close" in text
    found = float(text.split("level faces are still ")[1].split(" mm")[0])
    assert found == pytest.approx(apart, abs=0.01)
