# SPDX-License-Identifier: Apache-2.0
"""Tools of an explicit run: motion curves, and wrong input with its remedy."""

import numpy as np
import pytest

from presswork import _core
from presswork.explicit.motion import SmoothStroke, VelocityCurve
from presswork.explicit.shells import ExplicitError, ExplicitShells
from tests.unit.explicit.two_shells import CELLS, LAW, POINTS, STEEL

CORNERS = 10.0 * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=float)
TABLE = _core.ToolSurface.triangles(CORNERS, np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32))


def build(height: float = 0.4) -> ExplicitShells:
    return ExplicitShells(POINTS + np.array([0.0, 0.0, height]), CELLS, 0.8, LAW, STEEL)


@pytest.mark.parametrize("rise", [0.1, 0.3, 0.5])
def test_smooth_stroke_reaches_its_stroke_without_jerks(rise: float) -> None:
    stroke = SmoothStroke(-25.0, 0.01, rise=rise, start=0.002)
    times = np.linspace(0.0, 0.014, 28001)
    way = stroke.position(times)
    speed = np.diff(way) / np.diff(times)
    assert way[0] == 0.0
    assert way[-1] == -25.0
    assert speed.min() == pytest.approx(stroke.peak, rel=1e-6)
    assert np.abs(np.diff(speed)).max() < 1.01 * abs(stroke.peak) * 0.5 * np.pi / (rise * 0.01) * 5e-7


def test_velocity_curve_is_integrated_exactly() -> None:
    curve = VelocityCurve([0.0, 1.0, 3.0], [0.0, 2.0, 0.0], stroke=3.0)
    np.testing.assert_allclose(curve.position(np.array([-1.0, 0.5, 1.0, 2.0, 3.0, 9.0])), [0, 0.25, 1, 2.5, 3, 3])


def test_a_following_tool_ends_where_its_stroke_ends() -> None:
    sheet = build(height=3.0)
    tool = sheet.add_tool("punch", TABLE)
    tool.follow([0, 0, 2], SmoothStroke(1.5, 300 * sheet.dt))
    for _ in range(10):
        sheet.advance(37)
    np.testing.assert_allclose(tool.position, [0.0, 0.0, 1.5], atol=1e-12)


def test_prescribed_velocity_is_scaled() -> None:
    sheet = build(height=3.0)
    tool = sheet.add_tool("punch", TABLE)
    tool.velocity = [0.0, 10.0, 100.0]
    sheet.advance(100, velocity_scale=np.linspace(0.0, 1.0, 100))
    np.testing.assert_allclose(tool.position, np.array([0.0, 10.0, 100.0]) * 50 * sheet.dt, rtol=1e-12)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: SmoothStroke(30.0, 0.0), "duration = 0 s"),
        (lambda: SmoothStroke(30.0, 0.02, rise=0.7), "rise = 0.7: the rise takes above 0 and at most 0.5"),
        (lambda: SmoothStroke(30.0, 0.02, rise=0.25, speed=1500.0), "speed = 1500 .* needs 2000 mm/s, or 0.0266667 s"),
        (lambda: VelocityCurve([0, 1, 2], [0, 1, 0], stroke=2.0), "comes to 1 mm: scale the velocities by 2, or"),
        (lambda: VelocityCurve([0, 1, 1], [0, 1, 0]), "times must rise, but 1 s comes too early"),
        (lambda: VelocityCurve([0.0], [1.0]), "give at least two"),
    ],
)
def test_curves_that_contradict_themselves(make: object, message: str) -> None:
    with pytest.raises(ExplicitError, match=message):
        make()  # type: ignore[operator]


@pytest.mark.parametrize(
    ("grip", "message"),
    [
        ({"mu": -0.1}, "tool 'die': mu = -0.1: Coulomb's coefficient is not negative"),
        ({"penalty": 0.5}, "penalty = 0.5: it must be above 0 and at most 0.2"),
        ({"penalty": 0.0}, "penalty = 0:"),
        ({"damping": 1.0}, "damping = 1: it lies between 0 and 0.5"),
    ],
)
def test_bad_grips(grip: dict[str, float], message: str) -> None:
    with pytest.raises(ExplicitError, match=message):
        build().add_tool("die", TABLE, **grip)  # type: ignore[arg-type]


def test_bad_motions() -> None:
    sheet = build()
    die = sheet.add_tool("die", TABLE)
    with pytest.raises(ExplicitError, match="tool 'die' is there already"):
        sheet.add_tool("die", TABLE)
    with pytest.raises(ExplicitError, match=r"velocity = .* give three finite numbers"):
        die.velocity = [0.0, np.nan, 0.0]
    with pytest.raises(ExplicitError, match=r"direction = .* it has no length"):
        die.push([0, 0, 0], 10.0)
    with pytest.raises(ExplicitError, match="mass = 0 t, but a tool that a force places needs at least"):
        die.push([0, 0, 1], 10.0, mass=0.0)
    with pytest.raises(ExplicitError, match="damping = -1 1/s"):
        die.push([0, 0, 1], 10.0, damping=-1.0)
    with pytest.raises(ExplicitError, match="force curve: times must rise"):
        die.push([0, 0, 1], ([0.0, -1.0], [0.0, 1.0]))
    die.push([0, 0, 1], 10.0)
    with pytest.raises(ExplicitError, match="tool 'die' is pushed by a force: it cannot have velocity too"):
        die.velocity = [0.0, 0.0, 1.0]


def test_a_sheet_that_starts_in_a_tool_is_refused() -> None:
    sheet = build(height=0.25)
    sheet.add_tool("die", TABLE)
    with pytest.raises(ExplicitError, match=r"starts in tool 'die': node \d is 0.15 mm deep"):
        sheet.advance(1)
    sheet = build(height=0.25)
    sheet.add_tool("die", TABLE, thickness=False)
    sheet.advance(1)


def test_a_dump_of_other_tools_is_refused() -> None:
    dump = build().dump()
    sheet = build()
    sheet.add_tool("die", TABLE)
    with pytest.raises(ExplicitError, match="tools are not those of this run: add them in the same order"):
        sheet.restore(dump)


def test_a_node_that_goes_through_is_reported() -> None:
    """A table found only to a depth of 0.05 mm, and a sheet thrown at it aslant at 570 m/s."""
    table = _core.ToolSurface.triangles(CORNERS, np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32), depth=0.05)
    sheet = build(height=0.45)
    sheet.add_tool("die", table, thickness=False)
    start = np.zeros((6, 6))
    start[:, 0], start[:, 2] = 4e5, -4e5
    sheet.velocity = start
    with pytest.raises(ExplicitError, match=r"node \d has gone through a tool .*push them less hard"):
        sheet.advance(60)


def test_a_node_that_is_pulled_past_the_rim_of_a_tool_is_not_lost() -> None:
    """Held between a table and a smaller plate, the sheet flies out from under the plate's open rim."""
    sheet = build(height=0.4)
    sheet.add_tool("die", TABLE)
    right = float(POINTS[:, 0].max())
    corners = np.array([[-10, -10, 0.8], [right + 0.05, -10, 0.8], [right + 0.05, 10, 0.8], [-10, 10, 0.8]])
    plate = _core.ToolSurface.triangles(corners, np.array([[0, 2, 1], [0, 3, 2]], dtype=np.int32), depth=0.5)
    start = np.zeros((6, 6))
    start[:, 0] = 1e4
    holder = sheet.add_tool("holder", plate)
    holder.push([0, 0, -1], 2000.0)
    sheet.velocity = start
    sheet.advance(8)
    assert holder.force[2] > 100.0
    sheet.advance(100)
    assert sheet.position[:, 0].max() > right + 0.1


def test_a_tool_taken_away_needs_no_drive_and_keeps_no_energy() -> None:
    """F for 10 cycles from rest gives m v^2/2 with v = 10 dt F/m; that goes with the tool, and long calls go on."""
    sheet = build(height=3.0)
    sheet.add_tool("never", TABLE)
    sheet.remove_tool("never")
    tool = sheet.add_tool("holder", TABLE)
    tool.push([0, 0, -1], 1.0)
    sheet.advance(10)
    assert tool.mass is not None
    kinetic = 0.5 * (10 * sheet.dt) ** 2 / tool.mass
    sheet.remove_tool("holder")
    sheet.advance(1000)
    energies = sheet.energies()
    assert energies.kinetic == 0.0
    assert energies.damping == pytest.approx(kinetic, rel=1e-12)
    assert energies.external == pytest.approx(kinetic, rel=1e-12)


def test_a_loop_refuses_what_would_lead_it_beyond_its_arrays() -> None:
    sheet = build(height=3.0)
    sheet.add_tool("die", TABLE)
    sheet.advance(5)
    loop, six = sheet._loop, np.ones(6)
    with pytest.raises(ValueError, match="a tool is not driven for as many cycles"):
        loop.advance(0.0, sheet.dt, sheet.dt, six, six)
    loop.drive_tool(0, np.zeros((6, 3)))
    loop.add_bead(np.array([[0.5, 0.5]]), np.array([[1.0, 0.0]]), np.ones(1), force=1.0)
    with pytest.raises(ValueError, match="a bead is not driven for as many cycles"):
        loop.advance(0.0, sheet.dt, sheet.dt, six, six)
    loop.drive_bead(0, six)
    loop.advance(0.0, sheet.dt, sheet.dt, six, six)
    state = loop.state()
    loop.restore(state)
    state["beads"]["cell"] = np.full((1, 2), float(len(CELLS)))
    with pytest.raises(ValueError, match="beads are not those of this run"):
        loop.restore(state)
    other = build(height=3.0)
    parents, whole = np.zeros((6, 4), dtype=np.int32), np.arange(2, dtype=np.int32)
    for nodes, cells in ((parents + 6, whole), (parents, whole + 1), (parents - 1, whole)):
        with pytest.raises(ValueError, match="a parent is not there"):
            other._loop.inherit(build()._loop, POINTS, nodes, cells, np.ones(2), other.dt)
