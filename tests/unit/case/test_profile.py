# SPDX-License-Identifier: Apache-2.0
"""Profiles of tools: fillets, arcs, signed distance, direction."""

from __future__ import annotations

import json

import numpy as np
import pytest
from pydantic import ValidationError

from presswork.case import ProfilePoint
from presswork.case.plane.tool import Tool
from presswork.case.tools.profile import ProfileError, draw_outline
from presswork.geometry.segments import measure_distance, reverse_segments

CORNER = (ProfilePoint(to=(10, -20)), ProfilePoint(to=(10, 0), radius=1.0), ProfilePoint(to=(50, 0)))
QUARTER = (ProfilePoint(to=(5, 0)), ProfilePoint(to=(0, 5), centre=(0, 0), turn="left"))


def test_fillet_is_tangent_to_both_lines() -> None:
    segments = draw_outline(CORNER, closed=False).segments
    np.testing.assert_allclose(
        segments, [[10, -20, 10, -1, 0, 0, 0], [10, -1, 11, 0, 11, -1, -1], [11, 0, 50, 0, 0, 0, 0]], atol=1e-12
    )


def test_named_vertices_coincide() -> None:
    points = [(0, 0), (7.3, 0.1), (9.1, 4.7), (3.3, 8.8), (-1.2, 5.1)]
    profile = [ProfilePoint(to=point, radius=0.31) for point in points]
    segments = draw_outline(profile, closed=True).segments
    assert len(segments) == 10
    np.testing.assert_allclose(segments[:, 2:4], np.roll(segments[:, :2], -1, axis=0), atol=1e-9)
    for segment in segments[1::2]:
        for end in (segment[:2], segment[2:4]):
            assert np.linalg.norm(end - segment[4:6]) == pytest.approx(0.31, abs=1e-9)


def test_centre_of_rounded_input_is_moved_to_equal_radii() -> None:
    profile = [ProfilePoint(to=(5, 0)), ProfilePoint(to=(3.5355, 3.5355), centre=(0, 0.001), turn="left")]
    segment = draw_outline(profile, closed=False).segments[0]
    radii = [np.linalg.norm(segment[ends] - segment[4:6]) for ends in (slice(0, 2), slice(2, 4))]
    assert radii[0] == pytest.approx(radii[1], abs=1e-12)


def test_distance_is_positive_on_the_left_of_lines_arcs_and_corners() -> None:
    segments = draw_outline(CORNER, closed=False).segments
    points = np.array([[9.0, -10.0], [20.0, 3.0], [10.0, 0.0], [12.0, -2.0], [11.0, -0.5]])
    place = measure_distance(points, segments)
    expected = [1.0, 3.0, np.sqrt(2.0) - 1.0, -2.0, -0.5]
    np.testing.assert_allclose(place.distance, expected, atol=1e-12)
    assert place.beside.all()


def test_points_past_the_end_of_an_open_profile_are_marked() -> None:
    place = measure_distance(np.array([[60.0, 1.0]]), draw_outline(CORNER, closed=False).segments)
    assert not place.beside[0]


def test_distance_to_an_arc_follows_its_turn() -> None:
    arc = draw_outline(QUARTER, closed=False).segments
    points = np.array([[1.0, 1.0], [5.0, 5.0]])
    expected = np.array([5.0 - np.sqrt(2.0), 5.0 - 5.0 * np.sqrt(2.0)])
    np.testing.assert_allclose(measure_distance(points, arc).distance, expected, atol=1e-12)
    np.testing.assert_allclose(measure_distance(points, reverse_segments(arc)).distance, -expected, atol=1e-12)


def test_outwards_is_the_gradient_of_the_distance() -> None:
    segments = draw_outline(CORNER, closed=False).segments
    points = np.array([[9.0, -10.0], [20.0, 3.0], [10.1, 0.0], [12.0, -1.5], [11.0, -0.5]])
    place = measure_distance(points, segments)
    step = 1e-6
    for axis in range(2):
        shift = np.zeros(2)
        shift[axis] = step
        ahead, behind = measure_distance(points + shift, segments), measure_distance(points - shift, segments)
        slope = (ahead.distance - behind.distance) / (2 * step)
        np.testing.assert_allclose(slope, place.outwards[:, axis], atol=1e-5)


def test_reversing_twice_gives_the_profile_back() -> None:
    segments = draw_outline(CORNER, closed=False).segments
    np.testing.assert_array_equal(reverse_segments(reverse_segments(segments)), segments)


@pytest.mark.parametrize(
    ("profile", "fragment"),
    [
        ((ProfilePoint(to=(0, 0)), ProfilePoint(to=(0, 0))), "coincides"),
        ((ProfilePoint(to=(0, 0), radius=1), ProfilePoint(to=(1, 0))), "rounds nothing"),
        ((ProfilePoint(to=(0, 0)), ProfilePoint(to=(1, 0), radius=1), ProfilePoint(to=(2, 0))), "does not turn"),
        ((ProfilePoint(to=(5, 0)), ProfilePoint(to=(0, 4), centre=(0, 0), turn="left")), "from its centre"),
    ],
)
def test_profile_that_cannot_be_drawn_is_refused(profile: tuple[ProfilePoint, ...], fragment: str) -> None:
    with pytest.raises(ProfileError, match=fragment):
        draw_outline(profile, closed=False)


@pytest.mark.parametrize("closed", [False, True])
def test_two_arcs_are_a_circle(closed: bool) -> None:
    there = ProfilePoint(to=(8, 8), centre=(5, 8), turn="left")
    back = ProfilePoint(to=(2, 8), centre=(5, 8), turn="left")
    circle = draw_outline([ProfilePoint(to=(2, 8)), there, back], closed).segments
    place = measure_distance(np.array([[5.0, 4.0], [9.0, 8.0], [5.0, 8.5]]), circle)
    np.testing.assert_allclose(np.abs(place.distance), [1.0, 1.0, 2.5])
    assert place.beside.all()
    data = {"profile": [[2, 8], there.model_dump(exclude_none=True), back.model_dump(exclude_none=True)]}
    assert Tool(**data, closed=closed, contact="frictionless").profile == (ProfilePoint(to=(2, 8)), there, back)
    assert Tool(profile=data["profile"][:2], closed=True, contact="frictionless").closed
    half = draw_outline([ProfilePoint(to=(2, 8)), there], closed=True).segments
    assert len(half) == 2


def test_a_closed_profile_of_two_lines_is_refused_with_one_that_is_taken() -> None:
    with pytest.raises(ValidationError) as caught:
        Tool(profile=[[2, 8], [8, 8]], closed=True, contact="sticking")
    context = caught.value.errors()[0]["ctx"]
    assert context["expected"] == "a closed profile of lines needs at least 3 points"
    points = json.loads(context["remedy"].removeprefix("for instance "))
    assert Tool(profile=points, closed=True, contact="sticking").closed


def test_closed_profile_joins_its_ends() -> None:
    profile = [ProfilePoint(to=point) for point in ((0, 0), (4, 0), (4, 3))]
    assert len(draw_outline(profile, closed=False).segments) == 2
    closed = draw_outline(profile, closed=True).segments
    assert len(closed) == 3
    assert measure_distance(np.array([[3.0, 1.0]]), closed).distance[0] > 0.0
    assert measure_distance(np.array([[9.0, 9.0]]), closed).beside[0]
