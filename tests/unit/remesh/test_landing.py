"""Where a free surface comes to lie on a tool, and how small cells are there."""

import numpy as np
import pytest

from presswork.remesh.landing import LEAST, OF_GAP, REACH, draw_outline, find_closing, find_landings

PLATEN = np.array([[10.0, 2.0, -10.0, 2.0, 0.0, 0.0, 0.0]])
"""Flat, at y = 2; the metal is beneath it."""
ROUND = np.array([[0, 0], [6, 0], [6, 1.0], [6, 1.2], [5.5, 1.6], [5, 2.0], [4, 2], [2, 2], [0, 2.0]])
"""A block whose upper right corner leaves the platen step by step."""
NOTHING = np.zeros(len(ROUND))
"""Of the tool's force, at each node."""


def test_a_point_comes_nearer_by_its_own_motion_or_by_that_of_the_tool():
    points, still = np.array([[0.0, 1.0], [1.0, 1.5]]), np.zeros((2, 2))
    up, down = still + 0.1, still - 0.1
    lower = PLATEN - [0, -0.2, 0, -0.2, 0, 0, 0]
    assert find_closing(points, up, [PLATEN], [PLATEN]).all()
    assert not find_closing(points, down, [PLATEN], [PLATEN]).any()
    assert find_closing(points, down, [PLATEN], [lower]).all()
    assert not find_closing(points, still, [PLATEN], [PLATEN]).any()
    assert find_closing(points, up, [], []).shape == (0, 2)


def test_a_surface_lands_on_another_body_as_on_a_tool():
    """The other body lies above y = 2, its metal on the left of its outline."""
    block = draw_outline(np.array([[-10.0, 2.0], [10.0, 2.0], [10.0, 4.0], [-10.0, 4.0]]))
    held = ROUND[:, 1] == 2.0
    found = [
        find_landings(ROUND, held, ~held & (ROUND[:, 1] > 0), profile, NOTHING, smallest=0.3, largest=1.0)
        for profile in (PLATEN, block)
    ]
    np.testing.assert_array_equal(found[0].place, found[1].place)
    np.testing.assert_allclose(found[0].size, found[1].size)
    up = np.tile([0.0, 0.1], (len(ROUND), 1))
    assert find_closing(ROUND - up, up, [block], [block])[0].all()


def test_cells_are_small_from_the_end_of_contact_on_by_the_gap():
    held = ROUND[:, 1] == 2.0
    found = find_landings(ROUND, held, ~held & (ROUND[:, 1] > 0), PLATEN, NOTHING, smallest=0.3, largest=1.0)
    by_place = {tuple(place): size for place, size in zip(found.place.tolist(), found.size.tolist(), strict=True)}
    assert by_place == {
        (5.0, 2.0): pytest.approx(0.3),
        (5.5, 1.6): pytest.approx(0.3),
        (6.0, 1.2): pytest.approx(OF_GAP * 0.8),
        (6.0, 1.0): pytest.approx(OF_GAP * 1.0),
    }


def test_both_ends_of_a_contact_count_and_no_more_of_the_surface_than_is_near():
    held = ROUND[:, 1] == 2.0
    free = ~held & (ROUND[:, 1] > 0)
    mirrored = ROUND[::-1] * [-1, 1]
    other_way = find_landings(mirrored, held[::-1], free[::-1], PLATEN, NOTHING, smallest=0.5, largest=1.0)
    assert sorted(-other_way.place[:, 0]) == [5.0, 5.5, 6.0, 6.0]
    near = find_landings(ROUND, held, free, PLATEN, NOTHING, smallest=0.05, largest=0.7 / REACH)
    assert sorted(near.place[:, 0]) == [5.0, 5.5]


@pytest.mark.parametrize(("each", "size"), [(0.01, 0.3), (0.06, 0.24), (0.2, LEAST * 0.3)])
def test_an_edge_that_lands_adds_no_more_than_a_hundredth_of_the_force(each, size):
    """The last three nodes stand for 4.32 mm: two edges, half of the one behind them and half of the free one."""
    held = ROUND[:, 1] == 2.0
    share = np.where(held & (ROUND[:, 0] > 1), each, 0.0)
    found = find_landings(ROUND, held, ~held & (ROUND[:, 1] > 0), PLATEN, share, smallest=0.3, largest=1.0)
    assert found.size.min() == pytest.approx(size, rel=1e-3)
    mirrored = ROUND[::-1] * [-1, 1]
    free = (~held & (ROUND[:, 1] > 0))[::-1]
    other_way = find_landings(mirrored, held[::-1], free, PLATEN, share[::-1], smallest=0.3, largest=1.0)
    assert other_way.size.min() == pytest.approx(size, rel=1e-3)


def test_a_contact_of_two_nodes_keeps_its_cells():
    held = (ROUND[:, 1] == 2.0) & (ROUND[:, 0] > 3)
    free = (ROUND[:, 1] < 2.0) & (ROUND[:, 1] > 0)
    assert not len(find_landings(ROUND, held, free, PLATEN, NOTHING, smallest=0.5, largest=1.0).size)


def test_a_surface_that_stands_upright_keeps_its_cells():
    upright = ROUND[ROUND[:, 0] != 5.5] + np.where(ROUND[ROUND[:, 0] != 5.5][:, :1] == 6.0, [-1.0, 0.0], 0.0)
    held = upright[:, 1] == 2.0
    found = find_landings(upright, held, ~held & (upright[:, 1] > 0), PLATEN, NOTHING, smallest=0.5, largest=1.0)
    assert not len(found.size)


def test_a_surface_that_leaves_the_tool_keeps_its_cells():
    held = ROUND[:, 1] == 2.0
    found = find_landings(ROUND, held, np.zeros(len(ROUND), dtype=bool), PLATEN, NOTHING, smallest=0.5, largest=1.0)
    assert not len(found.size)
