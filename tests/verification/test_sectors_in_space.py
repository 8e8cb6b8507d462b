# SPDX-License-Identifier: Apache-2.0
"""Round bodies as sectors in space: the same force and profile as in axisymmetry."""

from __future__ import annotations

import numpy as np
import pytest

from tests.problems.examples_in_space import compare as compare_example
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


def test_nodes_that_land_on_a_sticking_tool_do_so_as_in_axisymmetry() -> None:
    found = compare_example("upsetting_q4")
    np.testing.assert_allclose(found.force, 0.0, atol=0.01)


@pytest.mark.parametrize(
    "name",
    [
        "hot_upsetting",
        *(
            pytest.param(name, marks=pytest.mark.validation)
            for name in ("can_extrusion", "curved_die", "forging_h_section")
        ),
    ],
)
def test_an_example_of_the_plane_is_the_same_in_space(name: str) -> None:
    """The others are in validation/test_sectors.py."""
    found = compare_example(name)
    assert found.reached > 0.98, [course.reason for course in found.courses]
    np.testing.assert_allclose(found.force, 0.0, atol=0.01)
    assert found.work == pytest.approx(0.0, abs=0.003)
    assert found.profile < 0.002
    assert found.cooling < 0.003
