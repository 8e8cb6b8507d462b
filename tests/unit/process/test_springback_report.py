# SPDX-License-Identifier: Apache-2.0
"""What is measured of released parts, on shapes drawn with known angles, curl and twist."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from presswork.geometry.sprung.bend_angle import measure_bends
from presswork.geometry.sprung.part_section import cut_part, find_below
from presswork.geometry.sprung.sprung_shape import measure_turn
from presswork.model import Gauge, PartSection, Springback
from presswork.process.line.springback_report import ReleasedShape, report_shape
from tests.problems.sprung_parts import BOTTOM, FLANGE, WALL, Rail, make_rail

SEEDS = [1, 2, 3]


def report(rail: Rail, **asked: Any) -> tuple[dict[str, Any], list[str]]:
    return report_shape(ReleasedShape(rail.formed, rail.free, [rail.cells], (False, False)), Springback(**asked))


@pytest.mark.parametrize("seed", SEEDS)
def test_an_opened_and_curled_hat_has_its_angles_and_radius(seed: int) -> None:
    rng = np.random.default_rng(seed)
    opening, closing = np.radians(rng.uniform(2, 15, 2))
    radius = float(rng.uniform(150, 600))
    told, warnings = report(make_rail(opening, closing, radius, 0.0, seed=seed),
                            sections=(PartSection("A", (150.0, 0.0), 0.5 * np.pi),))  # fmt: skip
    assert warnings == []
    right, left = told["sections"]["A"]["walls"][1], told["sections"]["A"]["walls"][0]
    sixth = np.degrees(WALL / radius) / 6  # half of the third over which an angle is measured
    assert right["before_degrees"][0] == pytest.approx(90.0, abs=1e-6)
    assert right["before_degrees"][1] == pytest.approx(90.0 + np.degrees(opening) - sixth, abs=0.01)
    assert right["after_degrees"][1] == pytest.approx(90.0 - np.degrees(closing) + sixth, abs=0.01)
    assert right["curl_radius_mm"] == pytest.approx(radius, rel=0.01)
    for one, other in (("before_degrees", "after_degrees"), ("after_degrees", "before_degrees")):
        np.testing.assert_allclose(left[one], right[other], atol=1e-3)  # the section begins at the other flange


@pytest.mark.parametrize("half", [False, True])
@pytest.mark.parametrize(("formed", "free"), [(90.0, 94.0), (60.0, 58.5), (135.0, 141.0)])
def test_a_bend_has_the_angle_that_its_legs_enclose(formed: float, free: float, half: bool) -> None:
    """A V of legs of 30 mm round 4 mm, its line bent on; half of it ends at the symmetry plane."""
    shapes = []
    for angle in np.radians([formed, free]):
        outer = 0.5 * (np.pi - angle)
        turn = np.linspace(0.0, outer, 7)
        arc = 4.0 * np.stack([np.sin(turn), 1.0 - np.cos(turn)], axis=1)
        leg = arc[-1] + np.linspace(0.0, 30.0, 16)[1:, None] * [np.cos(outer), np.sin(outer)]
        right = np.concatenate([arc, leg])
        line = right if half else np.concatenate([(right * (-1.0, 1.0))[:0:-1], right])
        shapes.append(np.concatenate([np.insert(line, 1, y, axis=1) for y in (0.0, 5.0, 10.0)]))
    n = len(shapes[0]) // 3
    i = (np.arange(2)[:, None] * n + np.arange(n - 1)).ravel()
    part = ReleasedShape(*shapes, [np.stack([i, i + 1, i + n + 1, i + n], axis=1)], (half, False))
    told, _ = report_shape(part, Springback(sections=(PartSection("A", (0.0, 3.0), 0.0),)))
    (bend,) = told["sections"]["A"]["bends"]
    np.testing.assert_allclose(bend["at_mm"], [0.0, 3.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(bend["included_degrees"], [formed, free], atol=0.01)


def test_a_hat_has_four_bends_and_a_curved_bottom_none() -> None:
    told, _ = report(make_rail(0.1, 0.05, np.inf, 0.0), sections=(PartSection("A", (150.0, 0.0), 0.5 * np.pi),))
    bends = np.array([each["included_degrees"] for each in told["sections"]["A"]["bends"]])
    np.testing.assert_allclose(bends[:, 0], 90.0, atol=1e-6)
    np.testing.assert_allclose(bends[:, 1], 90.0 + np.degrees([-0.05, 0.1, 0.1, -0.05]), atol=1e-3)
    angle = np.linspace(-0.2, 0.2, 41)
    line = np.stack([200.0 * np.sin(angle), 200.0 * np.cos(angle)], axis=1)
    assert measure_bends(line, line) == ()


@pytest.mark.parametrize("seed", SEEDS)
def test_a_twisted_rail_has_its_twist_and_its_sections_turn(seed: int) -> None:
    twist = float(np.radians(np.random.default_rng(seed).uniform(-8, 8)))
    rail = make_rail(0.0, 0.0, np.inf, twist, length=400.0, seed=seed)
    at = {name: PartSection(name, (x, 0.0), 0.5 * np.pi) for name, x in (("near", 20.0), ("far", 380.0))}
    told, _ = report(rail, sections=tuple(at.values()))
    share = told["twist"]["length_mm"] / 400.0
    assert 0.85 < share < 0.95
    assert told["twist"]["degrees"] == pytest.approx(np.degrees(twist) * share, rel=2e-3)
    np.testing.assert_allclose(told["twist"]["axis"], [1.0, 0.0, 0.0], atol=1e-9)
    turned = [told["sections"][name]["turn_degrees"] for name in at]
    assert turned[1] - turned[0] == pytest.approx(np.degrees(twist) * 0.9, rel=0.02)


def test_a_part_that_is_as_wide_as_long_has_no_twist() -> None:
    width = BOTTOM + 2 * FLANGE
    assert "twist" not in report(make_rail(0.1, 0.0, np.inf, 0.0, length=width))[0]


@pytest.mark.parametrize("seed", SEEDS)
def test_a_rigid_motion_is_no_springback(seed: int) -> None:
    rail = make_rail(0.0, 0.0, np.inf, 0.0, seed=seed)
    told, _ = report(rail, tolerance=(-0.01, 0.01))
    assert told["twist"]["degrees"] == pytest.approx(0.0, abs=1e-6)
    assert told["tolerance"]["share_within"] == 1.0
    assert abs(told["tolerance"]["worst_mm"]) < 1e-8
    assert all(abs(each["turn_degrees"]) < 1e-6 for each in told["sections"].values())


@pytest.mark.parametrize("seed", SEEDS)
def test_a_part_clamped_by_its_bottom_shows_its_flanges(seed: int) -> None:
    """Flanges of walls that open by a small angle a rise by 50 sin a outwards of 50 mm walls, as trace has it."""
    opening = float(np.radians(np.random.default_rng(seed).uniform(1, 4)))
    rail = make_rail(opening, 0.0, np.inf, 0.0, seed=seed)
    edge = 0.5 * BOTTOM + 0.5 * FLANGE
    gauge = Gauge(((20.0, -10.0), (280.0, -10.0), (150.0, 15.0)), (("middle", (100.0, 2.0)), ("edge", (150.0, edge))))
    told, warnings = report(rail, gauge=gauge, tolerance=(-0.5, 0.5))
    assert warnings == []
    np.testing.assert_allclose(told["gauge"]["clamps_mm"], 0.0, atol=1e-9)
    middle, point = told["gauge"]["points"]["middle"], told["gauge"]["points"]["edge"]
    assert middle == {"deviation_mm": pytest.approx(0.0, abs=1e-9), "within": True}
    rise = WALL * (1.0 - np.cos(opening)) + 0.5 * FLANGE * np.sin(opening)
    assert abs(point["deviation_mm"]) == pytest.approx(rise, rel=1e-3)
    assert point["within"] is bool(rise <= 0.5)
    share = told["tolerance"]["share_within"]
    assert 0.1 < share < 1.0
    assert abs(told["tolerance"]["worst_mm"]) > abs(point["deviation_mm"])


def test_more_than_three_clamps_of_a_twisted_part_share_what_is_left() -> None:
    """A bottom whose corners rise by +w, -w, +w, -w is left so by the least squares."""
    rail = make_rail(0.0, 0.0, np.inf, 0.02, length=300.0)
    corners = tuple((x, y) for x in (30.0, 270.0) for y in (-15.0, 15.0))
    told, _ = report(rail, gauge=Gauge(corners))
    off = told["gauge"]["clamps_mm"]
    assert np.sign(off).tolist() in ([1, -1, -1, 1], [-1, 1, 1, -1])
    np.testing.assert_allclose(np.abs(off), 0.02 * 240 / 300 * 15 / 2, rtol=0.02)


def test_places_off_the_part_are_told() -> None:
    rail = make_rail(0.0, 0.0, np.inf, 0.0)
    gauge = Gauge(((20.0, 0.0), (900.0, 0.0), (150.0, 15.0)), (("P", (0.0, 900.0)),))
    _, warnings = report(rail, gauge=gauge, sections=(PartSection("A", (900.0, 0.0), 0.5 * np.pi),))
    assert [w.split(":")[0] for w in warnings] == [
        "springback.gauge", "springback.gauge", "springback.gauge", "springback.sections.A misses the part"
    ]  # fmt: skip
    assert "clamp 2 lies off the part" in warnings[0]


def test_a_section_by_two_points_is_that_by_point_and_angle_cut_short() -> None:
    rail = make_rail(0.0, 0.0, np.inf, 0.0)
    start, angle = (100.0, -5.0), float(np.radians(60.0))
    (whole,) = cut_part(rail.formed, rail.cells, start, angle)
    (part,) = cut_part(rail.formed, rail.cells, start, angle, 12.0)
    out = np.array([np.cos(angle), np.sin(angle), 0.0])
    way = [(each.take(rail.formed) - (*start, 0.0)) @ out for each in (whole, part)]
    assert (np.diff(way[0]) >= -1e-9).all()
    assert 0.0 <= way[1].min() < way[1].max() <= 12.0
    np.testing.assert_allclose(way[1], way[0][(way[0] >= 0.0) & (way[0] <= 12.0)])


def test_a_turned_section_turns() -> None:
    line = np.random.default_rng(1).normal(size=(20, 2))
    c, s = np.cos(0.3), np.sin(0.3)
    assert measure_turn(line, line @ np.array([[c, s], [-s, c]]) + 5.0) == pytest.approx(0.3)


def test_the_uppermost_place_is_found() -> None:
    points = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 2], [4, 0, 2], [0, 4, 6.0]])
    triangles = np.array([[0, 1, 2], [3, 4, 5]], dtype=np.int32)
    found = find_below(points, triangles, 1.0, 1.0)
    assert found is not None
    np.testing.assert_allclose(found.take(points), [[1.0, 1.0, 3.0]])
    assert find_below(points, triangles, 5.0, 5.0) is None
