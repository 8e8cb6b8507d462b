# SPDX-License-Identifier: Apache-2.0
"""The ring's calibration curves beside Avitzur's upper bound and a published finite-element table."""

from __future__ import annotations

import numpy as np
import pytest

from validation.ring_calibration import FRICTION, avitzur_at_half, compress, read_published

pytestmark = pytest.mark.validation


def test_frictionless_ring_flows_as_volume_constancy_asks():
    """Bore ratio 1/sqrt(1 - reduction), but for the elastic part."""
    ring = compress()[0.0]
    np.testing.assert_allclose(ring.bore_mean, 1 / np.sqrt(1 - ring.height_reduction), rtol=2e-3)


@pytest.mark.parametrize("m", [0.0, 0.05, 0.1, 0.2])
def test_bore_at_50_percent_is_avitzurs_within_a_hundredth_up_to_m_of_0_2(m):
    assert compress()[m].bore_mean[-1] == pytest.approx(avitzur_at_half(m), abs=0.01)


@pytest.mark.parametrize("m", read_published())
def test_bore_at_50_percent_is_the_published_one_within_4_hundredths(m):
    assert compress()[m].bore_mean[-1] == pytest.approx(read_published()[m], abs=0.04)


def test_bore_falls_and_neutral_radius_rises_with_friction():
    rings = [compress()[m] for m in FRICTION]
    assert np.all(np.diff([ring.bore_mean[-1] for ring in rings]) < 0)
    assert np.all(np.diff([ring.neutral_radius[10] for ring in rings]) > 0)
