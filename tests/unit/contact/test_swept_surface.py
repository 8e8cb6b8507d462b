# SPDX-License-Identifier: Apache-2.0
"""Plan times profile against closed forms of the distance."""

import numpy as np
import pytest

from presswork import _core
from tests.unit.contact.shapes import FloatArray, box_distance, clockwise, counter_clockwise, line

INF = float("inf")


def swept(
    half: tuple[float, float], corner: float, segments: list[list[float]], depth: float = INF
) -> _core.ToolSurface:
    return _core.ToolSurface.swept(half, corner, np.array(segments), depth=depth)


def scatter(n: int, size: float, seed: int = 1) -> FloatArray:
    return np.random.default_rng(seed).uniform(-size, size, (n, 3))


def sphere(radius: float) -> _core.ToolSurface:
    return swept((radius, radius), radius, [clockwise((-radius, radius), (-radius, -radius), (-radius, 0.0))])


def punch(half: tuple[float, float] = (25.5, 20.0), corner: float = 10.0, edge: float = 4.0) -> _core.ToolSurface:
    wall = [line((0.0, 40.0), (0.0, edge)), clockwise((0.0, edge), (-edge, 0.0), (-edge, edge))]
    return swept(half, corner, [*wall, line((-edge, 0.0), (-min(half), 0.0))])


def die(half: tuple[float, float] = (27.0, 27.0), corner: float = 11.5, shoulder: float = 4.0) -> _core.ToolSurface:
    wall = [line((0.0, -40.0), (0.0, -shoulder)), clockwise((0.0, -shoulder), (shoulder, 0.0), (shoulder, -shoulder))]
    return swept(half, corner, [*wall, line((shoulder, 0.0), (60.0, 0.0))])


def test_sphere_has_its_closed_form() -> None:
    x = scatter(500, 20.0)
    r = np.linalg.norm(x, axis=1)
    gap, normal, place, _ = sphere(7.0).nearest(x)
    np.testing.assert_allclose(gap, r - 7.0, atol=1e-12)
    np.testing.assert_allclose(normal, x / r[:, None], atol=1e-12)
    np.testing.assert_allclose(place, 7.0 * x / r[:, None], atol=1e-12)
    slope = (np.eye(3) - np.einsum("ni,nj->nij", normal, normal)) / r[:, None, None]
    np.testing.assert_allclose(sphere(7.0).slopes(x)[1], slope, atol=1e-12)


def test_torus_has_its_closed_form() -> None:
    ring = swept((10.0, 10.0), 10.0, [clockwise((0, 3), (0, -3), (0, 0)), clockwise((0, -3), (0, 3), (0, 0))])
    x = scatter(500, 18.0)
    r = np.hypot(x[:, 0], x[:, 1])
    off = np.hypot(r - 10.0, x[:, 2])
    gap, normal, _, _ = ring.nearest(x)
    np.testing.assert_allclose(gap, off - 3.0, atol=1e-12)
    out = x[:, :2] / r[:, None] * ((r - 10.0) / off)[:, None]
    np.testing.assert_allclose(normal, np.column_stack([out, x[:, 2] / off]), atol=1e-12)


def test_box_with_rounded_edges_has_its_closed_form() -> None:
    half, radius = (20.0, 15.0, 10.0), 3.0
    segments = [
        line((-15.0, 10.0), (-3.0, 10.0)),
        clockwise((-3.0, 10.0), (0.0, 7.0), (-3.0, 7.0)),
        line((0.0, 7.0), (0.0, -7.0)),
        clockwise((0.0, -7.0), (-3.0, -10.0), (-3.0, -7.0)),
        line((-3.0, -10.0), (-15.0, -10.0)),
    ]
    x = scatter(3000, 26.0)
    gap = swept(half[:2], radius, segments).nearest(x)[0]
    np.testing.assert_allclose(gap, box_distance(x, half, radius), atol=1e-12)
    assert (gap < 0.0).sum() > 300


def test_box_with_sharp_rims_has_its_closed_form() -> None:
    segments = [line((-15.0, 10.0), (0.0, 10.0)), line((0.0, 10.0), (0.0, -10.0)), line((0.0, -10.0), (-15.0, -10.0))]
    x = scatter(3000, 26.0)
    gap, normal, place, _ = swept((20.0, 15.0), 0.0, segments).nearest(x)
    np.testing.assert_allclose(gap, box_distance(x, (20.0, 15.0, 10.0)), atol=1e-12)
    np.testing.assert_allclose(x - gap[:, None] * normal, place, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1.0, atol=1e-12)


def test_cavity_is_the_box_inside_out() -> None:
    """Metal behind an inner corner is nearest to the corner, with a negative gap."""
    segments = [line((-15.0, -10.0), (0.0, -10.0)), line((0.0, -10.0), (0.0, 10.0)), line((0.0, 10.0), (-15.0, 10.0))]
    x = scatter(3000, 26.0)
    gap = swept((20.0, 15.0), 0.0, segments).nearest(x)[0]
    np.testing.assert_allclose(gap, -box_distance(x, (20.0, 15.0, 10.0)), atol=1e-12)


@pytest.mark.parametrize("along", [0, 1])
def test_strip_is_the_same_all_along(along: int) -> None:
    half = (30.0, INF) if along else (INF, 30.0)
    shoulder = die(half, 0.0, 5.0)
    x = scatter(300, 30.0) + np.array([25.0, 0.0, 0.0])
    x[:, along], x[:, 1 - along] = x[:, 1].copy(), x[:, 0].copy()
    gap, normal, _, _ = shoulder.nearest(x)
    moved = x.copy()
    moved[:, along] += 1e3
    np.testing.assert_array_equal(shoulder.nearest(moved)[0], gap)
    assert (normal[:, along] == 0.0).all()
    across = np.abs(x[:, 1 - along])
    on_arc = (across > 30.0) & (across < 35.0) & (x[:, 2] > -5.0)
    r = np.hypot(across - 35.0, x[:, 2] + 5.0)
    on_arc &= (r - 5.0 > -5.0) & on_arc
    np.testing.assert_allclose(gap[on_arc], (r - 5.0)[on_arc], atol=1e-12)


@pytest.mark.parametrize("tool", [punch(), die(), die((30.0, INF), 0.0, 5.0), sphere(25.0)])
def test_normal_slope_is_the_derivative_of_the_normal(tool: _core.ToolSurface) -> None:
    x = scatter(4000, 45.0)
    gap = tool.nearest(x)[0]
    x = x[np.abs(gap) < 4.0]
    h = 1e-5
    steps = [(tool.nearest(x + h * e)[1], tool.nearest(x - h * e)[1]) for e in np.eye(3)]
    finite = np.stack([(after - before) / (2.0 * h) for after, before in steps], axis=-1)
    slope = tool.slopes(x)[1]
    # where the step crosses a line at which the curvature jumps the difference means nothing
    jumps = [np.abs(tool.slopes(x + h * s * e)[1] - slope).max(axis=(1, 2)) for e in np.eye(3) for s in (-1, 1)]
    smooth = np.max(jumps, axis=0) < 1e-3
    assert smooth.sum() > 0.98 * len(x) > 100
    np.testing.assert_allclose(slope[smooth], finite[smooth], atol=1e-7)


def test_normal_is_the_gradient_of_the_gap() -> None:
    x = scatter(2000, 45.0)
    tool, h = punch(), 1e-6
    gap, normal, _, _ = tool.nearest(x)
    x, normal = x[np.abs(gap) < 8.0], normal[np.abs(gap) < 8.0]
    finite = np.stack(
        [(tool.nearest(x + h * e)[0] - tool.nearest(x - h * e)[0]) / (2.0 * h) for e in np.eye(3)], axis=1
    )
    assert len(x) > 200
    np.testing.assert_allclose(normal, finite, atol=1e-7)


def test_beyond_an_open_end_there_is_no_tool() -> None:
    holder = swept((30.0, 30.0), 10.0, [line((0.0, 0.0), (20.0, 0.0))])
    gap = holder.nearest(np.array([[49.0, 0, 1.0], [51.0, 0, 1.0], [29.0, 0, -0.5], [31.0, 0, -0.5], [50.0, 0, 2.0]]))[
        0
    ]
    np.testing.assert_allclose(gap, [1.0, INF, INF, -0.5, 2.0])


def test_reach_and_depth_bound_what_is_found() -> None:
    tool = swept((30.0, 30.0), 10.0, [line((0.0, 0.0), (20.0, 0.0))], depth=2.0)
    x = np.array([[40.0, 0.0, z] for z in (5.0, 2.9, 0.0, -1.9, -2.1, -9.0)])
    np.testing.assert_allclose(tool.nearest(x, 3.0)[0], [INF, 2.9, 0.0, -1.9, INF, INF], atol=1e-12)
    bound = tool.distance_bound(x, 3.0)
    np.testing.assert_allclose(bound[1:5], [2.9, 0.0, -1.9, 0.1], atol=1e-12)
    assert 3.0 <= bound[0] <= 5.0
    assert 3.0 <= bound[5] <= 9.0


def test_distance_bound_never_exceeds_the_distance() -> None:
    x = scatter(3000, 80.0)
    for tool in (punch(), die()):
        exact = np.abs(tool.nearest(x)[0])
        assert (tool.distance_bound(x, 1.0) <= exact + 1e-12).all()


@pytest.mark.parametrize(
    ("half", "corner", "segments", "fault"),
    [
        ((-1.0, 5.0), 0.0, [line((0, 0), (1, 0))], "half widths"),
        ((INF, INF), 0.0, [line((0, 0), (1, 0))], "only one half width"),
        ((5.0, 5.0), 6.0, [line((0, 0), (1, 0))], "corner radius"),
        ((20.0, 20.0), 3.0, [clockwise((0, 4), (-4, 0), (-4, 4))], "more than its corner radius"),
        ((20.0, 20.0), 3.0, [line((-1, 0), (-5, 0))], "short of the middle"),
        ((20.0, 20.0), 3.0, [line((-1, 0), (-21, 0))], "past the middle"),
        ((20.0, 20.0), 3.0, [line((1, 0), (1, 0))], "no length"),
        ((20.0, 20.0), 3.0, [line((1, 0), (2, 0)), line((2.1, 0), (3, 0))], "start where"),
        ((20.0, 20.0), 20.0, [counter_clockwise((INF, 0), (2, 0), (1, 0))], "finite"),
    ],
)
def test_faults_are_named(half: tuple[float, float], corner: float, segments: list[list[float]], fault: str) -> None:
    with pytest.raises(ValueError, match=fault):
        swept(half, corner, segments)


@pytest.mark.parametrize(
    ("rise", "place", "gap", "normal"),
    [
        (-1.0, (0.0, 0.0, -1.0), -np.sqrt(0.5), None),  # a cone that points up: metal beneath its flank
        (-1.0, (0.0, 0.0, 2.0), 2.0, (0.0, 0.0, 1.0)),
        (1.0, (0.0, 0.0, -1.0), -1.0, (0.0, 0.0, 1.0)),  # a recess: metal beneath its tip
        (1.0, (0.1, 0.0, -1.0), -np.hypot(0.1, 1.0), None),
        (1.0, (0.0, 0.0, 1.0), np.sqrt(0.5), None),
    ],
)
def test_a_profile_that_ends_on_the_axis_goes_on_as_its_mirror_image(rise, place, gap, normal) -> None:
    cone = swept((20.0, 20.0), 20.0, [line((-20.0, 0.0), (0.0, 20.0 * rise))])
    found, direction, _, _ = cone.nearest(np.array([place]))
    assert found[0] == pytest.approx(gap, abs=1e-12)
    if normal is not None:
        np.testing.assert_allclose(direction[0], normal, atol=1e-12)
