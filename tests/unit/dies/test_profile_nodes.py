# SPDX-License-Identifier: Apache-2.0
"""Nodes along a tool's profile, and what of a profile lies beyond the axis."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.dies.profile_nodes import clip_at_axis, divide_profile
from presswork.geometry.segments import measure_distance
from presswork.mesh import MeshError

# a line of 20 mm, a round of 0.5 mm, a line of 10 mm upwards, a corner, a line of 5 mm
BENT = np.array(
    [
        [0.0, 0.0, 20.0, 0.0, 0.0, 0.0, 0.0],
        [20.0, 0.0, 20.5, 0.5, 20.0, 0.5, 1.0],
        [20.5, 0.5, 20.5, 10.5, 0.0, 0.0, 0.0],
        [20.5, 10.5, 25.5, 10.5, 0.0, 0.0, 0.0],
    ]
)


def test_edges_are_fine_on_a_small_round_and_grow_away_from_it() -> None:
    nodes = divide_profile(BENT, 1.0)
    length = np.linalg.norm(np.diff(nodes, axis=0), axis=1)
    middle = 0.5 * (nodes[1:] + nodes[:-1])
    away = np.linalg.norm(middle - [20.3, 0.2], axis=1)
    assert length[away < 0.3].max() < 0.25
    assert length[away > 6.0].max() == pytest.approx(1.0, rel=0.15)
    ratio = length[1:] / length[:-1]
    assert max(ratio.max(), (1.0 / ratio).max()) < 1.5
    assert np.abs(measure_distance(nodes, BENT).distance).max() < 1e-12
    corner = int(np.argmin(np.linalg.norm(nodes - [20.5, 10.5], axis=1)))
    assert np.allclose(nodes[corner], [20.5, 10.5])
    assert corner % 2 == 0, "a corner of the outline stands at an even place"
    assert len(nodes) % 2 == 1


def test_a_round_far_below_the_size_has_edges_of_an_eighth_of_it() -> None:
    small = BENT.copy()
    small[1] = [20.0, 0.0, 20.01, 0.01, 20.0, 0.01, 1.0]
    small[2, :2], small[2:, [0, 2]] = [20.01, 0.01], small[2:, [0, 2]] - 0.49
    length = np.linalg.norm(np.diff(divide_profile(small, 1.0), axis=0), axis=1)
    assert 0.1 < length.min() < 0.2


def test_a_curve_of_many_arcs_is_divided_as_one() -> None:
    """An arc of 90 degrees in 30 pieces has the edges of the whole."""
    angle = np.linspace(0.0, 0.5 * np.pi, 31)
    ends = 10.0 * np.column_stack([np.cos(angle), np.sin(angle)])
    pieces = np.column_stack([ends[:-1], ends[1:], np.zeros((30, 2)), np.ones(30)])
    whole = np.array([[10.0, 0.0, 0.0, 10.0, 0.0, 0.0, 1.0]])
    assert len(divide_profile(pieces, 2.0)) == len(divide_profile(whole, 2.0)) == 9


def test_a_profile_drawn_beyond_the_axis_is_cut_there() -> None:
    line = np.array([[-1.0, 2.0, 3.0, 4.0, 0.0, 0.0, 0.0], [3.0, 4.0, 9.0, 4.0, 0.0, 0.0, 0.0]])
    np.testing.assert_allclose(clip_at_axis(line)[0, :4], [0.0, 2.5, 3.0, 4.0], atol=1e-12)
    back = line[::-1][:, [2, 3, 0, 1, 4, 5, 6]]
    np.testing.assert_allclose(clip_at_axis(back)[1, :4], [3.0, 4.0, 0.0, 2.5], atol=1e-12)
    arc = np.array([[-3.0, 1.0, 5.0, 5.0, 1.0, 5.0, 1.0]])  # from beyond the axis round below the centre
    arc[0, :2] = [1.0 - 4.0 * np.cos(0.3), 5.0 - 4.0 * np.sin(0.3)]
    x, y = clip_at_axis(arc)[0, :2]
    assert x == 0.0
    assert y == pytest.approx(5.0 - np.sqrt(15.0))
    ends_there = np.array([[-3.0, 1.0, 1e-12, 2.0, 0.0, 0.0, 0.0], [1e-12, 2.0, 5.0, 2.0, 0.0, 0.0, 0.0]])
    assert len(clip_at_axis(ends_there)) == 1
    with pytest.raises(MeshError, match="beyond the axis"):
        clip_at_axis(np.array([[-3.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0]]))
