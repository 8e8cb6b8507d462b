# SPDX-License-Identifier: Apache-2.0
"""Profiles by the way along them."""

import numpy as np
import pytest

from presswork.geometry.profile_path import ProfilePath

# a line, a quarter circle of radius 2 to the left, a line upwards; then a corner to the right
PROFILE = np.array(
    [
        [0, 0, 4, 0, 0, 0, 0],
        [4, 0, 6, 2, 4, 2, 1],
        [6, 2, 6, 5, 0, 0, 0],
        [6, 5, 9, 5, 0, 0, 0],
    ],
    dtype=float,
)


def test_length_and_places_follow_lines_and_arcs():
    way = ProfilePath(PROFILE)
    assert way.length == pytest.approx(4 + np.pi + 3 + 3)
    half = way.at(np.array([2.0, 4 + np.pi / 2, 4 + np.pi + 1.5]))
    np.testing.assert_allclose(half, [[2, 0], [4 + 2**0.5, 2 - 2**0.5], [6, 3.5]], atol=1e-14)


def test_nearest_place_is_found_again_and_its_distance_is_right():
    way = ProfilePath(PROFILE)
    along = np.linspace(0.1, way.length - 0.1, 57)
    found, distance = way.find(way.at(along))
    np.testing.assert_allclose(found, along, atol=1e-12)
    assert distance.max() < 1e-14
    at, distance = way.find(np.array([[2.0, 1.0], [-3.0, 4.0]]))
    np.testing.assert_allclose(at, [2, 0], atol=1e-12)
    np.testing.assert_allclose(distance, [1, 5])


def test_only_sharp_meetings_are_corners_and_their_turn_has_a_sign():
    corners, turn = ProfilePath(PROFILE).corners()
    np.testing.assert_allclose(corners, [4 + np.pi + 3])
    np.testing.assert_allclose(turn, [-np.pi / 2])


def test_closed_profile_goes_round():
    circle = np.array([[1, 0, -1, 0, 0, 0, 1], [-1, 0, 1, 0, 0, 0, 1]], dtype=float)
    way = ProfilePath(circle)
    assert way.is_closed
    np.testing.assert_allclose(way.at(np.array([2.5 * np.pi])), [[0, 1]], atol=1e-12)
    assert len(way.corners()[0]) == 0
