# SPDX-License-Identifier: Apache-2.0
"""Ears of AA6022-T4: their number, place and order as measured; their height within what the unknown tools leave."""

import numpy as np
import pytest

from validation.earing_aa6022 import ANGLES, draw, fit_sheet, mean_quarters

pytestmark = pytest.mark.validation


def test_yld2000_fits_the_fifteen_numbers_of_the_sheet() -> None:
    stress, r = fit_sheet().worst()
    assert stress < 0.012
    assert r < 0.035


@pytest.mark.parametrize("ratio", ["1.75", "1.95"])
def test_four_ears_stand_at_0_and_90_degrees_the_latter_higher(ratio: str) -> None:
    rim, measured = draw(ratio), mean_quarters()
    assert sorted(rim.ears) == pytest.approx([0, 90, 180, 270], abs=3)
    assert rim.at(90) > rim.at(0) > rim.at(45)
    assert measured[-1] > measured[0] > measured[3]


@pytest.mark.parametrize(("ratio", "largest"), [("1.75", 0.01), ("1.95", 0.024)])
def test_the_rim_over_its_mean_is_near_the_measured_one(ratio: str, largest: float) -> None:
    heights, measured = np.array([draw(ratio).at(a) for a in ANGLES]), mean_quarters()
    assert np.abs(heights / heights.mean() - measured / measured.mean()).max() < largest
