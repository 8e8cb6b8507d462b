# SPDX-License-Identifier: Apache-2.0
"""The size of the shells of a written stamping follows the part's radii and stays within a budget."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.onestep.outline import BlankOutline
from presswork.onestep.stamping_case import _choose_size, _round_up

BLANK = BlankOutline((np.array([[0.0, 0.0], [500.0, 0.0], [500.0, 400.0], [0.0, 400.0]]),))


def test_the_smallest_radius_has_two_shells_within_the_budget() -> None:
    assert _choose_size(BLANK, 16.0, 8000, 0.8) == (8.0, ())


def test_a_budget_makes_shells_longer_and_says_so() -> None:
    size, (note,) = _choose_size(BLANK, 5.0, 8000, 2.0)
    assert size == pytest.approx(5.0)
    assert "8000" in note
    assert "radii of 5 mm ask for 2.5 mm, or 3.2e+04 shells" in note


def test_a_budget_is_exceeded_where_tools_would_sink_into_the_shells() -> None:
    """A chord h sinks h^2/(8 R) into a radius R; runs stop at half the thickness."""
    size, (note,) = _choose_size(BLANK, 5.0, 8000, 0.8)
    assert size**2 / (8.0 * 5.0) == pytest.approx(0.7 * 0.5 * 0.8)
    assert "more than 8000" in note
    assert _choose_size(BLANK, 0.1, 8000, 0.8)[0] == pytest.approx(2.5), "four times as many at most"


def test_a_flat_part_has_shells_enough() -> None:
    assert _choose_size(BLANK, float("inf"), 8000, 0.8)[0] == pytest.approx(500.0 / 30)


@pytest.mark.parametrize(("size", "rounded"), [(2.31, 2.4), (2.4, 2.4), (11.04, 12.0), (0.0812, 0.082)])
def test_sizes_are_rounded_up(size: float, rounded: float) -> None:
    assert _round_up(size) == rounded
