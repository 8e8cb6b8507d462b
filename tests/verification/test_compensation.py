# SPDX-License-Identifier: Apache-2.0
"""Dies corrected for springback: a bent strip against its closed form, and a channel."""

from __future__ import annotations

import csv

import numpy as np
import pytest

from presswork.case import CaseError
from presswork.results import OutputError
from presswork.study import compensate_springback
from presswork.study.anderson import Anderson
from presswork.study.compensation_goal import set_goal
from tests.problems.compensation import DIE, WANTED, arc, fit_radius, release, write_channel


def test_the_die_of_a_bent_strip_has_the_radius_of_the_closed_form() -> None:
    """Part of R 50 mm, 1 mm, 300 MPa, 210 GPa: die of R 41.2101; the deviation falls to a ten-thousandth."""
    points, triangles = arc(WANTED)
    goal = set_goal(release(points, triangles), (points, triangles), (), 1.0, (True, False))
    correction, anderson, worst = np.zeros_like(points), Anderson(goal.weight), []
    for _ in range(5):
        formed = goal.make_warp(correction).carry(points)
        misfit = goal.measure(release(formed, triangles), correction, np.zeros(3))
        worst.append(np.abs(misfit.deviation).max())
        radius = fit_radius(formed)
        correction = goal.spread(anderson.step(correction, misfit.off))
    assert worst[0] > 1.0
    assert worst[1] < 0.1 * worst[0]
    assert worst[-1] < 3e-4 * worst[0]
    assert radius == pytest.approx(DIE, rel=1e-3)


@pytest.fixture(scope="module")
def channel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("channel")
    case = write_channel(folder)
    return case, compensate_springback(case, folder / "out", tolerance=0.01, most=1, threads=1)


def test_one_loop_halves_the_deviation_of_a_channel(channel) -> None:
    _, found = channel
    first, second = found.loops
    assert first.worst > 0.2
    assert second.worst < 0.5 * first.worst
    assert second.gap_change < 0.02
    assert second.undercut.angle == 0.0


def test_a_search_that_goes_on_gives_the_same_bits(channel) -> None:
    case, found = channel
    before = (found.folder / "table.csv").read_bytes()
    again = compensate_springback(case, found.folder, tolerance=0.01, most=1, threads=1, resume=True)
    assert again.status == found.status
    assert (found.folder / "table.csv").read_bytes() == before
    rows = list(csv.DictReader(before.decode().splitlines()))
    assert [row["loop"] for row in rows] == ["0", "1"]
    assert (found.folder / "deviation.png").stat().st_size > 10_000
    with pytest.raises(OutputError, match="already holds a search"):
        compensate_springback(case, found.folder, tolerance=0.01, most=1, threads=1)


def test_a_case_without_springback_is_refused(tmp_path) -> None:
    case = write_channel(tmp_path)
    text = case.read_text().replace("[springback]", "")
    case.write_text(text)
    with pytest.raises(CaseError, match=r"no springback to correct for; add an empty table \[springback\]"):
        compensate_springback(case, tmp_path / "out", tolerance=0.1)
