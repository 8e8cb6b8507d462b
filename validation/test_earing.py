# SPDX-License-Identifier: Apache-2.0
"""Ears of a cylindrical cup: their number, their place, which is the higher, and none without anisotropy."""

from __future__ import annotations

import numpy as np
import pytest
from earing import BLANK, HILL, PUNCH, THICKNESS, draw_cup, height_by_constant_area, height_by_hoop_compression, hill_r

pytestmark = pytest.mark.validation
PLACES = {"aluminium": [0, 90, 180, 270], "steel": [0, 90, 180, 270], "turned": [45, 135, 225, 315]}
"""Where the sheet is pressed along the hoop across the direction of the largest r (Hill 1950, XII.6)."""


def test_the_mesh_makes_no_ears() -> None:
    """An isotropic cup is even within 0.1 % of its height, and as thick at its rim as hoop compression makes it."""
    rim = draw_cup("isotropic")
    assert rim.amplitude < 1e-3
    assert height_by_hoop_compression(1.0) < rim.height.mean() < height_by_constant_area()
    assert rim.volume == pytest.approx(1.0, abs=2e-3)


@pytest.mark.parametrize("sheet", PLACES)
def test_ears_stand_where_the_hoop_lies_across_the_largest_r(sheet: str) -> None:
    rim = draw_cup(sheet)
    np.testing.assert_allclose(rim.ears, PLACES[sheet], atol=3.0)
    assert rim.amplitude > 0.05
    assert rim.volume == pytest.approx(1.0, abs=2e-3)
    assert height_by_hoop_compression(max(HILL[sheet])) < rim.height.mean() < height_by_constant_area()


@pytest.mark.parametrize("sheet", ["aluminium", "steel"])
def test_the_ear_along_the_rolling_direction_is_the_higher_as_r90_is_larger_than_r00(sheet: str) -> None:
    rim = draw_cup(sheet)
    assert rim.at(0) > rim.at(90) + 0.2
    theory = height_by_hoop_compression(hill_r(np.array([90.0, 45.0, 0.0]), *HILL[sheet]))
    assert theory[0] > theory[2] > theory[1]


@pytest.mark.parametrize("sheet", ["isotropic", "aluminium", "steel"])
def test_the_rim_thickens_as_a_free_edge_under_hoop_compression(sheet: str) -> None:
    """ln(R0/R)/(1 + r) between the ears, 8 % less in the middle of the outermost shells, 2 mm of the blank's 54."""
    r = 1.0 if sheet == "isotropic" else HILL[sheet][1]
    rim = draw_cup(sheet)
    exact = np.log(BLANK / (PUNCH + THICKNESS)) / (1 + r)
    middle = rim.thickness_strain[len(rim.thickness_strain) // 2]
    assert 0.92 * exact < middle < exact
