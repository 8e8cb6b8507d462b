# SPDX-License-Identifier: Apache-2.0
"""Hertz: pressure, half-width and peak of an elastic cylinder and an elastic sphere on a rigid plane."""

import numpy as np
import pytest

from tests.problems.hertz import RADIUS, press

EDGES = {"tri3": 16, "quad4": 16, "quad4_fbar": 16, "quad8_2x2": 8}
"""Edges across the half-width; a quadratic edge counts for two in the number of nodes."""


@pytest.mark.parametrize("element", EDGES)
@pytest.mark.parametrize("analysis", ["plane_strain", "axisymmetric"], ids=["cylinder", "sphere"])
def test_pressure_and_half_width_are_those_of_hertz(analysis, element) -> None:
    contact = press(analysis, element, edges=EDGES[element])
    assert contact.nodes_across >= 15
    assert contact.pressure.max() == pytest.approx(contact.exact_peak, rel=0.02)
    assert contact.peak == pytest.approx(contact.exact_peak, rel=0.02)
    assert contact.half_width == pytest.approx(contact.exact_half_width, rel=0.02)
    x = contact.place * RADIUS / contact.exact_half_width
    inside = x < 0.85
    exact = contact.exact_peak * np.sqrt(1 - x[inside] ** 2)
    np.testing.assert_allclose(contact.pressure[inside], exact, rtol=0, atol=0.03 * contact.exact_peak)


def test_what_hertz_leaves_out_grows_with_the_width_of_the_contact() -> None:
    """His paraboloid and half-space are first terms in a/R: ten times the width, more than three times the error."""
    errors = [
        abs(contact.half_width / contact.exact_half_width - 1)
        for contact in (press("plane_strain", "quad4_fbar", half_width=a * RADIUS) for a in (0.01, 0.1))
    ]
    assert errors[0] < 0.01
    assert errors[1] > 3 * errors[0]
