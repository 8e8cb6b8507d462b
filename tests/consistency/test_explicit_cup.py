# SPDX-License-Identifier: Apache-2.0
"""Contact of explicit shells: threads, restart, options, both kinds of surface, both precisions."""

import numpy as np
import pytest

from presswork import _core
from presswork.explicit.motion import SmoothStroke
from presswork.explicit.shells import ExplicitShells
from presswork.geometry.swept_tool import draw_die, draw_punch, triangulate
from presswork.geometry.tool_surface import make_surface

MISES = _core.YieldFunction.hill1948([0.5, 0.5, 0.5, 1.5, 1.5, 1.5])
SWIFT = _core.SheetLaw(207e3, 0.3, MISES, _core.HardeningLaw.swift, [565.0, 0.007, 0.26])
THICKNESS = 0.8
PLATE = np.array([[-40, -40, 0], [40, -40, 0], [40, 40, 0], [-40, 40, 0]], dtype=float)


def draw(
    precision: str = "double",
    *,
    n: int = 20,
    radius: float = 3.0,
    triangles: bool = False,
    device: str = "cpu",
    **grip: object,
) -> ExplicitShells:
    """Small round cup: die, punch that follows a smooth stroke, holder pushed by a force; n x n shells."""
    # beside the middle: no edge lies on a fold between triangles, where rounding would choose the side
    x, y = np.meshgrid(np.linspace(-18, 18, n + 1) + 0.013, np.linspace(-18, 18, n + 1) + 0.007)
    points = np.stack([x.ravel(), y.ravel(), 0 * x.ravel() + 0.5 * THICKNESS], axis=1)
    first = (np.arange(n)[None, :] + (n + 1) * np.arange(n)[:, None]).ravel()
    cells = np.stack([first, first + 1, first + n + 2, first + n + 1], axis=1)
    sheet = ExplicitShells(
        points, cells, THICKNESS, SWIFT, 7.85e-9, precision=precision, device=device  # type: ignore[arg-type]
    )  # fmt: skip
    die = draw_die((11.0, 11.0), 11.0, radius, width=40.0, depth=20.0)
    punch = draw_punch((10.0, 10.0), 10.0, radius, 30.0)
    for name, tool in (("die", die), ("punch", punch)):
        surface = _core.ToolSurface.triangles(*triangulate(tool, 0.01)) if triangles else make_surface(tool)
        sheet.add_tool(name, surface, **({"mu": 0.1} | grip))  # type: ignore[arg-type]
    down = np.array([[0, 2, 1], [0, 3, 2]], dtype=np.int32)
    sheet.add_tool("holder", _core.ToolSurface.triangles(PLATE, down), **({"mu": 0.1} | grip))  # type: ignore[arg-type]
    sheet.tools["punch"].position = sheet.tools["holder"].position = [0.0, 0.0, THICKNESS]
    sheet.tools["punch"].follow([0, 0, -1], SmoothStroke(3.0, 5e-4, rise=0.4))
    sheet.tools["holder"].push([0, 0, -1], 2000.0, damping=1e4)
    return sheet


def results(sheet: ExplicitShells) -> list[np.ndarray]:
    tools = [np.concatenate([t.position, t.force, t.velocity]) for t in sheet.tools.values()]
    e = sheet.energies()
    sums = np.array([e.kinetic, e.internal, e.external, e.contact, e.friction, e.damping, e.error_percent])
    return [sheet.position, sheet.velocity, sheet.stress, sheet.thickness, sheet.contact_force, *tools, sums]


@pytest.mark.parametrize("precision", ["double", "single"])
def test_threads_do_not_change_a_bit_of_contact(precision: str) -> None:
    before, runs = _core.max_threads(), []
    for threads in (1, 2, 3):
        _core.set_threads(threads)
        sheet = draw(precision, n=33, radius=1.0)
        sheet.advance(300)
        runs.append(results(sheet))
    _core.set_threads(before)
    assert np.abs(runs[0][4]).max() > 1.0
    for other in runs[1:]:
        for a, b in zip(runs[0], other, strict=True):
            np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("precision", ["double", "single"])
def test_contact_goes_on_from_a_dump_with_the_same_bits(precision: str) -> None:
    whole = draw(precision, radius=1.0)
    whole.advance(1000)
    dump = whole.dump()
    whole.advance(700)
    again = draw(precision, radius=1.0)
    again.restore(dump)
    again.advance(700)
    for a, b in zip(results(whole), results(again), strict=True):
        np.testing.assert_array_equal(a, b)


def test_edges_touch_only_where_a_radius_is_less_than_their_length() -> None:
    """Edges of 36/33 mm: a radius of 3 mm is gentle for them, one of 1 mm sharp; smooth and in triangles."""
    for radius, sharp in ((3.0, False), (1.0, True)):
        for triangles in (False, True):
            nodes, edges = (draw(n=33, radius=radius, triangles=triangles, edges=on) for on in (False, True))
            for sheet in (nodes, edges):
                sheet.advance(600)
            assert (np.abs(nodes.position - edges.position).max() > 1e-6) == sharp, (radius, triangles)


def test_calls_may_be_long_or_short_with_tools() -> None:
    one, many = draw(), draw()
    one.advance(600)
    for _ in range(6):
        many.advance(100)
    np.testing.assert_allclose(one.position, many.position, atol=1e-10)


def test_smooth_surfaces_and_triangles_give_the_same_cup() -> None:
    """Chords are off by at most 0.01 mm: the sheet differs by little more, the punch's force by 2 %."""
    smooth, faceted = draw(), draw(triangles=True)
    for sheet in (smooth, faceted):
        sheet.advance(round(5e-4 / sheet.dt) + 1)
    np.testing.assert_allclose(smooth.position, faceted.position, atol=0.03)
    forces = [np.abs(s.contact_force[:, 2]).sum() for s in (smooth, faceted)]
    assert forces[0] == pytest.approx(forces[1], rel=0.05)
    for sheet in (smooth, faceted):
        assert abs(sheet.energies().error_percent) < 1.0


def test_single_precision_draws_the_same_cup() -> None:
    double, single = draw(), draw("single")
    for sheet in (double, single):
        sheet.advance(1000)
        assert abs(sheet.energies().error_percent) < 1.0
    np.testing.assert_allclose(double.position, single.position, atol=0.01)


@pytest.mark.parametrize(
    "grip", [{"mu": 0.2}, {"penalty": 0.05}, {"damping": 0.3}, {"edges": False}, {"thickness": False}]
)
def test_every_property_of_a_tool_changes_the_result(grip: dict[str, object]) -> None:
    plain, other = draw(radius=1.0), draw(radius=1.0, **grip)  # type: ignore[arg-type]
    for sheet in (plain, other):
        sheet.advance(1000)
    assert 1e-7 < np.abs(plain.position - other.position).max() < 2.0


def test_a_tool_taken_away_touches_no_more() -> None:
    sheet = draw()
    sheet.advance(1000)
    assert np.abs(sheet.contact_force).max() > 0.0
    for name in list(sheet.tools):
        sheet.remove_tool(name)
    sheet.advance(10)
    assert np.abs(sheet.contact_force).max() == 0.0
    assert abs(sheet.energies().error_percent) < 1.0
