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
    """The loops of a crash-formed channel: 0.934 mm, then 0.086, 0.032, 0.035 and 0.042 mm."""
    return list(compensate_channel(tmp_path_factory.mktemp("formed")).loops)


def test_two_loops_leave_a_tenth_of_a_channels_deviation(formed: list[Loop]) -> None:
    assert formed[0].worst > 0.9
    assert formed[2].worst < 0.1 * formed[0].worst
    assert all(loop.gap_change < 0.01 for loop in formed)


@pytest.mark.xfail(strict=True, reason="3.4 %: from the second loop on it wanders between 0.03 and 0.06 mm")
def test_four_loops_leave_a_fiftieth_of_a_channels_deviation(formed: list[Loop]) -> None:
    assert min(loop.worst for loop in formed) < 0.02 * formed[0].worst


def test_the_implicit_procedure_corrects_a_channel_too(tmp_path: Path) -> None:
    """0.983 mm, then 0.136, 0.059, 0.027 and 0.026 mm; without inertia its wall snaps over, and the run gives up."""
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
    """0.496 mm, then 0.225, 0.169 and 0.074 mm; bent 0.153, 0.092 and 0.050 mm."""
    _, loops = drawn
    assert loops[0].worst > 0.4
    assert loops[-1].worst < 0.1


def test_a_drawn_channel_keeps_the_gap_of_its_tools_where_the_part_lies(drawn: tuple[Way, list[Loop]]) -> None:
    """0.0075 mm; bent 0.0043 mm."""
    way, loops = drawn
    assert max(loop.gap_change for loop in loops) < {"trimmed": 0.02, "bent": 0.005}[way]
