# SPDX-License-Identifier: Apache-2.0
"""How wide ridges and slots of tools are."""

import numpy as np
import pytest

from presswork.geometry.tool_widths import MOST_PLACES, find_widths, spread_places
from presswork.model import Triangulation


def sweep(outline, length=10.0, parts=1):
    """A surface over a line of x and z, its free side to the left of the line as seen from -y."""
    outline = np.asarray(outline, dtype=float)
    y = np.linspace(0.0, length, parts + 1)
    points = np.array([(x, at, z) for at in y for x, z in outline])
    n = len(outline)
    first = (np.arange(parts)[:, None] * n + np.arange(n - 1)).ravel()
    a, b, c, d = first, first + 1, first + n + 1, first + n
    return Triangulation(
        points, np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])]).astype(np.int32), False
    )


def with_ridge(width, top=None):
    """A tool that looks upwards with a ridge 3 mm high; width: at its foot, top: at its crest."""
    top = width if top is None else top
    foot, crest = 0.5 * width, 0.5 * top
    return sweep([(-9, 0), (-foot, 0), (-crest, 3), (crest, 3), (foot, 0), (9, 0)])


@pytest.mark.parametrize("width", [0.5, 1.2])
def test_the_width_of_a_ridge_is_that_between_its_walls(width):
    found = find_widths(with_ridge(width), 3.0, 0.25)
    assert found.is_ridge.all()
    np.testing.assert_allclose(found.width, width, rtol=0.02)
    assert (np.abs(np.abs(found.place[:, 0]) - 0.5 * width) < 1e-9).all()
    assert np.ptp(found.place[:, 2]) > 2.0


def test_a_slot_is_free_space_between_walls():
    ridge = with_ridge(1.2)
    slot = Triangulation(ridge.points, np.ascontiguousarray(ridge.triangles[:, ::-1]), False)
    found = find_widths(slot, 3.0, 0.25)
    assert not found.is_ridge.any()
    np.testing.assert_allclose(found.width, 1.2, rtol=0.02)


def test_drafted_walls_tell_where_the_ridge_is_narrow():
    found = find_widths(with_ridge(1.6, 0.8), 3.0, 0.1)  # 7.6 degrees
    expected = 1.6 - 0.8 * found.place[:, 2] / 3.0
    np.testing.assert_allclose(found.width, expected, rtol=0.04)


def test_edges_and_fillets_have_no_width():
    step = sweep([(-9, 0), (0, 0), (0, -4), (9, -4)])
    assert not len(find_widths(step, 3.0, 0.25).width)
    turn = np.linspace(0.0, 0.5 * np.pi, 9)
    fillet = sweep([(-9, 0), *zip(np.sin(turn) - 1.0, 1.0 - np.cos(turn), strict=True), (0.0, 9.0)])
    assert not len(find_widths(fillet, 3.0, 0.25).width)


def test_wide_ridges_do_not_count():
    assert not len(find_widths(with_ridge(2.0), 1.9, 0.25).width)


def test_the_widths_do_not_depend_on_the_facets():
    coarse = find_widths(with_ridge(0.7), 3.0, 0.25)
    shape = with_ridge(0.7)
    fine = find_widths(sweep(shape.points[:6, [0, 2]], parts=80), 3.0, 0.25)
    assert np.median(fine.width) == pytest.approx(np.median(coarse.width), rel=0.01)
    assert len(spread_places(sweep(shape.points[:6, [0, 2]], parts=500), 0.25)[0]) < 10_000


def test_a_large_tool_has_no_more_places_than_it_may():
    large = sweep([(-500, 0), (500, 0)], length=1000.0)
    assert len(spread_places(large, 0.1)[0]) <= MOST_PLACES + 2
