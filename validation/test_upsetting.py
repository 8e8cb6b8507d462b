# SPDX-License-Identifier: Apache-2.0
"""Upsetting to 60 %: all elements that do not lock agree, converge to one curve, and keep the volume."""

from __future__ import annotations

import numpy as np
import pytest

from validation.upsetting import ELEMENTS, REFINED, upset

pytestmark = pytest.mark.validation


def spread(elements, blocks):
    """Largest over smallest force, less one, at the worst of 10, 20 ... 60 %."""
    forces = np.array([upset(element, blocks).forces() for element in elements])
    return (forces.max(axis=0) / forces.min(axis=0) - 1).max()


def test_forces_of_all_elements_agree_within_3_percent_on_30_blocks():
    assert spread(ELEMENTS, 30) < 0.03


@pytest.mark.xfail(strict=True, reason="the corner folds a node at a time: on 15 blocks the forces step by 3 to 6 %")
def test_forces_of_all_elements_agree_within_3_percent_on_15_blocks():
    assert spread(ELEMENTS, 15) < 0.03


def test_forces_converge_to_one_curve_under_refinement():
    """The spread between elements falls with the cell size, and so does each element's change."""
    spreads = [spread(REFINED, blocks) for blocks in (15, 30, 60)]
    assert spreads[0] > spreads[1] > spreads[2]
    assert spreads[2] < 0.01
    for element in REFINED:
        coarse, middle, fine = (upset(element, blocks).forces() for blocks in (15, 30, 60))
        assert np.abs(fine / middle - 1).max() < np.abs(middle / coarse - 1).max()


@pytest.mark.parametrize("element", ELEMENTS)
def test_volume_of_the_upset_billet_changes_by_less_than_half_a_percent_beyond_the_elastic_part(element):
    run = upset(element, 15)
    assert abs(run.volume_change - run.elastic_volume_change) < 0.5


@pytest.mark.parametrize("element", ELEMENTS)
def test_external_work_is_stored_or_dissipated(element):
    """Trapezoidal sums over increments of up to 2 % of the stroke: what is missing is below 1 %."""
    assert abs(upset(element, 30).energy_error) < 1.0
