# SPDX-License-Identifier: Apache-2.0
"""A pushed tool that comes to stand on another: its way, and where its energy goes, in closed form."""

import numpy as np
import pytest

from presswork import _core
from presswork.explicit.shells import ExplicitError, ExplicitShells
from tests.problems.explicit_shells import DENSITY, elastic_options, grid, mises

FACE = _core.ToolSurface.triangles(
    50.0 * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=float),
    np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32),
)
WAY, PUSH = 0.4, 20.0


def build() -> ExplicitShells:
    """A sheet well above two tools, which move along x and never touch it."""
    points, cells = grid(2, 2, 8.0, 8.0)
    sheet = ExplicitShells(points + np.array([0, 0, 9.0]), cells, 0.8, mises(), DENSITY, options=elastic_options())
    sheet.add_tool("holder", FACE)
    sheet.add_tool("die", FACE)
    return sheet


def test_a_pushed_tool_flies_to_its_stop_and_rests_there() -> None:
    """Until then x = F/(2 m) t^2, to the half step by which velocities lag; the work F x is lost where it strikes."""
    sheet = build()
    holder, die = sheet.tools["holder"], sheet.tools["die"]
    die.position = [1.0, 0.0, 0.0]
    holder.push([1, 0, 0], PUSH, stop=(die, WAY - 1.0))
    assert holder.mass is not None
    flight = np.sqrt(2 * WAY * holder.mass / PUSH)
    before = int(0.9 * flight / sheet.dt)
    sheet.advance(before)
    t = before * sheet.dt
    assert holder.position[0] == pytest.approx(0.5 * PUSH / holder.mass * t * (t + sheet.dt), rel=1e-9)
    sheet.advance(before)
    np.testing.assert_allclose(holder.position, [WAY, 0, 0], atol=1e-12)
    assert holder.velocity[0] == pytest.approx(0.0, abs=1e-6)
    energy = sheet.energies()
    assert energy.external == pytest.approx(PUSH * WAY, rel=1e-9)
    assert energy.damping == pytest.approx(PUSH * WAY, rel=1e-9)
    assert abs(energy.error_percent) < 1e-9


@pytest.mark.parametrize("speed", [-300.0, 500.0])
def test_a_pushed_tool_stands_on_one_that_moves(speed: float) -> None:
    sheet = build()
    holder, die = sheet.tools["holder"], sheet.tools["die"]
    holder.push([1, 0, 0], PUSH, stop=(die, WAY))
    die.velocity = [speed, 0.0, 0.0]
    for _ in range(20):
        sheet.advance(200)
    assert holder.position[0] - die.position[0] == pytest.approx(WAY, abs=1e-12)
    assert holder.velocity[0] == pytest.approx(speed, rel=1e-9)
    assert abs(sheet.energies().error_percent) < 1e-6


def test_a_tool_lets_go_of_its_stop_and_is_moved_on() -> None:
    sheet = build()
    holder, die = sheet.tools["holder"], sheet.tools["die"]
    holder.push([1, 0, 0], PUSH, stop=(die, WAY))
    sheet.advance(4000)
    holder.stop()
    holder.velocity = [100.0, 0.0, 0.0]
    sheet.advance(1000)
    assert holder.position[0] == pytest.approx(WAY + 1000 * 100.0 * sheet.dt, rel=1e-9)


def test_a_tool_stands_on_no_pushed_one() -> None:
    sheet = build()
    holder, die = sheet.tools["holder"], sheet.tools["die"]
    die.push([-1, 0, 0], PUSH)
    for other in (die, holder):
        with pytest.raises(ExplicitError, match=r"tool 'holder': stop = .*: name another, which is not pushed"):
            holder.push([1, 0, 0], PUSH, stop=(other, WAY))
        holder.stop()
