# SPDX-License-Identifier: Apache-2.0
"""Nearest places on triangles, and long triangles split."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.geometry.foot_on_triangles import find_feet, split_long

POINTS = np.array([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [10.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])


def test_split_triangles_cover_what_they_did_and_feet_are_the_nearest_places() -> None:
    points, triangles = split_long(POINTS, TRIANGLES, 0.7)
    corners = points[triangles]
    areas = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2]
    assert areas.sum() == pytest.approx(10.0)
    assert areas.min() > 0.0
    assert max(np.linalg.norm(corners[:, i] - corners[:, i - 1], axis=1).max() for i in range(3)) <= 0.7
    x = np.random.default_rng(1).random((200, 3)) * [12.0, 3.0, 1.0] - [1.0, 1.0, 0.0]
    found = find_feet(x, points, triangles).interpolate(points, triangles)
    assert found == pytest.approx(np.clip(x, 0.0, [10.0, 1.0, 0.0]), abs=1e-12)
