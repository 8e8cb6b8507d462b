# SPDX-License-Identifier: Apache-2.0
"""Sizes and trigger before two bodies touch."""

import numpy as np
import pytest

from presswork.remesh.landing import draw_outline
from presswork.remesh.narrow_gaps import SHARP, find_corners_ahead, find_narrow_gap
from presswork.remesh.size_field import OF_RADIUS

BASE = np.array([[0, 0], [10, 0], [10, 4], [8, 4], [6, 4], [4, 4], [2, 4], [0, 4]], dtype=float)
"""A block whose top, with nodes 2 mm apart, is free."""
FREE = (BASE[:, 1] == 4.0) & (BASE[:, 0] > 0)
BLOCK = np.array([[0, 4.5], [3, 4.5], [3, 9], [0, 9]], dtype=float)
"""Above it, its lower right corner over an edge."""
COARSE, FINE = (lambda points: np.full(len(points), 2.0)), (lambda points: np.full(len(points), 0.5))


def round_nose(radius: float, n: int) -> np.ndarray:
    """Return a disc 0.5 mm above the base, of n sides, whose corners are less than SHARP."""
    angle = 2 * np.pi * np.arange(n) / n
    return np.column_stack([5 + radius * np.cos(angle), 4.5 + radius + radius * np.sin(angle)])


def test_a_corner_that_comes_near_asks_for_the_smallest_size_and_what_points_inwards_for_none():
    found = find_corners_ahead(BASE, FREE, draw_outline(BLOCK), smallest=0.3, largest=1.0)
    assert found.place.tolist() == [[3.0, 4.5]]  # that at x = 0 comes to the end of the free surface
    assert found.size == pytest.approx(0.3)
    notch = np.array([[0, 4.5], [2, 4.5], [3, 5.5], [4, 4.5], [10, 4.5], [10, 9], [0, 9]], dtype=float)
    found = find_corners_ahead(BASE, FREE, draw_outline(notch), smallest=0.3, largest=1.0)
    assert (3.0, 5.5) not in {tuple(place) for place in found.place.tolist()}
    assert len(found.size) >= 2


def test_a_round_asks_for_a_quarter_of_its_radius():
    n = 48
    assert 2 * np.pi / n < SHARP
    found = find_corners_ahead(BASE, FREE, draw_outline(round_nose(2.0, n)), smallest=0.1, largest=1.0)
    assert found.size.min() == pytest.approx(OF_RADIUS * 2.0, rel=0.01)
    assert not len(find_corners_ahead(BASE, FREE, draw_outline(round_nose(8.0, n)), smallest=0.1, largest=1.0).size)


def test_bodies_that_touch_go_away_or_are_far_ask_for_nothing():
    sizes = {"smallest": 0.3, "largest": 1.0}
    assert not len(find_corners_ahead(BASE, FREE & False, draw_outline(BLOCK), **sizes).size)
    assert not len(find_corners_ahead(BASE, FREE, draw_outline(BLOCK - [0, 0.5]), **sizes).size)
    assert not len(find_corners_ahead(BASE, FREE, draw_outline(BLOCK - [0, -3.0]), **sizes).size)


def test_the_trigger_names_the_gap_and_the_edge_before_the_bodies_touch():
    outline = draw_outline(BLOCK)
    assert find_narrow_gap(BASE, FREE, outline, FINE) == (
        "a gap of 0.5 mm to another body, narrow for an edge of 2 mm near (3, 4)"
    )
    assert find_narrow_gap(BASE, FREE, outline, COARSE) is None
    assert find_narrow_gap(BASE, FREE, draw_outline(BLOCK - [0, -2.0]), FINE) is None
    assert find_narrow_gap(BASE, FREE & False, outline, FINE) is None
    assert find_narrow_gap(BASE, FREE, outline, FINE, wait=4.0) is None
