# SPDX-License-Identifier: Apache-2.0
"""The gap between a die and the metal, and the part of the die that is filled."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from presswork.post import measure_die_fill
from presswork.results import Result, ResultError
from tests.unit.results.upset_output import write_upset_output


@pytest.fixture
def result(tmp_path: Path) -> Result:
    """A billet of radius 10 under a flat die that follows its upper face."""
    return Result(write_upset_output(tmp_path))


def test_a_die_wholly_in_contact_is_filled(result: Result) -> None:
    fill = measure_die_fill(result, "die", x_range=(0, 10))
    assert fill.filled == 1.0
    assert fill.unfilled_volume == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(fill.points[:, 1], 6.0)


def test_what_lies_beyond_the_rim_is_open(result: Result) -> None:
    """At the start the rim is at 10 mm: the gap grows from there, and the area is that of rings."""
    fill = measure_die_fill(result, "die", 0, x_range=(0, 13), tolerance=0.05)
    rim = fill.points[:, 0] > 10
    np.testing.assert_allclose(fill.gap[rim], fill.points[rim, 0] - 10, atol=1e-9)
    assert fill.filled == pytest.approx((10.05 / 13) ** 2, rel=0.01)
    exact = 2 * np.pi * ((13**3 - 10**3) / 3 - 10 * (13**2 - 10**2) / 2)
    assert fill.unfilled_volume == pytest.approx(exact, rel=0.02)


def test_tolerance_decides_what_counts_as_filled(result: Result) -> None:
    loose = measure_die_fill(result, "die", 0, x_range=(0, 13), tolerance=2.0)
    assert loose.filled == pytest.approx((12 / 13) ** 2, rel=0.01)


def test_unknown_tool_and_empty_range_are_errors(result: Result) -> None:
    with pytest.raises(ResultError, match="no tool punch"):
        measure_die_fill(result, "punch", x_range=(0, 10))
    with pytest.raises(ResultError, match="no part of tool die lies between x = 20 and 30 mm"):
        measure_die_fill(result, "die", x_range=(20, 30))
