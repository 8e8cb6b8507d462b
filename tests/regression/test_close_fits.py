# SPDX-License-Identifier: Apache-2.0
"""A punch that slides in a container with a clearance far below the cells takes the metal at the wall along."""

from __future__ import annotations

import logging
from typing import Any

import numpy as np
import pytest

from presswork import build_model
from presswork.case import Case
from presswork.process.begin import begin

RADIUS, HEIGHT, STROKE = 10.0, 20.0, 0.9


def extrusion(analysis: str, clearance: float, stroke: float = STROKE) -> Case:
    """A billet that fills a container and is pressed through its floor."""
    law = {"contact": "coulomb", "mu": 0.05}
    wall = [[RADIUS, 60], [RADIUS, 0], {"to": [4, 0], "radius": 1}, [4, -20]]
    side = RADIUS - clearance
    return Case.model_validate(
        {
            "title": "a punch in its container",
            "analysis": analysis,
            "workpiece": {"material": "steel", "mesh": {"size": [RADIUS, HEIGHT], "cells": [8, 12]}},
            "materials": {
                "steel": {
                    "young": 206000.0,
                    "poisson": 0.3,
                    "hardening": {"law": "swift", "K": 700.0, "e0": 0.01, "n": 0.2},
                }
            },
            "boundary": {"axis": {"set": "left", "fix": ["x"]}},
            "tools": {
                "container": {"profile": wall, **law},
                "punch": {"profile": [[0, HEIGHT], [side, HEIGHT], [side, HEIGHT + 20]], **law},
            },
            "stages": [{"name": "press", "tools": {"punch": {"stroke": stroke, "direction": [0, -1]}}}],
            "solver": {"initial_increment": 0.05, "max_increment": 0.05},
        }
    )


def find_side(case: Case) -> float:
    """Return how far the punch reaches [mm]."""
    punch = next(tool for tool in build_model(case).plane_tools if tool.name == "punch")
    return float(punch.profile.segments[:, [0, 2]].max())


@pytest.mark.parametrize("clearance", [0.0, 0.005])
def test_a_punch_with_no_room_for_cells_takes_the_wall_along(clearance: float) -> None:
    """Drawn with its clearance it cuts into the metal at the wall, which stays behind, before 0.8 mm."""
    run = begin(build_model(extrusion("axisymmetric", clearance)), threads=1)
    for _ in run.advance():
        pass
    model, state = run.model, run.procedure.state
    top = model.mesh.node_sets["top"]
    moved = state.nodes.displacement[top, 1]
    np.testing.assert_allclose(moved, -STROKE, atol=1e-6)


def test_a_clearance_below_the_cells_is_closed_and_said(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING):
        assert find_side(extrusion("plane_strain", 0.005)) > RADIUS
    assert "tools.punch: its side stands 0.005 mm from tools.container" in caplog.text


def test_a_clearance_that_cells_can_flow_into_stays() -> None:
    assert find_side(extrusion("axisymmetric", 0.5)) == RADIUS - 0.5


def test_dies_that_close_on_each_other_keep_their_shape() -> None:
    """Their faces come near each other along the stroke, which is no clearance."""
    data: dict[str, Any] = extrusion("axisymmetric", 0.005).model_dump(exclude_unset=True)
    law = {"contact": "coulomb", "mu": 0.05}
    above = [[0, HEIGHT], [9.995, HEIGHT], [9.995, 0.02], [20, 0.02]]
    data["tools"] = {"floor": {"profile": [[20, 0], [0, 0]], **law}, "punch": {"profile": above, **law}}
    data["workpiece"]["mesh"]["size"] = [9.99, HEIGHT]
    assert find_side(Case.model_validate(data | {"limits": {"stop": False}})) == 20.0
