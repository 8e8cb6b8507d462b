# SPDX-License-Identifier: Apache-2.0
"""Triangulated tool surfaces against closed forms and against trying every triangle."""

import numpy as np
import pytest

from presswork import _core
from tests.unit.contact.shapes import box_distance, box_triangles, distance_to_triangles, height_field

INF = float("inf")
HALF = (20.0, 15.0, 10.0)


def test_box_has_its_closed_form_inside_and_outside() -> None:
    x = np.random.default_rng(2).uniform(-30.0, 30.0, (3000, 3))
    gap, normal, place, _ = _core.ToolSurface.triangles(*box_triangles(HALF)).nearest(x)
    np.testing.assert_allclose(gap, box_distance(x, HALF), atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose(x - gap[:, None] * normal, place, atol=1e-12)


def test_cavity_is_the_box_inside_out() -> None:
    points, triangles = box_triangles(HALF)
    x = np.random.default_rng(3).uniform(-30.0, 30.0, (3000, 3))
    cavity = _core.ToolSurface.triangles(points, triangles[:, ::-1].copy())
    np.testing.assert_allclose(cavity.nearest(x)[0], -box_distance(x, HALF), atol=1e-12)


def test_gap_on_the_surface_is_zero_and_the_normal_lies_between_those_of_the_faces() -> None:
    tool = _core.ToolSurface.triangles(*box_triangles((1.0, 1.0, 1.0)))
    gap, normal, _, _ = tool.nearest(np.array([[1.0, 0.2, 0.3], [1.0, 1.0, 0.3], [1.0, 1.0, 1.0]]))
    np.testing.assert_allclose(gap, 0.0, atol=1e-15)
    np.testing.assert_allclose(normal[0], [1.0, 0.0, 0.0], atol=1e-15)
    assert (normal >= 0.0).all()
    np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1.0, atol=1e-15)


def test_sign_at_a_slanting_tip_needs_the_weights_by_angle() -> None:
    """Baerentzen & Aanaes (2005), figure 2: with a fan of many slivers on one side of the tip the plain mean of the
    normals leans so far that points outside seem to lie inside."""
    n = 40
    apex, reach = np.array([[0.0, 0.0, 1.0]]), 3.0
    angle = np.concatenate([np.linspace(0.0, 0.4, n), [2.2, 4.2]])
    rim = np.column_stack([reach * np.cos(angle), reach * np.sin(angle), np.zeros(n + 2)])
    points = np.concatenate([apex, rim, [[0.0, 0.0, 0.0]]])
    ring = np.arange(1, n + 3)
    after = np.roll(ring, -1)
    sides = np.column_stack([np.zeros_like(ring), ring, after])
    base = np.column_stack([np.full_like(ring, n + 3), after, ring])
    triangles = np.concatenate([sides, base]).astype(np.int32)
    tool = _core.ToolSurface.triangles(points, triangles)
    a, b, c = (points[sides[:, k]] for k in range(3))
    outward = np.cross(b - a, c - a)
    x = apex + np.random.default_rng(4).normal(size=(4000, 3)) * 0.1
    outside = ((x[:, None] - apex) * outward[None]).sum(axis=2).max(axis=1) > 0.0
    gap = tool.nearest(x)[0]
    assert outside.any()
    assert not outside.all()
    np.testing.assert_array_equal(gap > 0.0, outside)


def test_two_boxes_joined_are_not_convex_and_have_the_right_sign() -> None:
    """An L: outside, the smaller of two distances from boxes."""
    x = np.array([0.0, 1.0, 2.0])
    corners = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    points = np.array([[x[i], x[j], z] for z in (0.0, 1.0) for i, j in corners])
    cap = [(0, 1, 2), (0, 2, 3), (0, 3, 5), (3, 4, 5)]
    walls = [t for i in range(6) for t in ((i, (i + 1) % 6, (i + 1) % 6 + 6), (i, (i + 1) % 6 + 6, i + 6))]
    triangles = [tuple(k + 6 for k in t) for t in cap] + [t[::-1] for t in cap] + walls
    tool = _core.ToolSurface.triangles(points, np.array(triangles, dtype=np.int32))
    at = np.random.default_rng(5).uniform(-1.0, 3.0, (4000, 3))
    lying = box_distance(at - [1.0, 0.5, 0.5], (1.0, 0.5, 0.5))
    standing = box_distance(at - [0.5, 1.0, 0.5], (0.5, 1.0, 0.5))
    union = np.minimum(lying, standing)
    gap = tool.nearest(at)[0]
    np.testing.assert_array_equal(gap > 0.0, union > 0.0)
    np.testing.assert_allclose(gap[union > 0.0], union[union > 0.0], atol=1e-12)


@pytest.fixture(scope="module")
def bumpy() -> tuple[_core.ToolSurface, np.ndarray, np.ndarray]:
    points, triangles = height_field(20, 3.0, 0.7)
    return _core.ToolSurface.triangles(points, triangles), points, triangles


def test_search_finds_what_trying_every_triangle_finds(bumpy) -> None:
    tool, points, triangles = bumpy
    x = np.random.default_rng(6).uniform(-2.0, 2.0, (500, 3))
    exact = np.array([distance_to_triangles(p, points, triangles) for p in x])
    gap = tool.nearest(x)[0]
    np.testing.assert_allclose(np.abs(gap), exact, atol=1e-12)
    surface = 0.7 * np.sin(1.7 * x[:, 0]) * np.cos(1.3 * x[:, 1])
    clear = np.abs(x[:, 2] - surface) > 0.1
    np.testing.assert_array_equal(gap[clear] > 0.0, (x[:, 2] > surface)[clear])


def test_hints_change_nothing(bumpy) -> None:
    tool, points, triangles = bumpy
    rng = np.random.default_rng(7)
    x = np.concatenate([rng.uniform(-2.0, 2.0, (500, 3)), points[rng.integers(0, len(points), 200)]])
    first = tool.nearest(x)
    for hints in (first[3], rng.integers(0, len(triangles), len(x)).astype(np.int32)):
        for known, again in zip(first, tool.nearest(x, hints=hints), strict=True):
            np.testing.assert_array_equal(known, again)


def test_a_walk_along_the_surface_finds_what_a_search_from_nowhere_finds() -> None:
    """Hints that lag behind: leaves around the last one, or the tree where the point has gone farther."""
    points, triangles = height_field(60, 3.0, 0.7)
    tool = _core.ToolSurface.triangles(points, triangles)
    rng = np.random.default_rng(8)
    x = rng.uniform(-2.0, 2.0, (300, 3))
    x[:, 2] = 0.7 * np.sin(1.7 * x[:, 0]) * np.cos(1.3 * x[:, 1]) + rng.choice([1e-4, 0.03, 0.2], 300)
    hints = tool.nearest(x)[3]
    for step in (1e-3, 0.02, 0.1, 0.5):
        x = x + step * rng.normal(size=x.shape)
        warm, cold = tool.nearest(x, hints=hints), tool.nearest(x)
        for one, other in zip(warm, cold, strict=True):
            np.testing.assert_array_equal(one, other)
        hints = warm[3]


def test_beyond_an_open_edge_there_is_no_tool() -> None:
    points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    tool = _core.ToolSurface.triangles(points, np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32))
    x = np.array(
        [[0.5, 0.5, 0.2], [0.5, 0.5, -0.2], [1.1, 0.5, 0.2], [-0.1, -0.1, 0.1], [1.0, 0.5, 0.2], [0.0, 0, -0.1]]
    )
    gap, normal, _, _ = tool.nearest(x)
    np.testing.assert_allclose(gap, [0.2, -0.2, INF, INF, 0.2, -0.1], atol=1e-12)
    np.testing.assert_allclose(normal[[0, 1, 4, 5]], [[0.0, 0.0, 1.0]] * 4, atol=1e-12)


def test_reach_and_depth_bound_what_is_found(bumpy) -> None:
    points, triangles = height_field(4, 1.0, 0.0)
    tool = _core.ToolSurface.triangles(points, triangles, depth=0.3)
    x = np.array([[0.1, 0.1, z] for z in (0.9, 0.45, -0.25, -0.35, -0.9)])
    np.testing.assert_allclose(tool.nearest(x, 0.5)[0], [INF, 0.45, -0.25, INF, INF], atol=1e-12)
    np.testing.assert_allclose(tool.distance_bound(x, 0.5), [0.5, 0.45, -0.25, 0.05, 0.5], atol=1e-12)


def test_faults_are_named() -> None:
    points, triangles = box_triangles(HALF)

    def make(changed: np.ndarray) -> None:
        _core.ToolSurface.triangles(points, changed.astype(np.int32))

    flipped = triangles.copy()
    flipped[3] = flipped[3, ::-1]
    with pytest.raises(ValueError, match="wound against each other"):
        make(flipped)
    with pytest.raises(ValueError, match="more than two triangles"):
        make(np.concatenate([triangles, [[0, 3, 7]]]))
    with pytest.raises(ValueError, match=r"triangle 12 .* no area"):
        make(np.concatenate([triangles, [[0, 3, 3]]]))
    with pytest.raises(ValueError, match="not there"):
        make(np.concatenate([triangles, [[0, 3, 8]]]))
