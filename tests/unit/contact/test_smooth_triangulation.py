# SPDX-License-Identifier: Apache-2.0
"""Triangles rounded off: nearer to the tool that they were cut from, with normals that do not jump."""

import numpy as np
import pytest

from presswork import _core
from presswork.geometry.swept_tool import draw_die, draw_hemispherical_punch, draw_punch, triangulate
from presswork.geometry.tool_surface import make_surface
from presswork.model import SweptProfile

CHORDS = 0.05
"""How far the triangles are off the tool at most [mm]."""
TOOLS = {
    "punch": draw_punch((25.5, 25.5), 10.0, 4.0, 30.0),
    "die": draw_die((27.0, 27.0), 11.5, 4.0, width=40.0, depth=30.0),
    "ball": draw_hemispherical_punch(25.0, 40.0),
}


def cut(tool: SweptProfile) -> tuple[_core.ToolSurface, _core.ToolSurface]:
    """Return the tool's triangles, as they are and rounded off."""
    points, triangles = triangulate(tool, CHORDS)
    flat, smooth = (_core.ToolSurface.triangles(points, triangles, smooth=s) for s in (False, True))
    return flat, smooth


def nodes_near(tool: SweptProfile, n: int = 4000) -> np.ndarray:
    """Return places where the middle of a sheet may lie, some of them pressed into the tool."""
    rng = np.random.default_rng(6)
    around = np.column_stack([rng.uniform(-35.0, 35.0, (n, 2)), rng.uniform(-8.0, 12.0, n)])
    _, normal, place, _ = make_surface(tool).nearest(around)
    return place + rng.uniform(-0.1, 0.5, n)[:, None] * normal


@pytest.mark.parametrize("name", TOOLS)
def test_gap_and_normal_are_those_of_the_tool_not_of_its_chords(name: str) -> None:
    flat, smooth = cut(TOOLS[name])
    x = nodes_near(TOOLS[name])
    gap, normal, _, _ = make_surface(TOOLS[name]).nearest(x)
    off = [np.abs(surface.nearest(x)[0] - gap).max() for surface in (flat, smooth)]
    assert off[0] > 0.3 * CHORDS
    assert off[1] < 0.05 * CHORDS
    turned = [np.linalg.norm(surface.nearest(x)[1] - normal, axis=1).max() for surface in (flat, smooth)]
    assert turned[1] < 0.15 * turned[0]


@pytest.mark.parametrize("name", TOOLS)
def test_slopes_are_the_derivatives_of_gap_and_normal(name: str) -> None:
    smooth = cut(TOOLS[name])[1]
    x = nodes_near(TOOLS[name])
    h = 1e-5
    ends = [(smooth.nearest(x + h * e), smooth.nearest(x - h * e)) for e in np.eye(3)]
    for number, slope in enumerate(smooth.slopes(x)):
        finite = np.stack([(after[number] - before[number]) / (2.0 * h) for after, before in ends], axis=-1)
        off = np.abs(finite - slope).reshape(len(x), -1).max(axis=1)
        assert (off < 1e-7).mean() > 0.99  # a few differences reach over an edge, where the curvature jumps
        assert off.max() < 0.2  # but the normal does not: 1e5 times its jump


def test_a_box_keeps_its_faces_and_edges() -> None:
    """Creases end the mean of the normals; beyond them the distance is that of the box."""
    corners = np.array([(x, y, z) for z in (-1.0, 1.0) for y in (-2.0, 2.0) for x in (-3.0, 3.0)])
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], dtype=np.int32)
    at = np.random.default_rng(7).uniform(-4.0, 4.0, (3000, 3))
    flat, smooth = (_core.ToolSurface.triangles(corners, triangles, smooth=s) for s in (False, True))
    for one, other in zip(flat.nearest(at)[:3], smooth.nearest(at)[:3], strict=True):
        np.testing.assert_allclose(one, other, atol=1e-12)


def test_beyond_an_open_edge_there_is_no_tool() -> None:
    points = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0)])
    plate = _core.ToolSurface.triangles(points, np.array([(0, 1, 2), (0, 2, 3)], dtype=np.int32), smooth=True)
    gap = plate.nearest(np.array([(0.5, 0.4, 0.1), (1.5, 0.5, 0.1), (0.5, 0.4, -0.1)]))[0]
    np.testing.assert_allclose(gap, [0.1, np.inf, -0.1])
