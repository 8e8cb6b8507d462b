# SPDX-License-Identifier: Apache-2.0
"""Dies corrected for springback: a bent strip against its closed form, and a channel."""

from __future__ import annotations

import csv
import shutil
from dataclasses import replace

import numpy as np
import pytest

from presswork.case import CaseError
from presswork.geometry.foot_on_triangles import split_long
from presswork.mesh.files.stl_file import pack_stl
from presswork.post.released_part import ReleasedPart
from presswork.results import OutputError
from presswork.study import compensate_springback
from presswork.study.compensated_tools import PressedTool, find_undercut
from presswork.study.compensation_goal import set_goal
from tests.problems.compensation import DIE, WANTED, arc, channel_face, fit_radius, release, write_channel

SLICE = np.array([1.0, 1.0 / 3.0, 1.0])
"""Of the tools' width, as wide as the blank."""


def test_the_die_of_a_bent_strip_has_the_radius_of_the_closed_form() -> None:
    """Part of R 50 mm, 1 mm, 300 MPa, 210 GPa: die of R 41.2101; the deviation falls to a ten-thousandth."""
    points, triangles = arc(WANTED)
    goal = set_goal(release(points, triangles), (points, triangles), (), 1.0, (True, False))
    correction, steps, worst = np.zeros_like(points), goal.begin_steps(1.0), []
    for _ in range(5):
        formed = goal.make_warp(correction).carry(points)
        misfit = goal.measure(release(formed, triangles), correction, np.zeros(3))
        worst.append(np.abs(misfit.deviation).max())
        radius = fit_radius(formed)
        correction = goal.advance(steps, correction, misfit.off)
    assert worst[0] > 1.0
    assert worst[1] < 0.1 * worst[0]
    assert worst[-1] < 3e-4 * worst[0]
    assert radius == pytest.approx(DIE, rel=1e-3)


@pytest.fixture(scope="module")
def channel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("channel")
    case = write_channel(folder)
    return case, compensate_springback(case, folder / "out", tolerance=0.01, most=1, threads=1)


@pytest.mark.validation
def test_one_loop_halves_the_deviation_of_a_channel(channel) -> None:
    _, found = channel
    first, second = found.loops
    assert first.worst > 0.2
    assert second.worst < 0.5 * first.worst
    assert second.gap_change < 0.02
    assert second.undercut.angle == 0.0


@pytest.mark.validation
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


@pytest.mark.validation
def test_a_loop_computed_anew_gives_the_same_bits(channel) -> None:
    case, found = channel
    shutil.rmtree(found.folder / "loop_01")
    again = compensate_springback(case, found.folder, tolerance=0.01, most=1, threads=1, resume=True)
    assert [loop.number for loop in again.loops] == [0, 1]
    assert (again.loops[1].misfit.deviation == found.loops[1].misfit.deviation).all()


def test_targets_that_are_not_the_part_are_refused(channel, tmp_path) -> None:
    """The middle of the sheet, in inches, as a file in millimetres; and a channel twice as deep."""
    case, found = channel
    middle = channel_face(0.0, reach=28.0)
    (tmp_path / "inch.stl").write_bytes(pack_stl("die", replace(middle, points=middle.points * SLICE / 25.4)))
    options = {"tolerance": 0.01, "most": 1, "threads": 1}
    with pytest.raises(
        CaseError, match=r"the blank 76\.11 mm: it is not this part, or in another unit; give --unit inch"
    ):
        compensate_springback(case, tmp_path / "out", target=tmp_path / "inch.stl", **options)
    assert not (tmp_path / "out").exists()
    deep = channel_face(0.0, depth=32.0, reach=28.0)
    (tmp_path / "deep.stl").write_bytes(pack_stl("die", replace(deep, points=deep.points * SLICE)))
    with pytest.raises(CaseError, match=r"of the target lie more than .* it is another part"):
        compensate_springback(case, found.folder, target=tmp_path / "deep.stl", resume=True, **options)
    with pytest.raises(CaseError, match="there is no such file"):
        compensate_springback(case, found.folder, target=tmp_path / "none.stl", resume=True, **options)


def test_the_target_in_a_file_is_met_as_the_part_as_drawn(channel, tmp_path) -> None:
    """The lower face of the channel in inches, as loop 0 measures it: the closed tools form the part 0.05 mm off it."""
    case, found = channel
    face = channel_face(-0.5, reach=28.0)
    (tmp_path / "face.stl").write_bytes(pack_stl("die", replace(face, points=face.points * SLICE / 25.4)))
    shutil.copytree(found.folder / "loop_00", tmp_path / "out" / "loop_00")
    said = compensate_springback(
        case, tmp_path / "out", tolerance=1.0, target=tmp_path / "face.stl", unit="inch", threads=1, resume=True
    )
    assert said.status == "completed"
    assert said.loops[0].worst == pytest.approx(found.loops[0].worst, abs=0.08)


def test_a_run_that_fails_ends_the_search_with_its_reason(tmp_path) -> None:
    case = write_channel(tmp_path)
    found = compensate_springback(case, tmp_path / "out", tolerance=0.1, threads=1, member_timeout=0.1)
    assert found.status != "completed"
    assert found.reason.startswith("loop 0: ")
    assert (tmp_path / "out" / "case_00.toml").is_file()
    assert not (tmp_path / "out" / "compensated.toml").exists()


def test_the_binder_stays_and_the_correction_fades_over_the_addendum() -> None:
    sheet = channel_face(0.0)
    points, triangles = split_long(sheet.points, sheet.triangles, 1.5)
    x = np.abs(points[:, 0])
    kept = triangles[(x[triangles] < 21.0).all(axis=1)]  # trimmed at the shoulder
    used, number = np.unique(kept, return_inverse=True)
    part = ReleasedPart(points[used], points[used], number.reshape(-1, 3).astype(np.int32))
    flange = channel_face(0.5)
    outer = flange.triangles[(np.abs(flange.points[flange.triangles][:, :, 0]) > 23.0).all(axis=1)]
    holder = PressedTool("holder", "holder", replace(flange, triangles=outer), np.zeros(3), np.zeros(3))
    goal = set_goal(part, (points, triangles), (holder,), 1.0, (False, False))
    assert (goal.is_fixed == (x > 23.0)).mean() > 0.95
    moved = goal.spread(np.tile([0.0, 0.0, 1.0], (int(goal.is_part.sum()), 1)))
    assert (moved[goal.is_fixed] == 0.0).all()
    assert moved[x < 13.0] == pytest.approx(np.tile([0.0, 0.0, 1.0], (int((x < 13.0).sum()), 1)))
    between = (x > 18.0) & (x < 23.0)
    assert moved[between, 2].min() > -0.1
    assert moved[between, 2].max() < 1.3
    warp = goal.make_warp(moved)
    beyond = np.array([[40.0, 0.0, 0.5], [-44.0, 3.0, -0.5]])
    assert warp.carry(beyond) == pytest.approx(beyond, abs=1e-9)


def test_walls_that_lean_over_are_reported_with_angle_and_place() -> None:
    shapes = [channel_face(-0.5, walls=angle) for angle in (85.0, 95.0)]
    drawn, bent = (PressedTool("die", "die", shape, np.zeros(3), np.zeros(3)) for shape in shapes)
    sheet = drawn.shape.points
    found = find_undercut([bent], [drawn], sheet, 5.0)
    assert found.tool == "die"
    assert found.angle == pytest.approx(5.0, abs=1e-6)
    assert abs(found.place[0]) == pytest.approx(15.0, abs=2.0)
    assert find_undercut([drawn], [drawn], sheet, 5.0).angle == 0.0
    assert find_undercut([bent], [drawn], sheet + np.array([0.0, 0.0, 40.0]), 5.0).angle == 0.0  # no sheet touches it
    quarter = sheet[(sheet[:, :2] >= 0.0).all(axis=1)]
    assert find_undercut([bent], [drawn], quarter, 5.0, (True, True)).angle == pytest.approx(5.0, abs=1e-6)
