# SPDX-License-Identifier: Apache-2.0
"""Round bodies as sectors in space: the same force and profile as in axisymmetry."""

from __future__ import annotations

import numpy as np
import pytest

from tests.problems.sectors import compare, ring, upsetting


@pytest.mark.parametrize(("angle", "around"), [(10.0, 2), (90.0, 8)])
def test_upsetting_is_that_of_axisymmetry(angle: float, around: int) -> None:
    found = compare(*upsetting(angle, (8, around, 8), {"contact": "shear", "m": 0.2}))
    np.testing.assert_allclose(found.force_ratio, 1.0, rtol=0.01)
    assert found.radius_ratio == pytest.approx(1.0, abs=0.005)
    assert found.lateral_force < 1e-9 * found.force[-1]


def test_a_ring_is_that_of_axisymmetry() -> None:
    found = compare(*ring(30.0, (8, 4, 5), {"contact": "shear", "m": 0.2}))
    np.testing.assert_allclose(found.force_ratio, 1.0, rtol=0.01)
    assert found.radius_ratio == pytest.approx(1.0, abs=0.005)
    assert found.hole_ratio == pytest.approx(1.0, abs=0.005)
