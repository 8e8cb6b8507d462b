# SPDX-License-Identifier: Apache-2.0
"""The square cup of Cheng (1995) drawn by increments, and its blank found again by one step back."""

from __future__ import annotations

import numpy as np
import pytest

from validation.inverse_of_cup import DEPTHS, draw_cup, find_blank

pytestmark = pytest.mark.validation


@pytest.fixture(scope="module")
def cup(tmp_path_factory):
    return draw_cup(tmp_path_factory.mktemp("cup"))


@pytest.mark.parametrize(
    "depth",
    [
        15.0,
        pytest.param(25.0, marks=pytest.mark.xfail(strict=True, reason="2.1 mm too wide at the middle of its sides")),
    ],
)
def test_the_blank_is_the_square_within_a_millimetre(cup, depth) -> None:
    assert np.abs(find_blank(cup, depth).off_outline).max() < 1.0


def test_corners_are_found_within_a_millimetre_at_every_depth(cup) -> None:
    for depth in DEPTHS:
        inverse = find_blank(cup, depth)
        start = cup.mesh.points[:, :2]
        corner = np.argmax(start.sum(axis=1))
        assert np.abs(inverse.found.blank[corner] - start[corner]).max() < 1.0


@pytest.mark.parametrize(("depth", "rms"), [(15.0, 0.022), (20.0, 0.032), (25.0, 0.045)])
def test_thickness_strain_is_near_that_of_the_increments(cup, depth, rms) -> None:
    true, found = find_blank(cup, depth).strains
    assert np.sqrt(np.mean((found - true) ** 2)) < rms


def test_the_punch_force_is_near_that_of_the_increments(cup) -> None:
    for depth in DEPTHS:
        force = np.interp(depth, cup.history["punch.stroke"], cup.history["punch.force"])
        assert find_blank(cup, depth).found.punch_force == pytest.approx(force, rel=0.1)
