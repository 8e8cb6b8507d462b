# SPDX-License-Identifier: Apache-2.0
"""Integration through the thickness."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.mesh.thickness_rule import thickness_rule
from presswork.model import Section


@pytest.mark.parametrize("points", [2, 3, 5, 11, 51])
@pytest.mark.parametrize(("rule", "degree"), [("gauss", lambda n: 2 * n - 1), ("lobatto", lambda n: 2 * n - 3)])
def test_rule_is_exact_up_to_its_degree(rule, degree, points) -> None:
    z, w = thickness_rule(Section(1.0, points, rule))
    assert w.sum() == pytest.approx(2.0)
    assert (np.diff(z) > 0).all()
    for k in range(0, min(degree(points), 40) + 1, 2):
        assert (w * z**k).sum() == pytest.approx(2 / (k + 1), rel=1e-9)


@pytest.mark.parametrize("points", [3, 5, 51])
def test_simpson_is_exact_for_cubics_and_has_points_on_the_faces(points) -> None:
    z, w = thickness_rule(Section(1.0, points, "simpson"))
    assert (z[0], z[-1]) == (-1.0, 1.0)
    np.testing.assert_allclose([(w * z**k).sum() for k in range(4)], [2, 0, 2 / 3, 0], atol=1e-12)


@pytest.mark.parametrize(("section", "message"), [
    (Section(1.0, 1), "2 to 51 points"), (Section(1.0, 52), "2 to 51 points"),
    (Section(1.0, 4, "simpson"), "odd number"), (Section(0.0), "thickness greater than 0"),
    (Section(-1.0), "thickness greater than 0"),
])  # fmt: skip
def test_sections_that_cannot_be_are_refused(section, message) -> None:
    with pytest.raises(ValueError, match=message):
        thickness_rule(section)
