# SPDX-License-Identifier: Apache-2.0
"""Explicit shells against rigid tools: closed forms of friction, bounce and pressing; bounds of penetration."""

from dataclasses import replace

import numpy as np
import pytest

from presswork import _core
from presswork.explicit.motion import SmoothStroke
from presswork.explicit.shells import ExplicitShells
from presswork.explicit.tools import RigidTool
from presswork.geometry.swept_tool import draw_hemispherical_punch
from presswork.geometry.tool_surface import make_surface
from presswork.model import SweptProfile
from tests.problems.explicit_shells import DENSITY, elastic_options, grid, mises

THICKNESS = 0.8
SWIFT = mises("swift", (565.0, 0.007, 0.26))


def flat(up: bool = True, size: float = 50.0) -> _core.ToolSurface:
    """Two triangles in the plane z = 0, metal below (up) or above."""
    points = size * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=float)
    triangles = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
    return _core.ToolSurface.triangles(points, triangles if up else np.ascontiguousarray(triangles[:, ::-1]))


def block(height: float = 0.5 * THICKNESS, n: int = 4) -> ExplicitShells:
    """Elastic sheet, 8 x 8 mm; height of its mid-surface."""
    points, cells = grid(n, n, 8.0, 8.0)
    return ExplicitShells(
        points + np.array([0, 0, height]), cells, THICKNESS, mises(), DENSITY, options=elastic_options()
    )


def load(sheet: ExplicitShells, along: float, down: float) -> None:
    """Spread forces along x and down z over the nodes by their mass."""
    share = sheet.mass[:, 0] / sheet.mass[:, 0].sum()
    force = np.zeros((len(share), 6))
    force[:, 0], force[:, 2] = along * share, -down * share
    sheet.force = force


def press(sheet: ExplicitShells, cycles: int = 400) -> None:
    """Put the load on smoothly."""
    sheet.advance(cycles, force_scale=0.5 - 0.5 * np.cos(np.pi * np.arange(cycles) / cycles))
    sheet.advance(100)


def test_sliding_block_stops_where_friction_says() -> None:
    """v^2/(2 mu N/m), friction takes all of its kinetic energy; 0.2 %, of which elastic slip has 0.1 %."""
    mu, down, speed = 0.15, 20.0, 3000.0
    sheet = block()
    table = sheet.add_tool("table", flat(), mu=mu)
    load(sheet, 0.0, down)
    press(sheet)
    assert table.force[2] == pytest.approx(-down, rel=1e-3)
    start, mass = sheet.position[0, 0], sheet.mass[:, 0].sum()
    moving = sheet.velocity
    moving[:, 0] += speed
    sheet.velocity = moving
    before = sheet.energies()
    sheet.advance(round(0.5 * speed / (mu * down / mass) / sheet.dt))
    assert table.force[0] == pytest.approx(mu * down, rel=1e-3)
    sheet.advance(round(0.6 * speed / (mu * down / mass) / sheet.dt))
    after = sheet.energies()
    way = speed**2 / (2 * mu * down / mass)
    assert sheet.position[0, 0] - start == pytest.approx(way, rel=2e-3)
    assert after.friction - before.friction == pytest.approx(0.5 * mass * speed**2, rel=2e-3)
    assert abs(after.error_percent) < 0.1


def test_block_sticks_below_mu_times_n_and_slides_above() -> None:
    """Held at 0.9 mu N; at 1.5 mu N it gains (F - mu N)/m, within 0.5 %."""
    mu, down = 0.2, 20.0
    moved, speeds = [], []
    for ratio in (0.9, 1.5):
        sheet = block()
        sheet.add_tool("table", flat(), mu=mu)
        load(sheet, 0.0, down)
        press(sheet)
        load(sheet, ratio * mu * down, down)
        start, cycle = sheet.position[0, 0], 4000
        sheet.advance(cycle, force_scale=1.0)
        moved.append(sheet.position[0, 0] - start)
        speeds.append(sheet.velocity[:, 0].mean() / (cycle * sheet.dt * 0.5 * mu * down / sheet.mass[:, 0].sum()))
    assert abs(moved[0]) < 1e-3
    assert speeds[1] == pytest.approx(1.0, rel=5e-3)


def test_bounce_conserves_energy() -> None:
    """An elastic sheet thrown flat at a plane, without damping, comes back as fast as it came."""
    sheet = block(height=0.5 * THICKNESS + 0.05)
    table = sheet.add_tool("table", flat(), damping=0.0)
    start = np.zeros((len(sheet.position), 6))
    start[:, 2] = -2000.0
    sheet.velocity = start
    mass, force = sheet.mass[:, 0].sum(), []
    for _ in range(60):
        sheet.advance(10)
        force.append(table.force[2])
    assert min(force) < -10.0  # it has touched
    assert table.force[2] == 0.0  # and left
    np.testing.assert_allclose(sheet.velocity[:, 2], 2000.0, rtol=0.02)
    energy = sheet.energies()
    assert energy.kinetic == pytest.approx(0.5 * mass * 2000.0**2, rel=0.02)
    assert abs(energy.contact) < 1e-15  # of 0.8 N mm: what is left is rounding in the work on the thickness


def test_contact_damping_takes_what_it_says() -> None:
    """Half of critical: the sheet comes back slower, and the balance knows where the energy is."""
    sheet = block(height=0.5 * THICKNESS + 0.05)
    sheet.add_tool("table", flat(), damping=0.5)
    start = np.zeros((len(sheet.position), 6))
    start[:, 2] = -2000.0
    sheet.velocity = start
    sheet.advance(600)
    energy = sheet.energies()
    assert 0.0 < sheet.velocity[:, 2].mean() < 1000.0
    assert energy.damping > 0.75 * 0.5 * sheet.mass[:, 0].sum() * 2000.0**2
    assert abs(energy.error_percent) < 5.0


def hold(force: float, **grip: object) -> tuple[ExplicitShells, RigidTool, RigidTool]:
    """Sheet between a die and a holder that is pushed down by a force which rises within 600 cycles."""
    sheet = block()
    die, holder = sheet.add_tool("die", flat(), **grip), sheet.add_tool("holder", flat(False), **grip)  # type: ignore[arg-type]
    holder.position = [0.0, 0.0, THICKNESS]
    times = np.linspace(0.0, 600 * sheet.dt, 50)
    holder.push([0, 0, -2], (times, force * (0.5 - 0.5 * np.cos(np.pi * times / times[-1]))), damping=2e5)
    sheet.advance(2000, damping=2e5)
    return sheet, die, holder


def test_holder_force_comes_through_the_sheet() -> None:
    """Force of the holder on the sheet, of the sheet on the die and of the push: 0.2 %; the tools a thickness apart."""
    force = 500.0
    sheet, die, holder = hold(force)
    assert holder.force[2] == pytest.approx(force, rel=2e-3)
    assert die.force[2] == pytest.approx(-force, rel=2e-3)
    assert holder.position[2] == pytest.approx(sheet.thickness.mean() - die.penetration - holder.penetration, abs=1e-5)
    assert holder.penetration < 2e-3
    assert abs(sheet.energies(damping=2e5).error_percent) < 0.1
    np.testing.assert_allclose(sheet.contact_force.sum(axis=0), -(die.force + holder.force), atol=1e-9)


def test_tools_follow_the_thickness_of_a_stretched_sheet() -> None:
    """Stretched by 10 % between die and holder the sheet thins, and the holder comes down with it: 0.1 %."""
    speed = 300.0
    points, cells = grid(6, 6, 12.0, 12.0)
    sheet = ExplicitShells(points + np.array([0, 0, 0.5 * THICKNESS]), cells, THICKNESS, SWIFT, DENSITY)
    die, holder = sheet.add_tool("die", flat()), sheet.add_tool("holder", flat(False))
    holder.position = [0.0, 0.0, THICKNESS]
    holder.push([0, 0, -1], 200.0, damping=1e5)
    for i, letter in enumerate("uv"):
        sheet.fix(np.arange(len(points)), letter, speed * (points[:, i] - 6.0) / 6.0)
    start = np.zeros((len(points), 6))
    start[:, :2] = speed * (points[:, :2] - 6.0) / 6.0
    sheet.velocity = start
    sheet.advance(round(0.6 / speed / sheet.dt), damping=1e5)
    thickness = sheet.thickness
    assert thickness.max() < 0.85 * THICKNESS
    assert np.ptp(thickness) < 1e-6
    assert holder.position[2] == pytest.approx(thickness.mean() - die.penetration - holder.penetration, rel=1e-3)
    assert abs(sheet.energies(damping=1e5).error_percent) < 1.0


def capstan(mu: float, quarter_turns: int = 1) -> float:
    """Tension at the pulled end of a strip round a roll of 20 mm over that at the other end, in steady sliding."""
    radius, per_quarter, straight, pull = 20.0, 24, 6, 4.0
    thickness, angle = 0.1, 0.5 * np.pi * quarter_turns
    middle, step = radius + 0.5 * thickness, 0.5 * np.pi * (radius + 0.05) / per_quarter
    turn = np.linspace(0.0, angle, per_quarter * quarter_turns + 1)
    arc = middle * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    before = arc[0] - step * np.arange(straight, 0, -1)[:, None] * [0.0, 1.0]
    after = arc[-1] + step * np.arange(1, straight + 1)[:, None] * [-np.sin(angle), np.cos(angle)]
    line = np.concatenate([before, arc, after])
    n = len(line)
    points = np.concatenate([np.column_stack([line, np.full(n, z)]) for z in (0.0, 2.0)])
    first = np.arange(n - 1)
    cells = np.stack([first, first + 1, first + 1 + n, first + n], axis=1)
    law = mises(poisson=0.0)
    strip = ExplicitShells(points, cells, thickness, law, DENSITY, axis=(0, 0, 1), options=elastic_options())
    wall = SweptProfile((radius, radius), radius, np.array([[0.0, 50.0, 0.0, -50.0, 0.0, 0.0, 0.0]]))
    roll = strip.add_tool("roll", make_surface(wall), mu=mu)
    strip.scale_mass(3.0 * strip.dt)
    strip.fix(np.arange(2 * n), "wpq")
    ends = [0, n], [n - 1, 2 * n - 1]
    force = np.zeros((2 * n, 6))
    force[ends[0], 1] = -0.5 * pull
    strip.force = force
    damping, cycles = 2e4, 8000
    strip.advance(cycles, force_scale=0.5 - 0.5 * np.cos(np.pi * np.arange(cycles) / cycles), damping=damping)
    speed = 150.0
    for node in ends[1]:
        strip.fix([node], "u", -speed * np.sin(angle))
        strip.fix([node], "v", speed * np.cos(angle))
    strip.advance(cycles, velocity_scale=0.5 - 0.5 * np.cos(np.pi * np.arange(cycles) / cycles))
    tensions = []
    for _ in range(100):
        strip.advance(100)
        along = strip.internal_force[ends[1], :2].sum(axis=0)
        tensions.append(along @ [-np.sin(angle), np.cos(angle)])
    assert roll.penetration < 0.02 * thickness
    assert abs(strip.energies().error_percent) < 1.0
    return float(np.mean(tensions)) / pull


@pytest.mark.parametrize(("mu", "quarter_turns"), [(0.1, 2), (0.2, 1)])
def test_rope_around_a_roll(mu: float, quarter_turns: int) -> None:
    """Euler and Eytelwein: exp(mu angle), within 1 %; without friction the same strip gives 1.00."""
    assert capstan(mu, quarter_turns) == pytest.approx(np.exp(mu * 0.5 * np.pi * quarter_turns), rel=0.01)


def dome() -> tuple[ExplicitShells, RigidTool]:
    """Sheet of 60 x 60 mm clamped at its rim over a hemispherical punch of 20 mm, which rises by 12 mm."""
    points, cells = grid(24, 24, 60.0, 60.0)
    points[:, :2] -= 30.0
    sheet = ExplicitShells(points, cells, THICKNESS, SWIFT, DENSITY)
    tool = draw_hemispherical_punch(20.0, 40.0)
    turned = tool.segments.copy()  # metal below: heights change sign, and with them the way along the profile
    turned[:, [0, 1, 2, 3]] = tool.segments[:, [2, 3, 0, 1]]
    turned[:, [1, 3, 5]] *= -1.0
    punch = sheet.add_tool(
        "punch", make_surface(SweptProfile(tool.half_widths, tool.corner_radius, turned[::-1])), mu=0.1
    )
    punch.position = [0.0, 0.0, -0.5 * THICKNESS]
    rim = np.flatnonzero(np.abs(points[:, :2]).max(axis=1) > 29.9)
    sheet.fix(rim, "uvwpqr")
    punch.follow([0, 0, 1], SmoothStroke(12.0, 3e-3, rise=0.3))
    sheet.advance(int(3e-3 / sheet.dt) + 1)
    return sheet, punch


def test_dome_over_a_hemispherical_punch() -> None:
    """Height, symmetry, volume, fit to the punch, thinning, force and energy."""
    sheet, punch = dome()
    x = sheet.position
    np.testing.assert_allclose(punch.position, [0.0, 0.0, 12.0 - 0.5 * THICKNESS], atol=1e-9)
    pole = 12 * 25 + 12
    # 1. the pole rides on the punch: half its thickness over it
    assert x[pole, 2] == pytest.approx(12.0 - 0.5 * THICKNESS + 0.5 * sheet.thickness[12 * 24 + 12], abs=0.02)
    assert 0.0 < punch.penetration < 0.02 * THICKNESS
    # 2. symmetry about the diagonal and both axes
    height = x[:, 2].reshape(25, 25)
    for other in (height.T, height[::-1], height[:, ::-1]):
        np.testing.assert_allclose(height, other, atol=0.02)
    # 3. volume: area times thickness
    _, cells = grid(24, 24, 60.0, 60.0)
    corners = x[cells]
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]), axis=1)
    assert (area * sheet.thickness).sum() == pytest.approx(60.0 * 60.0 * THICKNESS, rel=2e-3)
    assert sheet.thickness.min() < 0.92 * THICKNESS
    # 4. nodes that are pressed lie on the offset sphere; forces balance
    force = sheet.contact_force
    pressed = np.linalg.norm(force, axis=1) > 0.0
    assert pressed.sum() > 20
    centre = punch.position - [0.0, 0.0, 20.0]
    nodal = np.zeros(len(x))
    for corner in cells.T:
        np.add.at(nodal, corner, sheet.thickness)
    nodal /= np.bincount(cells.ravel())
    off = np.linalg.norm(x[pressed] - centre, axis=1) - 20.0 - 0.5 * nodal[pressed]
    assert off.min() > -0.02 * THICKNESS
    assert off.max() < 1e-3
    np.testing.assert_allclose(force.sum(axis=0), -punch.force, atol=1e-6)
    assert abs(sheet.energies().error_percent) < 1.0


@pytest.mark.parametrize(("penalty", "damping"), [(0.2, 0.0), (0.2, 0.5)])
def test_the_largest_penalty_keeps_the_step_stable(penalty: float, damping: float) -> None:
    """A sheet of uneven mesh shaken between two tools closer than its thickness gains no energy in 4000 cycles."""
    points, cells = grid(8, 8, 8.0, 8.0, distort=0.25)
    options = replace(elastic_options(), ironing=False)  # with it the springs of the thickness take the penalty's place
    sheet = ExplicitShells(points, cells, THICKNESS, mises(), DENSITY, options=options)
    for name, up in (("die", True), ("holder", False)):
        tool = sheet.add_tool(name, flat(up), mu=0.1, penalty=penalty, damping=damping)
        tool.position = [0.0, 0.0, (-1 if up else 1) * 0.495 * THICKNESS]
    start = np.zeros((len(points), 6))
    start[:, :3] = np.random.default_rng(5).normal(0.0, 3000.0, (len(points), 3))
    sheet.velocity = start
    sheet.advance(1)
    first = sheet.energies()
    sheet.advance(4000)
    last = sheet.energies()
    total = [e.kinetic + e.internal + e.hourglass + e.contact for e in (first, last)]
    assert total[1] < 1.01 * total[0]
    assert abs(last.error_percent) < 3.0


def floor_and_wall(size: float) -> _core.ToolSurface:
    """Plane z = 0 from x = -30 to 20 mm and a wall there, 10 mm high, in triangles of a size [mm]."""
    floor, wall = np.arange(-30.0, 20.0, size), np.arange(0.0, 10.0, size)
    line = np.concatenate([np.column_stack([floor, 0 * floor]), np.column_stack([0 * wall + 20.0, wall])])
    across, n = np.arange(-10.0, 21.0, size), len(line)
    points = np.concatenate([np.column_stack([line[:, 0], 0 * line[:, 0] + y, line[:, 1]]) for y in across])
    a = (np.arange(n - 1)[None, :] + n * np.arange(len(across) - 1)[:, None]).ravel()
    halves = np.column_stack([a, a + 1, a + n + 1]), np.column_stack([a, a + n + 1, a + n])
    return _core.ToolSurface.triangles(points, np.concatenate(halves).astype(np.int32))


@pytest.mark.parametrize("size", [0.5, 5.0])
def test_a_sheet_that_slides_into_a_wall_of_its_die_comes_back(size: float) -> None:
    """Half its thickness before the wall, within 1 % of the thickness; with its speed, within 1 %."""
    sheet = block()
    sheet.add_tool("die", floor_and_wall(size), damping=0.0)
    load(sheet, 0.0, 20.0)
    press(sheet)
    moving = sheet.velocity
    moving[:, 0] += 3000.0
    sheet.velocity = moving
    farthest = 0.0
    for _ in range(320):
        sheet.advance(100)
        farthest = max(farthest, sheet.position[:, 0].max())
    assert 20.0 - 0.5 * THICKNESS < farthest < 20.0 - 0.49 * THICKNESS
    assert sheet.velocity[:, 0].mean() == pytest.approx(-3000.0, rel=0.01)
    assert abs(sheet.energies().error_percent) < 1.0


def knife(radius: float, triangles: bool) -> _core.ToolSurface:
    """Bar along y with its top at z = 0: 40 triangles around, or an arc and walls."""
    if not triangles:
        arc, wall = [-radius, 0.0, 0.0, -radius, -radius, -radius, -1.0], [0.0, -radius, 0.0, -50.0, 0.0, 0.0, 0.0]
        return _core.ToolSurface.swept((radius, np.inf), 0.0, np.array([arc, wall]))
    turn = np.linspace(0.0, 2.0 * np.pi, 41)[:-1]
    ring = radius * np.column_stack([np.sin(turn), 0.0 * turn, np.cos(turn)]) - [0.0, 0.0, radius]
    points = np.concatenate([ring + np.array([0.0, y, 0.0]) for y in (-20.0, 20.0)])
    at = np.arange(40)
    after = (at + 1) % 40
    around = np.concatenate([np.column_stack([at, after, at + 40]), np.column_stack([after, after + 40, at + 40])])
    return _core.ToolSurface.triangles(points, around.astype(np.int32))


def strip_over_knife(
    at: float, *, triangles: bool = False, radius: float = 1.0, height: float = 0.0, **grip: object
) -> tuple[ExplicitShells, RigidTool]:
    """Elastic strip of seven shells, 4 mm wide; the knife lies a part `at` of the way along the fourth."""
    points, cells = grid(7, 1, 28.0, 4.0)
    points[:, 0] -= 12.0 + 4.0 * at
    points[:, 2] = 0.5 * THICKNESS + height
    strip = ExplicitShells(points, cells, THICKNESS, mises(), DENSITY, options=elastic_options())
    return strip, strip.add_tool("knife", knife(radius, triangles), **grip)  # type: ignore[arg-type]


@pytest.mark.parametrize("triangles", [False, True])
@pytest.mark.parametrize("at", [0.1, 0.3, 0.5])
def test_force_on_an_edge_goes_to_its_nodes_by_the_lever_rule(at: float, triangles: bool) -> None:
    """4 N on a strip that cannot tilt: the nodes of both its edges over the knife get 2 (1 - at) and 2 at, in 0.1 %."""
    strip, tool = strip_over_knife(at, triangles=triangles)
    load(strip, 0.0, 4.0)
    strip.fix(np.arange(16), "q")
    press(strip, 1500)
    strip.advance(1000, damping=2e4)
    lift = strip.contact_force[:, 2].reshape(2, 8)
    expected = np.zeros((2, 8))
    expected[:, 3:5] = 2.0 * (1.0 - at), 2.0 * at
    np.testing.assert_allclose(lift, expected, atol=2e-3)
    assert 0.0 < tool.penetration < 1e-3


def test_nodes_alone_let_a_knife_through() -> None:
    deepest = {}
    for edges in (False, True):
        strip, _ = strip_over_knife(0.5, edges=edges)
        load(strip, 0.0, 8.0)
        strip.advance(600, damping=2e4)
        deepest[edges] = 0.5 * THICKNESS - float(strip.position[[3, 4], 2].mean())
    assert deepest[False] > 0.1
    assert deepest[True] < 0.01


@pytest.mark.parametrize("at", [0.25, 0.5])
def test_a_strip_bounces_off_a_knife_without_loss(at: float) -> None:
    """Thrown at 2 m/s without damping and friction: its energy is there when it has left, in 0.2 % of it."""
    strip, tool = strip_over_knife(at, height=0.05, damping=0.0)
    start = np.zeros((16, 6))
    start[:, 2] = -2000.0
    strip.velocity = start
    before, touched = 0.5 * strip.mass[:, 0].sum() * 2000.0**2, 0.0
    for _ in range(200):
        strip.advance(20)
        touched = max(touched, -tool.force[2])
    assert touched > 10.0
    assert tool.force[2] == 0.0
    energy = strip.energies()
    assert energy.contact < 1.5e-5 * before  # the work of pressure on the thickness, followed every 8 cycles
    assert energy.kinetic + energy.internal + energy.hourglass == pytest.approx(before, rel=2e-3)


def test_a_strip_drawn_over_a_knife_feels_coulomb_friction() -> None:
    """Pressed by 4 N and drawn along by two shells: friction is mu N on the mean, 1 %, from edge to edge and node to
    node; the pull's work is lost in friction."""
    mu, speed = 0.2, 1000.0
    strip, tool = strip_over_knife(0.5, mu=mu)
    load(strip, 0.0, 4.0)
    strip.fix(np.arange(16), "q")
    press(strip, 1500)
    strip.advance(500, damping=2e4)
    strip.fix(np.arange(16), "u", speed)
    strip.advance(1000, velocity_scale=np.linspace(0.0, 1.0, 1000), damping=2e4)
    begin, forces = strip.position[0, 0], []
    while strip.position[0, 0] < begin + 6.0:
        strip.advance(10, damping=2e4)
        forces.append(tool.force.copy())
    mean = np.mean(forces, axis=0)
    assert mean[2] == pytest.approx(-4.0, rel=0.01)
    assert mean[0] == pytest.approx(mu * 4.0, rel=0.01)
    assert abs(strip.energies(damping=2e4).error_percent) < 1.0


if __name__ == "__main__":
    for mu in (0.0, 0.1, 0.2):
        print(f"capstan, mu = {mu}:", *(f"{capstan(mu, n) / np.exp(mu * 0.5 * np.pi * n):.4f}" for n in (1, 2)))
