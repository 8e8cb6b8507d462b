# SPDX-License-Identifier: Apache-2.0
"""Extremes of a field in a picture."""

import numpy as np

from presswork.view.extremes import describe_extremes, find_extremes


def test_extremes_are_those_of_the_finite_values() -> None:
    values = np.array([np.nan, 3.0, -1.0, np.inf, 7.0])
    assert find_extremes(values) == (2, 4)


def test_nothing_is_said_where_no_value_is_finite() -> None:
    assert find_extremes(np.array([np.nan, np.inf])) is None
    assert describe_extremes(np.array([np.nan]), np.zeros((1, 2))) == ""


def test_the_line_names_values_and_places() -> None:
    places = np.array([[0.0, 6.0], [12.345, 0.5], [-0.0, 0.0]])
    line = describe_extremes(np.array([702.31, 1268.44, 900.0]), places)
    assert line == "max 1268 at (12.3, 0.5) mm, min 702 at (0, 6) mm"
