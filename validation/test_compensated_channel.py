# SPDX-License-Identifier: Apache-2.0
"""A channel of DP780 whose dies are corrected for springback."""

from __future__ import annotations

from pathlib import Path

import pytest

from presswork.study.compensate import Loop
from validation.compensated_channel import Way, compensate_channel

pytestmark = pytest.mark.validation


@pytest.fixture(scope="module")
def formed(tmp_path_factory: pytest.TempPathFactory) -> list[Loop]:
    """The loops of a crash-formed channel: 0.935 mm, then 0.081, 0.025, 0.017 and 0.019 mm."""
    return list(compensate_channel(tmp_path_factory.mktemp("formed")).loops)


def test_two_loops_leave_a_tenth_of_a_channels_deviation(formed: list[Loop]) -> None:
    assert formed[0].worst > 0.9
    assert formed[2].worst < 0.1 * formed[0].worst
    assert all(loop.gap_change < 0.01 for loop in formed)


def test_four_loops_leave_a_fiftieth_of_a_channels_deviation(formed: list[Loop]) -> None:
    assert min(loop.worst for loop in formed) < 0.02 * formed[0].worst


def test_the_implicit_procedure_corrects_a_channel_too(tmp_path: Path) -> None:
    """0.954 mm, then 0.133, 0.039, 0.026 and 0.041 mm; without inertia its wall snaps over, and the run gives up."""
    loops = compensate_channel(tmp_path, "implicit").loops
    assert loops[0].worst == pytest.approx(1.0, abs=0.06)
    assert min(loop.worst for loop in loops) < 0.03
    assert all(loop.gap_change < 0.01 for loop in loops)


@pytest.fixture(scope="module", params=["trimmed", "bent"])
def drawn(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Way, list[Loop]]:
    """The loops of a drawn channel, three corrections: with the binder as it is, and bent like the part."""
    way: Way = request.param
    return way, list(compensate_channel(tmp_path_factory.mktemp(way), way, most=3).loops)


def test_a_drawn_channel_comes_within_a_tenth_of_a_millimetre_in_three_loops(drawn: tuple[Way, list[Loop]]) -> None:
    """0.496 mm, then 0.214, 0.156 and 0.064 mm; bent 0.145, 0.058 and 0.039 mm."""
    _, loops = drawn
    assert loops[0].worst > 0.4
    assert loops[-1].worst < 0.1


def test_a_drawn_channel_keeps_the_gap_of_its_tools_where_the_part_lies(drawn: tuple[Way, list[Loop]]) -> None:
    """0.0057 mm; bent 0.0033 mm."""
    way, loops = drawn
    assert max(loop.gap_change for loop in loops) < {"trimmed": 0.02, "bent": 0.005}[way]
