# SPDX-License-Identifier: Apache-2.0
"""The radius over which the mean of the damage decides is a tenth of the whole body's thickness, on any mesh."""

from __future__ import annotations

from typing import Any

import pytest

from presswork.case import build_model
from presswork.model import Model
from presswork.observe.damage_length import find_lengths
from tests.unit.case.test_resistance import (
    AXIS,
    DOWN,
    DOWN_IN_SPACE,
    MIDDLE,
    QUARTER,
    flat,
    line,
    plane_case,
    sector,
    space_case,
)


def build_in_plane(boundary: dict[str, Any], cells: list[int], origin: float = 0.0, **others: Any) -> Model:
    """A body of 10 x 15 mm."""
    mesh = {"size": [10, 15], "cells": cells, "origin": [origin, 0]}
    tools = {"punch": line(15, right=60.0), "anvil": line(0, right=60.0)}
    return build_model(plane_case(tools, boundary, DOWN, workpiece={"material": "steel", "mesh": mesh}, **others))


def build_in_space(mesh: dict[str, Any], boundary: dict[str, Any]) -> Model:
    return build_model(space_case(mesh, {"punch": flat(15, -1), "anvil": flat(0, 1)}, boundary, DOWN_IN_SPACE))


@pytest.mark.parametrize("cells", [[6, 10], [12, 16]])
def test_of_a_cylinder_it_is_that_of_the_ball_inside(cells: list[int]) -> None:
    """Of 20 mm across and 15 mm high, or twice as high with a middle plane."""
    assert find_lengths(build_in_plane(AXIS, cells)) == [pytest.approx(1.5, rel=0.02)]
    assert find_lengths(build_in_plane(AXIS | MIDDLE, cells)) == [pytest.approx(2.0, rel=0.02)]


def test_of_a_ring_it_is_that_of_its_wall() -> None:
    assert find_lengths(build_in_plane({}, [6, 10], origin=40.0)) == [pytest.approx(1.0, rel=0.02)]


def test_of_half_a_strip_it_is_that_of_the_whole() -> None:
    strip: dict[str, Any] = {"analysis": "plane_strain", "limits": {"stop": False}}
    assert find_lengths(build_in_plane({}, [6, 10], **strip)) == [pytest.approx(1.0, rel=0.02)]
    assert find_lengths(build_in_plane(AXIS, [6, 10], **strip)) == [pytest.approx(1.5, rel=0.02)]


def test_of_a_part_in_space_it_is_that_of_the_whole() -> None:
    """Blocks 20 mm wide, 24 long and 15 or 30 high; sectors of a cylinder of 20 mm, 15 or 30 mm high."""
    box = {"size": [10, 12, 15], "cells": [4, 4, 6]}
    below = {"z0": {"set": "back", "fix": ["z"]}}
    planes = {name: {"set": f"{name}_plane", "fix": ["normal"]} for name in ("first", "last")}
    for mesh, sides in ((box, QUARTER), (sector(30), planes)):
        assert find_lengths(build_in_space(mesh, sides)) == [pytest.approx(1.5, rel=0.03)]
        assert find_lengths(build_in_space(mesh, sides | below)) == [pytest.approx(2.0, rel=0.03)]
