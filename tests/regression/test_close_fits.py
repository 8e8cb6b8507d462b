# SPDX-License-Identifier: Apache-2.0
"""A punch that slides in a container with a clearance far below the cells takes the metal at the wall along."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import build_model
from presswork.case import Case
from presswork.case.space.schema import SpaceCase
from presswork.model import SweptProfile, Triangulation
from presswork.process.begin import begin
from tests.unit.case.test_space_tool_shapes import box_facets, write_stl

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


def test_the_wall_of_a_container_that_ends_beside_the_punch_stays() -> None:
    """Its upper corner goes along the punch, too, but away from the billet."""
    data: dict[str, Any] = extrusion("axisymmetric", 0.005).model_dump(exclude_unset=True)
    wall = [[30, 35], [RADIUS, 35], [RADIUS, 0], {"to": [4, 0], "radius": 1}, [4, -20]]
    data["tools"]["container"]["profile"] = wall
    container = build_model(Case.model_validate(data)).plane_tools[0]
    assert RADIUS in container.profile.segments[:, 0]


def extrusion_in_space(punch: dict[str, Any], walls: dict[str, Any], mesh: dict[str, Any]) -> SpaceCase:
    """A part of a billet that fills a container and is pressed through a round hole in its floor."""
    law = {"contact": "coulomb", "mu": 0.05}
    planes = ("first_plane", "last_plane") if "radius" in mesh else ("left", "bottom")
    floor = {"shape": "round", "profile": [[30, 0], {"to": [4, 0], "radius": 1.5}, [4, -20]]}
    tools = {**walls, "floor": floor, "punch": punch}
    return SpaceCase.model_validate(
        {
            "title": "a punch in its container",
            "analysis": "solid",
            "workpiece": {"material": "steel", "mesh": mesh},
            "materials": extrusion("axisymmetric", 0.0).model_dump(exclude_unset=True)["materials"],
            "boundary": {name: {"set": name, "fix": ["normal"]} for name in planes},
            "tools": {name: tool | law for name, tool in tools.items()},
            "stages": [{"name": "press", "tools": {"punch": {"stroke": 0.2, "direction": [0, 0, -1]}}}],
            "limits": {"stop": False},
        }
    )


SECTOR = {"kind": "cylinder", "radius": RADIUS, "height": HEIGHT, "angle": 30, "cells": [4, 2, 6]}
ROUND_WALL = {"container": {"shape": "round", "profile": [[RADIUS, 60], [RADIUS, -5]]}}
BLOCK = {"size": [RADIUS, 8, HEIGHT], "cells": [5, 4, 10]}
FLAT_WALLS = {
    "along": {"shape": "plane", "normal": [-1, 0, 0], "position": [RADIUS, 0, 0]},
    "across": {"shape": "plane", "normal": [0, -1, 0], "position": [0, 8, 0]},
}
SIDE = RADIUS - 0.005


@pytest.mark.parametrize(
    "punch",
    [
        {"shape": "round", "profile": [[0, HEIGHT], [SIDE, HEIGHT], [SIDE, HEIGHT + 20]]},
        {"shape": "cylinder", "radius": SIDE, "length": 20, "position": [0, 0, HEIGHT + 10]},
    ],
)
def test_a_punch_in_space_takes_the_wall_along(punch: dict[str, Any]) -> None:
    """Drawn with its clearance it lets the metal at the wall flow back, by 0.2 mm."""
    run = begin(build_model(extrusion_in_space(punch, ROUND_WALL, SECTOR)), threads=1)
    for _ in run.advance():
        pass
    top = run.model.mesh.node_sets["front"]
    np.testing.assert_allclose(run.procedure.state.nodes.displacement[top, 2], -0.2, atol=1e-3)


@pytest.mark.parametrize("walls", [("along",), ("along", "across")])
@pytest.mark.parametrize("shape", ["box", "straight", "file"])
def test_a_punch_between_flat_walls_in_space_is_moved_past_them(
    shape: str, walls: tuple[str, ...], tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    x, y, z = SIDE, 8 - 0.005, HEIGHT
    punch = {
        "box": {"size": [2 * x, 2 * y, 20], "position": [0, 0, z + 10]},
        "straight": {"profile": [[-x, z + 20], [-x, z], [x, z], [x, z + 20]]},
        "file": {"path": str(tmp_path / "punch.stl")},
    }[shape]
    write_stl(tmp_path / "punch.stl", box_facets((-x, -y, z), (x, y, z + 20), 2))
    chosen = {name: FLAT_WALLS[name] for name in walls}
    with caplog.at_level(logging.WARNING):
        model = build_model(extrusion_in_space({"shape": shape, **punch}, chosen, BLOCK))
    closed = model.tools[-1].surface
    assert isinstance(closed, Triangulation)
    reach = closed.points.max(axis=0)
    assert RADIUS < reach[0] < RADIUS + 0.2
    if shape != "straight":
        assert (8.0 < reach[1] < 8.2) == ("across" in walls)
    assert "tools.punch: its side stands 0.005 mm from tools.along" in caplog.text


def test_a_clearance_in_space_that_cells_can_flow_into_stays() -> None:
    punch = {"shape": "cylinder", "radius": 9.5, "length": 20, "position": [0, 0, HEIGHT + 10]}
    closed = build_model(extrusion_in_space(punch, ROUND_WALL, SECTOR)).tools[-1].surface
    assert isinstance(closed, SweptProfile)
    assert closed.half_widths[0] + closed.segments[:, [0, 2]].max() == 9.5


def test_dies_that_close_on_each_other_keep_their_shape() -> None:
    """Their faces come near each other along the stroke, which is no clearance."""
    data: dict[str, Any] = extrusion("axisymmetric", 0.005).model_dump(exclude_unset=True)
    law = {"contact": "coulomb", "mu": 0.05}
    above = [[0, HEIGHT], [9.995, HEIGHT], [9.995, 0.02], [20, 0.02]]
    data["tools"] = {"floor": {"profile": [[20, 0], [0, 0]], **law}, "punch": {"profile": above, **law}}
    data["workpiece"]["mesh"]["size"] = [9.99, HEIGHT]
    assert find_side(Case.model_validate(data | {"limits": {"stop": False}})) == 20.0
