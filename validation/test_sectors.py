# SPDX-License-Identifier: Apache-2.0
"""Every packaged example of bulk forming in the plane or in axisymmetry as a slice or a sector in space."""

import numpy as np
import pytest

from tests.problems.examples_in_space import TRIALS, compare

pytestmark = pytest.mark.validation

FORCE = {"extrusion_curved": 0.015, "warm_extrusion": 0.015}
"""After single increments: nodes that pass an edge sharper than a cell."""


SPIKES = pytest.mark.xfail(
    strict=True, reason="1.6 and 1.8 % in single increments, which are longer since corrections are shortened better"
)


@pytest.mark.parametrize("name", [pytest.param(n, marks=SPIKES) if n in FORCE else n for n in TRIALS])
def test_force_and_profile_are_those_of_the_plane(name):
    found = compare(name)
    assert found.reached > 0.98, [course.reason for course in found.courses]
    assert np.abs(found.force).max() < FORCE.get(name, 0.01)
    assert np.abs(found.part).max() < 0.01
    assert abs(found.work) < 0.01
    assert found.profile < 0.005
    assert found.cooling < 0.005
