# SPDX-License-Identifier: Apache-2.0
"""How far tools go before they strike, against geometry."""

import math

import numpy as np
import pytest

from presswork.geometry.swept_tool import draw_die, draw_holder, draw_punch
from presswork.mesh.tool_clearance import find_clearance
from presswork.model import Triangulation

DOWN = np.array([0.0, 0.0, -1.0])
DIE = draw_die((20.0, 20.0), 20.0, 5.0, width=40.0, depth=30.0)
HOLDER = draw_holder((21.0, 21.0), 21.0, 1.0, width=40.0, height=30.0)
PUNCH = draw_punch((18.0, 18.0), 18.0, 4.0, 40.0)


def plane(angle: float, up: bool, half: float = 20.0) -> Triangulation:
    """A square seen from above, tilted about y by an angle [degrees]; metal below (up) or above."""
    xy = half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], dtype=float)
    points = np.column_stack([xy, math.tan(math.radians(angle)) * xy[:, 0]])
    triangles = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
    return Triangulation(points, triangles if up else np.ascontiguousarray(triangles[:, ::-1]), False)


@pytest.mark.parametrize("start", [0.3, 1.6, 25.0])
def test_flat_faces_strike_where_they_meet(start: float) -> None:
    between = np.array([0.0, 0.0, start])
    assert find_clearance(HOLDER, DIE, between, DOWN, 0.1) == pytest.approx(start, abs=1e-9)
    assert find_clearance(DIE, HOLDER, -between, -DOWN, 0.1) == pytest.approx(start, abs=1e-9)


@pytest.mark.parametrize("angle", [0.0, 30.0, 60.0])
def test_tilted_faces_strike_after_what_lies_between_them_along_the_way(angle: float) -> None:
    found = find_clearance(plane(angle, up=False), plane(angle, up=True), np.array([0, 0, 3.0]), DOWN, 0.1)
    assert found == pytest.approx(3.0, abs=2.1e-4)


def test_a_punch_goes_through_its_die_and_overlapping_tools_have_no_clearance() -> None:
    assert find_clearance(PUNCH, DIE, np.array([0, 0, 1.0]), DOWN, 0.1) == math.inf
    assert find_clearance(HOLDER, DIE, np.array([0, 0, -1.0]), DOWN, 0.1) == math.inf
