# SPDX-License-Identifier: Apache-2.0
"""Lines and arcs as polylines."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.post import distance_to_profile, trace_profile

# Down a wall, a quarter arc about (2, 0) that turns counter-clockwise, along a floor.
WALL_FILLET_FLOOR = np.array(
    [[0.0, 5, 0, 0, 0, 0, 0], [0.0, 0, 2, -2, 2, 0, 1], [2.0, -2, 6, -2, 0, 0, 0]],
)


def test_connected_segments_make_one_line_through_their_ends() -> None:
    (line,) = trace_profile(WALL_FILLET_FLOOR)
    np.testing.assert_allclose(line[[0, 1, -2, -1]], [[0, 5], [0, 0], [2, -2], [6, -2]])
    np.testing.assert_allclose(np.linalg.norm(line[1:-1] - [2, 0], axis=1), 2.0)
    assert np.all(line[2:-2, 1] < 0)


def test_clockwise_arc_goes_the_other_way() -> None:
    (line,) = trace_profile(np.array([[0.0, 0, 2, -2, 2, 0, -1]]))
    length = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
    assert length == pytest.approx(2 * 1.5 * np.pi, rel=1e-3)


def test_separate_segments_make_separate_lines() -> None:
    assert len(trace_profile(WALL_FILLET_FLOOR[[0, 2]])) == 2


def test_distance_is_to_the_nearest_place() -> None:
    points = np.array([[1.0, 3], [2, -0.5], [8, -2], [0, 0]])
    np.testing.assert_allclose(distance_to_profile(points, trace_profile(WALL_FILLET_FLOOR)), [1, 1.5, 2, 0], atol=1e-3)
