# SPDX-License-Identifier: Apache-2.0
"""Explicit shells that touch shells: momentum, bounce, friction and pressing against closed forms; the same bits."""

import numpy as np
import pytest

from presswork import _core
from presswork.explicit.input_checks import ExplicitError
from presswork.explicit.shells import ExplicitShells
from tests.problems.explicit_shells import DENSITY, grid, mises, triangles
from tests.problems.stacked_plates import THICKNESS, stack_explicit


def momentum(sheet: ExplicitShells) -> tuple[np.ndarray, np.ndarray]:
    """Linear and angular momentum, without that of rotary inertia."""
    mass, v = sheet.mass[:, :1], sheet.velocity[:, :3]
    return (mass * v).sum(axis=0), np.cross(sheet.position, mass * v).sum(axis=0)


@pytest.mark.parametrize("mu", [0.0, 0.2])
def test_colliding_plates_keep_momentum_and_energy(mu: float) -> None:
    """Free plates of unlike meshes strike aslant: momentum is kept to rounding, energy within 0.1 %."""
    sheet, n = stack_explicit(tilt=0.002)
    sheet.touch_itself(mu=mu)
    v = np.zeros((len(sheet.position), 6))
    v[n:, :3] = [800.0, 0.0, -3000.0]
    sheet.velocity = v
    before, _ = momentum(sheet)
    mass = sheet.mass[:, 0]
    sheet.advance(1500)
    after, _ = momentum(sheet)
    assert after == pytest.approx(before, rel=1e-10, abs=1e-12 * np.abs(before).max())
    assert abs(sheet.shell_contact_force.sum(axis=0)).max() <= 1e-9 * max(abs(sheet.shell_contact_force).max(), 1.0)
    lifted = (mass[n:] @ sheet.velocity[n:, 2]) / mass[n:].sum()
    assert lifted > (mass[:n] @ sheet.velocity[:n, 2]) / mass[:n].sum(), "they have parted"
    assert abs(sheet.energies().error_percent) < 0.1
    if mu == 0.0:
        drift = mass[n:] @ sheet.velocity[n:, 0] / mass[n:].sum()
        assert drift == pytest.approx(800.0, rel=0.02), "without friction only tilted faces push aside"


def test_plates_pressed_together_are_a_thickness_apart() -> None:
    """A load of 20 N on a plate that lies on a still one: the springs' give, N/k per node, is all that it sinks in."""
    sheet, n = stack_explicit(aside=0.0)
    sheet.touch_itself()
    sheet.fix(np.arange(n), "uvwpqr")
    share = sheet.mass[n:, 0] / sheet.mass[n:, 0].sum()
    force = np.zeros((len(sheet.position), 6))
    force[n:, 2] = -20.0 * share
    sheet.force = force
    sheet.advance(3000, force_scale=np.minimum(np.arange(3000) / 1000, 1.0), damping=2e4)
    sheet.advance(3000, damping=2e4)
    assert sheet.shell_contact_force[n:, 2].sum() == pytest.approx(20.0, rel=1e-3)
    depth = THICKNESS - sheet.position[n:, 2]
    assert depth.min() > 0.0
    assert depth.max() < 2e-3 * THICKNESS
    assert sheet.find_overlap()[0] == pytest.approx(depth.max(), rel=0.3)


def test_plate_sliding_on_a_plate_stops_where_friction_says() -> None:
    """v^2/(2 mu N/m): within 1 %."""
    mu, down, speed = 0.15, 20.0, 2000.0
    sheet, n = stack_explicit(lower=12, aside=0.0)
    sheet.touch_itself(mu=mu)
    sheet.fix(np.arange(n), "uvwpqr")
    mass = sheet.mass[n:, 0]
    force = np.zeros((len(sheet.position), 6))
    force[n:, 2] = -down * mass / mass.sum()
    sheet.force = force
    sheet.advance(3000, force_scale=np.minimum(np.arange(3000) / 1000, 1.0), damping=2e4)
    v = sheet.velocity
    v[n:] = 0.0
    v[n:, 0] = speed
    start = (mass @ sheet.position[n:, 0]) / mass.sum()
    sheet.velocity = v
    expected = speed**2 / (2.0 * mu * down / mass.sum())
    time = 2.0 * expected / speed
    sheet.advance(int(1.3 * time / sheet.dt))
    gone = (mass @ sheet.position[n:, 0]) / mass.sum() - start
    assert gone == pytest.approx(expected, rel=0.01)


def strip(n: int = 40, *, three: bool = False) -> ExplicitShells:
    """Strip of 40 x 3 mm, of quadrilaterals or of triangles."""
    points, cells = grid(n, 3, 40.0, 3.0)
    return ExplicitShells(
        points, triangles(cells) if three else cells, THICKNESS, mises("swift", (565.0, 0.007, 0.26)), DENSITY
    )


@pytest.mark.parametrize("three", [False, True], ids=["quadrilaterals", "triangles"])
def test_strip_folded_by_moments_stays_out_of_itself(three: bool) -> None:
    """Legs turned towards each other until they lie on each other: the gap between mid-surfaces is the thickness."""
    sheet = strip(three=three)
    sheet.touch_itself(mu=0.1)
    x = sheet.start[:, 0]
    left, right = np.flatnonzero(x <= 18.0 + 1e-9), np.flatnonzero(x >= 26.0 - 1e-9)
    sheet.fix(left, "uvwpqr")
    # 1. the right leg swings round as a rigid body, until the legs are nearly parallel
    pivot, time, steps = np.array([22.0, 0.0, 1.3]), 4e-4, 40
    arm = sheet.start[right] - np.array([22.0, 0.0, 0.0])
    for angle in 0.985 * np.pi * np.arange(1, steps + 1) / steps:
        c, s, part = np.cos(angle), np.sin(angle), angle / (0.985 * np.pi)
        there = part * pivot * [0, 0, 1] + [22.0, 0.0, 0.0] + arm @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
        speed = (there - sheet.position[right]) / (time / steps)
        for letter, values in zip("uw", speed[:, [0, 2]].T, strict=True):
            sheet.fix(right, letter, values)
        sheet.fix(right, "q", -0.985 * np.pi / time)
        sheet.run_to(time * part)
    # 2. it is pressed down on the other
    sheet.release()
    sheet.fix(left, "uvwpqr")
    v = sheet.velocity
    v[right] = 0.0
    sheet.velocity = v
    force = np.zeros((len(x), 6))
    force[right, 2] = -300.0 / len(right)
    sheet.force = force
    sheet.run_to(time + 6e-4, damping=1e4)
    height = sheet.position[right[x[right] > 34.0], 2]
    assert height == pytest.approx(sheet.thickness.mean(), rel=0.015)
    assert height.min() > 0.99 * sheet.thickness.min()
    assert sheet.find_overlap()[0] < 0.01 * THICKNESS
    assert abs(sheet.energies().error_percent) < 0.1


def run_collision(cycles: int) -> ExplicitShells:
    """Return the collision with friction after so many cycles."""
    sheet, n = stack_explicit(lower=40, upper=26, tilt=0.002)
    sheet.touch_itself(mu=0.2)
    v = np.zeros((len(sheet.position), 6))
    v[n:, :3] = [800.0, 0.0, -3000.0]
    sheet.velocity = v
    sheet.advance(cycles)
    return sheet


def test_dump_goes_on_with_the_same_bits() -> None:
    """400 cycles at once, and 250 and 150 with a dump between, while the plates touch."""
    whole, half = run_collision(400), run_collision(250)
    dump = half.dump()
    again = run_collision(10)
    again.restore(dump)
    again.advance(150)
    assert np.abs(whole.shell_contact_force).max() > 0
    for name, values in whole.dump().items():
        assert np.array_equal(values, again.dump()[name]), name


def test_refusals() -> None:
    """Second contact, friction below zero, a stiffness beyond the stable step."""
    sheet, _ = stack_explicit()
    for bad in ({"mu": -0.1}, {"penalty": 0.5}, {"damping": 2.0}, {"undeformed": sheet.start[:-1]}):
        with pytest.raises(ExplicitError):
            sheet.touch_itself(**bad)
    sheet.touch_itself()
    with pytest.raises(ExplicitError, match="already"):
        sheet.touch_itself()


def test_sheet_that_starts_in_itself_is_refused() -> None:
    """A plate whose mid-surface lies 0.1 mm over another's, both 0.8 mm thick."""
    points, cells = grid(4, 4, 8.0, 8.0)
    above = points + np.array([0.1, 0.1, 0.1])
    both = np.concatenate([points, above])
    sheet = ExplicitShells(both, np.concatenate([cells, cells + len(points)]), THICKNESS, mises(), DENSITY)
    with pytest.raises(ExplicitError, match=r"0\.7 mm deep in shell"):
        sheet.touch_itself()


@pytest.mark.parametrize("threads", [2, 3])
def test_any_number_of_threads_gives_the_same_bits(threads: int) -> None:
    """2,276 shells, enough for several threads, while the plates touch."""
    before = _core.max_threads()
    try:
        _core.set_threads(1)
        one = run_collision(300).dump()
        _core.set_threads(threads)
        many = run_collision(300).dump()
    finally:
        _core.set_threads(before)
    assert np.abs(one["shell_contact.touching"]).max() > 0
    for name, values in one.items():
        assert np.array_equal(values, many[name]), name
