# SPDX-License-Identifier: Apache-2.0
"""A map that follows nodes and keeps distances near them; values spread smoothly."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.geometry.rigid_warp import RigidWarp
from presswork.geometry.smooth_extension import extend_smoothly
from tests.problems.compensation import arc


def test_a_rigid_motion_is_exact_far_from_the_nodes_too() -> None:
    points, _ = arc(50.0)
    turn = np.array([[0.8, 0.0, -0.6], [0.0, 1.0, 0.0], [0.6, 0.0, 0.8]])
    warp = RigidWarp(points, points @ turn.T + [1.0, 2.0, 3.0], (False, False))
    x = np.random.default_rng(1).random((50, 3)) * 100.0
    assert warp.carry(x) == pytest.approx(x @ turn.T + [1.0, 2.0, 3.0], abs=1e-9)


def test_faces_on_both_sides_of_a_bent_strip_keep_their_distance_and_the_symmetry_plane() -> None:
    flat, _ = arc(1e7)
    bent, _ = arc(50.0)
    warp = RigidWarp(flat, bent, (True, False))
    s = np.linspace(-39.0, 39.0, 79)
    for height in (-0.5, 0.5):
        found = warp.carry(np.stack([s, 0 * s, np.full_like(s, height)], axis=1))
        radius = np.hypot(found[:, 0], found[:, 2] - 50.0)
        assert radius == pytest.approx(50.0 - height, abs=0.01)
        assert found[39, 0] == 0.0
        assert found == pytest.approx(found[::-1] * [-1.0, 1.0, 1.0], abs=1e-12)


def test_a_bend_at_the_edge_does_not_lift_the_ends_of_wide_tools() -> None:
    points, _ = arc(1e7)
    x = points[:, 0]
    moved = points + np.maximum(x - 30.0, 0.0)[:, None] * [
        0.0,
        0.0,
        -0.2,
    ]  # the last 10 mm, by 11 degrees
    warp = RigidWarp(points, moved, (True, False))
    far = np.array([[r, 0.0, side] for r in (41.0, 60.0, 100.0, 180.0) for side in (-0.5, 0.5)])
    drop = far[:, 2] - warp.carry(far)[:, 2]
    assert drop[:2] == pytest.approx(0.2 * 11.0, abs=0.1)  # straight on next to the edge
    assert drop.max() < 3.0  # straight on to the end it would be 30
    assert drop[::2] == pytest.approx(drop[1::2], abs=0.05)  # both faces alike


def test_values_go_on_with_their_slope_and_meet_what_is_held() -> None:
    points, triangles = arc(1e9, cells=40)
    x = points[:, 0]
    known = (x < 10.0) | (x > 30.0)
    values = np.where(known, np.minimum(x, 20.0), 0.0)[:, None]
    found = extend_smoothly(values, known, triangles)[:, 0]
    assert found[known] == pytest.approx(values[known, 0])
    assert (np.diff(found[1::3])[(x[1::3] < 20.0)[:-1]] > -1e-3).all()
    assert found.max() < 23.0
