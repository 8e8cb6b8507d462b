# SPDX-License-Identifier: Apache-2.0
"""Tools drawn from their dimensions, and their triangles."""

import math

import numpy as np
import pytest

from presswork import _core
from presswork.geometry.swept_tool import draw_die, draw_hemispherical_punch, draw_holder, draw_punch, triangulate
from presswork.geometry.tool_surface import make_surface
from presswork.mesh.topology import find_boundary_edges
from presswork.model import SweptProfile

INF = math.inf
TOOLS = {
    "punch": draw_punch((25.5, 20.0), 10.0, 4.0, 30.0),
    "sharp punch": draw_punch((25.5, 20.0), 0.0, 0.0, 30.0),
    "round punch": draw_punch((25.0, 25.0), 25.0, 4.0, 30.0),
    "hemisphere": draw_hemispherical_punch(25.0, 40.0),
    "strip punch": draw_punch((25.0, INF), 0.0, 4.0, 30.0),
    "die": draw_die((27.0, 27.0), 11.5, 4.0, width=40.0, depth=30.0),
    "strip die": draw_die((INF, 27.0), 0.0, 4.0, width=40.0, depth=30.0),
    "holder": draw_holder((27.0, 27.0), 11.5, 2.0, width=40.0, height=30.0),
}


def normals_and_middles(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    a, b, c = (points[triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    return normal / np.linalg.norm(normal, axis=1)[:, None], (a + b + c) / 3.0


def test_thesis_punch_and_die_have_their_clearance() -> None:
    """Cheng (1995), plots of the square cup: X0 = Y0 = 15.5, R1 = 6, r1 = r2 = 4, gap 1.5 on every side."""
    punch = draw_punch((15.5 + 6.0 + 4.0,) * 2, 6.0 + 4.0, 4.0, 30.0)
    die = draw_die((27.0, 27.0), 11.5, 4.0, width=40.0, depth=40.0)
    angle = np.linspace(0.0, 0.5 * math.pi, 30)
    corner = 15.5 + 10.0 * np.column_stack([np.cos(angle), np.sin(angle)])
    wall = np.concatenate([corner, [[25.5, 3.0], [-7.0, 25.5]]])
    x = np.column_stack([wall, np.full(len(wall), -10.0)])
    np.testing.assert_allclose(make_surface(die).nearest(x)[0], 1.5, atol=1e-12)
    np.testing.assert_allclose(make_surface(punch).nearest(x + np.array([0.0, 0.0, 20.0]))[0], 0.0, atol=1e-12)


def test_plan_may_be_the_inner_curve_of_the_drawing() -> None:
    """The thesis's plots give the plan of the corner centres' curve: the same surface, its profile moved along s."""
    outer = draw_punch((25.5, 25.5), 10.0, 4.0, 30.0)
    segments = outer.segments.copy()
    segments[:, [0, 2, 4]] += 4.0
    inner = SweptProfile((21.5, 21.5), 6.0, segments)
    x = np.random.default_rng(3).uniform(-30.0, 30.0, (1000, 3))
    for one, other in zip(make_surface(outer).nearest(x)[:3], make_surface(inner).nearest(x)[:3], strict=True):
        np.testing.assert_allclose(one, other, atol=1e-12)


@pytest.mark.parametrize(
    ("tool", "free", "gap", "normal"),
    [
        ("punch", (0.0, 0.0, -1.0), 1.0, (0, 0, -1)),
        ("punch", (26.5, 0.0, 10.0), 1.0, (1, 0, 0)),
        ("hemisphere", (0.0, 0.0, -1.0), 1.0, (0, 0, -1)),
        ("hemisphere", (0.0, 26.0, 25.0), 1.0, (0, 1, 0)),
        ("strip punch", (-26.0, 77.0, 20.0), 1.0, (-1, 0, 0)),
        ("die", (40.0, 0.0, 1.0), 1.0, (0, 0, 1)),
        ("die", (26.0, 0.0, -10.0), 1.0, (-1, 0, 0)),
        ("strip die", (77.0, -26.0, -10.0), 1.0, (0, 1, 0)),
        ("holder", (40.0, 0.0, -1.0), 1.0, (0, 0, -1)),
        ("holder", (26.0, 0.0, 10.0), 1.0, (-1, 0, 0)),
        ("holder", (40.0, 0.0, 0.5), -0.5, (0, 0, -1)),
    ],
)
def test_free_space_is_where_the_sheet_is(tool: str, free: tuple[float, ...], gap: float, normal: tuple) -> None:
    found, direction, _, _ = make_surface(TOOLS[tool]).nearest(np.array([free]))
    assert found[0] == pytest.approx(gap)
    np.testing.assert_allclose(direction[0], normal, atol=1e-12)


@pytest.mark.parametrize("size", [INF, 3.0])
@pytest.mark.parametrize("name", TOOLS)
def test_triangles_keep_the_tolerance_and_the_side(name: str, size: float) -> None:
    tool, tolerance = TOOLS[name], 0.02
    points, triangles = triangulate(tool, tolerance, size=size)
    surface = make_surface(tool)
    normal, middle = normals_and_middles(points, triangles)
    edges = 0.5 * (points[triangles] + points[np.roll(triangles, 1, axis=1)]).reshape(-1, 3)
    np.testing.assert_allclose(surface.nearest(points)[0], 0.0, atol=1e-9)
    assert np.abs(surface.nearest(np.concatenate([middle, edges]))[0]).max() < tolerance
    off = middle + 0.1 * normal
    assert surface.nearest(off)[0].min() > 0.1 - 2.0 * tolerance
    sides = np.linalg.norm(points[triangles] - points[np.roll(triangles, 1, axis=1)], axis=2)
    assert sides.max() < 1.5 * size


@pytest.mark.parametrize(("name", "rims"), [("punch", 1), ("die", 2), ("holder", 2), ("hemisphere", 1)])
def test_triangles_leave_no_hole(name: str, rims: int) -> None:
    points, triangles = triangulate(TOOLS[name], 0.05, size=4.0)
    _core.ToolSurface.triangles(points, triangles)  # wound alike, no edge with three triangles
    rim = find_boundary_edges([triangles])
    after = dict(rim.tolist())
    loops = 0
    while after:
        loops += 1
        node, last = after.popitem()
        while last != node:
            last = after.pop(last)
    assert loops == rims


def test_triangles_approach_the_surface_with_the_square_of_their_size() -> None:
    """Two independent kinds of surface agree, gap and normal, the better the finer the triangles."""
    tool = draw_punch((25.5, 20.0), 10.0, 4.0, 30.0)
    smooth = make_surface(tool)
    rng = np.random.default_rng(1)
    x = np.column_stack([rng.uniform(-28, 28, 4000), rng.uniform(-23, 23, 4000), rng.uniform(-2.0, 12.0, 4000)])
    gap, normal, _, _ = smooth.nearest(x, 2.0)
    near = np.abs(gap) < 1.5
    x, gap, normal = x[near], gap[near], normal[near]
    worst, slant = [], []
    for tolerance in (0.04, 0.01, 0.0025):
        points, triangles = triangulate(tool, tolerance)
        faceted = _core.ToolSurface.triangles(points, triangles).nearest(x)
        worst.append(np.abs(faceted[0] - gap).max())
        slant.append(np.abs(faceted[1] - normal).max())
        assert worst[-1] < tolerance
    assert worst[0] / worst[1] == pytest.approx(4.0, rel=0.3)
    assert worst[1] / worst[2] == pytest.approx(4.0, rel=0.3)
    assert slant[0] / slant[2] == pytest.approx(4.0, rel=0.4)  # of first order
