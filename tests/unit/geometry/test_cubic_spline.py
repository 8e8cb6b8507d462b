# SPDX-License-Identifier: Apache-2.0
"""Cubic splines in the plane against SciPy's."""

from __future__ import annotations

import numpy as np
import pytest
import scipy

from presswork.geometry.cubic_spline import CubicSpline


@pytest.mark.parametrize("n", [2, 3, 4, 5, 40])
def test_spline_is_that_of_scipy(n):
    generator = np.random.default_rng(n)
    way, points = np.cumsum(generator.uniform(0.3, 1.0, n)), generator.normal(size=(n, 2))
    at = np.linspace(way[0], way[-1], 101)
    wanted = scipy.interpolate.CubicSpline(way, points)(at)
    assert CubicSpline(way, points)(at) == pytest.approx(wanted, abs=1e-13)


def test_a_cubic_is_met_exactly():
    way = np.array([0.0, 0.7, 1.1, 2.0, 2.4])
    at = np.linspace(0.0, 2.4, 25)
    points, wanted = (np.column_stack([t**3 - t, 2.0 - t**2]) for t in (way, at))
    assert CubicSpline(way, points)(at) == pytest.approx(wanted, abs=1e-13)
