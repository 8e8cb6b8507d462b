# SPDX-License-Identifier: Apache-2.0
"""What `check` says of tools that meet no resistance, that only slide, and of symmetry planes that look forgotten."""

from __future__ import annotations

import logging
from typing import Any

import pytest

from presswork.case import Case, CaseError, build_model
from presswork.case.space.schema import SpaceCase

STEEL = {
    "young": 206e3,
    "poisson": 0.3,
    "density": 7.85e-9,
    "hardening": {"law": "swift", "K": 700, "e0": 0.01, "n": 0.2},
}
AXIS = {"axis": {"set": "left", "fix": ["x"]}}
MIDDLE = {"middle": {"set": "bottom", "fix": ["y"]}}
DOWN = {"punch": {"stroke": 5, "direction": [0, -1]}}
BOX = {"size": [10, 12, 15], "cells": [2, 2, 3]}
QUARTER = {"x0": {"set": "left", "fix": ["x"]}, "y0": {"set": "bottom", "fix": ["y"]}}
DOWN_IN_SPACE = {"punch": {"stroke": 5, "direction": [0, 0, -1]}}
DYNAMIC = {"procedure": "explicit", "stages": [{"name": "press", "duration": 1e-4}]}


def line(y: float, left: float = -1.0, right: float = 30.0) -> dict[str, Any]:
    return {"profile": [[left, y], [right, y]], "contact": "sticking"}


def flat(z: float, up: float) -> dict[str, Any]:
    return {"shape": "plane", "normal": [0, 0, up], "position": [0, 0, z], "contact": "sticking"}


def sector(angle: float) -> dict[str, Any]:
    return {"kind": "cylinder", "radius": 10, "height": 15, "angle": angle, "cells": [3, 4, 3]}


def plane_case(tools: dict[str, Any], boundary: dict[str, Any], motion: dict[str, Any], **others: Any) -> Case:
    mesh = {"size": [10, 15], "cells": [2, 3]}
    data = {"title": "t", "analysis": "axisymmetric", "materials": {"steel": STEEL}, "boundary": boundary}
    data |= {"workpiece": {"material": "steel", "mesh": mesh, "element": "quad4_1pt"}, "tools": tools} | others
    return Case.model_validate(data | {"stages": [{"name": "press", **data.get("stages", [{}])[0], "tools": motion}]})


def space_case(
    mesh: dict[str, Any], tools: dict[str, Any], boundary: dict[str, Any], motion: dict[str, Any], **others: Any
) -> SpaceCase:
    data = {"title": "t", "analysis": "solid", "materials": {"steel": STEEL}, "boundary": boundary, "tools": tools}
    data |= {"workpiece": {"material": "steel", "mesh": mesh}} | others
    stages = [{"name": "press", **data.get("stages", [{}])[0], "tools": motion}]
    return SpaceCase.model_validate(data | {"stages": stages})


def build(case: Any, caplog: pytest.LogCaptureFixture) -> str:
    """Return the warnings of a case that is built."""
    with caplog.at_level(logging.WARNING, logger="presswork"):
        build_model(case, run_user_code=False)
    return caplog.text


def test_a_punch_over_no_anvil_is_refused_in_the_plane_and_the_remedy_mends_it() -> None:
    with pytest.raises(CaseError, match=r"punch: the tool pushes the workpiece along \(0, -1\)") as caught:
        build_model(plane_case({"punch": line(15)}, AXIS, DOWN))
    assert 'set = "bottom" and fix = ["y"]' in str(caught.value)
    build_model(plane_case({"punch": line(15)}, AXIS | MIDDLE, DOWN))
    build_model(plane_case({"punch": line(15), "anvil": line(-3)}, AXIS, DOWN))
    build_model(plane_case({"punch": line(15)}, AXIS, DOWN, limits={"stop": False}))


def test_a_punch_over_no_anvil_is_refused_in_space_and_the_remedy_mends_it() -> None:
    with pytest.raises(CaseError, match=r"punch: the tool pushes the workpiece along \(0, 0, -1\)") as caught:
        build_model(space_case(BOX, {"punch": flat(15, -1)}, QUARTER, DOWN_IN_SPACE))
    assert 'set = "back" and fix = ["z"]' in str(caught.value)
    below = {"z0": {"set": "back", "fix": ["z"]}}
    build_model(space_case(BOX, {"punch": flat(15, -1)}, QUARTER | below, DOWN_IN_SPACE))
    build_model(space_case(BOX, {"punch": flat(15, -1), "anvil": flat(0, 1)}, QUARTER, DOWN_IN_SPACE))


def test_dynamics_warn_of_it_for_inertia_resists(caplog: pytest.LogCaptureFixture) -> None:
    assert "would move with the tool" in build(plane_case({"punch": line(15)}, AXIS, DOWN, **DYNAMIC), caplog)
    caplog.clear()
    assert "would move with the tool" in build(
        space_case(BOX, {"punch": flat(15, -1)}, QUARTER, DOWN_IN_SPACE, **DYNAMIC), caplog
    )


def test_a_flat_tool_that_only_slides_along_itself_is_told(caplog: pytest.LogCaptureFixture) -> None:
    tools = {"punch": line(15), "anvil": line(0)}
    aside = {"punch": {"stroke": 5, "direction": [1, 0]}}
    assert "punch: the tool only slides" in build(plane_case(tools, AXIS, aside, analysis="plane_strain"), caplog)
    caplog.clear()
    tools, aside = {"punch": flat(15, -1), "anvil": flat(0, 1)}, {"punch": {"stroke": 5, "direction": [1, 0, 0]}}
    assert "punch: the tool only slides" in build(space_case(BOX, tools, QUARTER, aside), caplog)
    caplog.clear()
    aside = {"punch": {"stroke": 5, "direction": [1, 0, -1]}}
    assert not build(space_case(BOX, tools, QUARTER, aside), caplog)


@pytest.mark.parametrize("angle", [30, 60, 90])
def test_a_sector_without_its_second_plane_is_told(angle: float, caplog: pytest.LogCaptureFixture) -> None:
    tools = {"punch": flat(15, -1), "anvil": flat(0, 1)}
    first = {"first": {"set": "first_plane", "fix": ["normal"]}}
    assert "looks like a symmetry plane" in build(space_case(sector(angle), tools, first, DOWN_IN_SPACE), caplog)
    caplog.clear()
    both = first | {"last": {"set": "last_plane", "fix": ["normal"]}}
    assert not build(space_case(sector(angle), tools, both, DOWN_IN_SPACE), caplog)


def test_a_forgotten_coordinate_plane_is_told(caplog: pytest.LogCaptureFixture) -> None:
    tools = {"punch": line(15), "anvil": line(0)}
    assert "the plane x = 0 (set 'left')" in build(plane_case(tools, {}, DOWN, analysis="plane_strain"), caplog)
    caplog.clear()
    flats = {"punch": flat(15, -1), "anvil": flat(0, 1)}
    assert "y = 0 (set 'bottom')" in build(space_case(BOX, flats, {"x0": QUARTER["x0"]}, DOWN_IN_SPACE), caplog)


def straight(z: float, up: float) -> dict[str, Any]:
    return {"shape": "straight", "profile": [[-20, z], [40, z], [40, z - 9 * up]], "contact": "sticking"}


def test_a_half_that_is_whole_along_y_is_known_by_its_tools(caplog: pytest.LogCaptureFixture) -> None:
    """A punch over the middle of a block from y = 0 to 12, which has no mirror image of itself beyond y = 0."""
    punch = {"shape": "box", "size": [40, 20, 8], "contact": "sticking"}
    tools = {"punch": {**punch, "position": [0, 6, 19]}, "anvil": flat(0, 1)}
    assert not build(space_case(BOX, tools, {"x0": QUARTER["x0"]}, DOWN_IN_SPACE), caplog)
    tools["punch"] = {**punch, "position": [0, 0, 19], "size": [40, 40, 8]}
    assert "y = 0 (set 'bottom')" in build(space_case(BOX, tools, {"x0": QUARTER["x0"]}, DOWN_IN_SPACE), caplog)


def test_a_tool_that_goes_straight_on_without_end_tells_no_plane(caplog: pytest.LogCaptureFixture) -> None:
    tools = {"punch": straight(15, -1), "anvil": straight(0, 1)}
    assert "symmetry plane" not in build(space_case(BOX, tools, {}, DOWN_IN_SPACE), caplog)


@pytest.mark.parametrize("name", ["whole", "equal", "no_plane", "half"])
def test_no_plane_is_missed_where_the_whole_workpiece_is_modelled(name: str, caplog: pytest.LogCaptureFixture) -> None:
    ends = {"whole": (-20.0, 30.0), "equal": (0.0, 10.0)}
    flats = {"punch": flat(15, -1), "anvil": flat(0, 1)}
    case: Any = space_case(BOX, flats, {}, DOWN_IN_SPACE)
    if name in ends:
        tools = {"punch": line(15, *ends[name]), "anvil": line(0, *ends[name])}
        case = plane_case(tools, {}, DOWN, analysis="plane_strain")
    elif name == "half":
        case = space_case({**BOX, "origin": [0, -6, 0]}, flats, {"x0": QUARTER["x0"]}, DOWN_IN_SPACE)
    assert not build(case, caplog)
