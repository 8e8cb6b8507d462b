# SPDX-License-Identifier: Apache-2.0
"""The least radius of a tool made of triangles, against the radii that it was drawn with."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.geometry.swept_tool import draw_punch, triangulate
from presswork.geometry.tool_radius import find_least_radius


@pytest.mark.parametrize("radius", [2.0, 5.0, 10.0])
@pytest.mark.parametrize("within", [0.1, 0.01])
def test_the_edge_radius_of_a_round_punch_is_found(radius: float, within: float) -> None:
    points, triangles = triangulate(draw_punch((25.0, 25.0), 25.0, radius, 30.0), within)
    found = find_least_radius(points, triangles, length=20.0)
    assert radius / 1.25 < found < 1.25 * radius


def test_a_sharp_edge_has_no_radius_and_a_flat_face_an_infinite_one() -> None:
    """Two faces of a box, of two triangles each, that share an edge of 10 mm."""
    points = np.array([[0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0], [0, 0, 10], [10, 0, 10]], float)
    flat = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    bent = np.concatenate([flat, np.array([[0, 5, 1], [0, 4, 5]], np.int32)])
    assert find_least_radius(points, flat, 5.0) == float("inf")
    assert find_least_radius(points, bent, 5.0) == 0.0
    assert find_least_radius(points, bent, 5.0, sharp_counts=False) == float("inf")
    assert find_least_radius(points, bent, 11.0) == float("inf")  # less than that is sharp
