# SPDX-License-Identifier: Apache-2.0
"""A rim is flanged and hemmed, onto the panel itself and round an inner panel: how thick a flat hem is; resume."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from presswork.case import StampingCase, build_model
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts, run_to_end

SHEET, INNER = 1.0, 0.8
ROOM = 2.04
"""That the steel leaves to both layers [mm]: 2 % more than their thickness."""
SIDES = {"top": {"set": "top", "hold": "symmetry_y"}, "bottom": {"set": "bottom", "hold": "symmetry_y"}}


def block(kind: str, x0: float, x1: float, z0: float, z1: float, **more: Any) -> dict[str, Any]:
    """A tool of a rectangular section."""
    return {"kind": kind, "shape": "section", "corners": [[x0, z0], [x1, z0], [x1, z1], [x0, z1]], **more}


def hem_line(inner: float) -> dict[str, Any]:
    """Half of a strip of 40 x 2 mm, flanged at 12 mm, bent in to 45 degrees, pressed flat; inner: 0 is none."""
    flange = {
        "name": "flange",
        "tools": {
            "anvil": block("die", 0, 11, 0, -5, radius=[0, 1, 0, 0]),
            "punch": block("punch", 0, 12, 0, 10, radius=[0, 1, 0, 0]),
            "die": block("die", 13.05, 25, 0, -10, radius=[2, 0, 0, 0]),
        },
        "boundary": SIDES,
        "stages": [{"name": "up", "tools": {"die": {"stroke": 9}}, "velocity": "3 m/s"}],
    }
    hem = {
        "name": "hem",
        "tools": {
            "anvil": block("die", 0, 20, 0, -5, position=[0, 0, -0.5 * SHEET]),
            "prehem": {
                "kind": "punch", "shape": "section", "corners": [[16.5, 3], [22, 8.5], [15, 15.5], [9.5, 10]],
                "radius": [1, 0, 0, 1], "direction": [-1, 0, -1], "position": [0, 0, 2.6],
            },
            "steel": block("punch", 0, 18, 0, 8, radius=[0, 1, 0, 0], position=[0, 0, 9.0]),
        },
        "boundary": SIDES,
        "stages": [
            {"name": "prehem", "tools": {"prehem": {"stroke": 6}}, "velocity": "3 m/s"},
            {"name": "press", "tools": {"prehem": {"stroke": -6}, "steel": {"close": ROOM + inner}},
             "duration": "3 ms"},
        ],
        "hem": {"outward": [1, 0]},
    }  # fmt: skip
    if inner:
        plate = block("holder", 0, 10.5, 0, inner, radius=[0, 0.2, 0.2, 0], position=[0, 0, 0.5 * SHEET])
        hem["tools"]["inner"] = plate
    return {
        "title": "hem",
        "analysis": "stamping",
        "blank": {
            "shape": "rectangle", "size": [40, 2], "thickness": SHEET, "element_size": [0.5, 1.0],
            "material": "steel", "symmetry": ["x"],
        },
        "materials": {"steel": {
            "young": 206e3, "poisson": 0.3, "density": "7850 kg/m^3",
            "hardening": {"law": "swift", "K": 560, "e0": 0.007, "n": 0.25},
        }},
        "self_contact": {"mu": 0.1},
        "explicit": {"target_step": "0.18 us"},
        "operations": [flange, hem],
        "output": {"steps": 2, "rows": 30, "checkpoint_every": 10},
    }  # fmt: skip


@pytest.mark.parametrize("inner", [0.0, INNER])
def test_a_flat_hem_is_as_thick_as_its_sheets(inner: float, tmp_path) -> None:
    """Two sheets and the inner panel, up to the room that the steel leaves; overlap below 3 % of the thickness."""
    result = run_to_end(build_model(StampingCase.model_validate(hem_line(inner))), tmp_path)
    hem, history = result.summary["hem"], result.history
    least, most = hem["formed"]["thickness_mm"]
    assert most == pytest.approx(ROOM + inner, abs=0.03)
    assert least > 2.0 * SHEET + inner - 0.03
    assert abs(hem["formed"]["opening_degrees"]["mean"]) < 1.0
    assert hem["roll_in_mm"]["mean"] > 0.0
    assert result.summary["overlap_mm"] < 0.03 * SHEET
    assert (result.summary["overlap_mm"] > 0.0) == (inner == 0.0), "without an inner panel the flange lies on the panel"
    assert np.abs(history["energy_error_percent"]).max() < 2.0
    assert history["hem_prehem.stroke"].max() == pytest.approx(6.0, rel=1e-6)


def test_a_hem_goes_on_with_the_same_bits(tmp_path) -> None:
    """Stopped while the flange is pressed on the panel."""
    model = build_model(StampingCase.model_validate(hem_line(0.0)))
    run_to_end(model, tmp_path / "whole")
    run_in_two_parts(model, tmp_path / "parts", 86)
    assert_same_bits(tmp_path / "parts", tmp_path / "whole")
