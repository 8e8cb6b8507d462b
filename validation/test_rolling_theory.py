# SPDX-License-Identifier: Apache-2.0
"""The slab theory of rolling against its closed forms, and against its own balance of forces."""

from __future__ import annotations

import numpy as np
import pytest

from validation.rolling_theory import RollGap, bland_ford, inhomogeneity, mean_pressure_force, roll_by_slab

pytestmark = pytest.mark.validation


def rigid(_: float) -> float:
    return 400.0


def gap(**changes) -> RollGap:
    return RollGap(**{"radius": 150.0, "entry": 2.0, "exit_": 1.6, "mu": 0.1, "flow_stress": rigid, **changes})


def hardening(strain: float) -> float:
    """Flow stress with which 2k h stays constant: then Bland & Ford's neglect of (s/2k - 1) d(2k h)/dphi is exact."""
    return 400.0 * float(np.exp(0.5 * np.sqrt(3.0) * strain))


@pytest.mark.parametrize("mu", [0.08, 0.1, 0.15])
@pytest.mark.parametrize("exit_", [1.8, 1.6])
def test_slab_integration_is_bland_and_fords_closed_form_where_that_is_exact(mu, exit_):
    """But for their small angles (bite 0.037 and 0.052), for which they take the force for the pressure's integral."""
    pass_ = gap(mu=mu, exit_=exit_, flow_stress=hardening, m=10.0)
    exact, closed = roll_by_slab(pass_), bland_ford(pass_)
    assert 150.0 * np.trapezoid(exact.pressure, exact.phi) == pytest.approx(closed.force, rel=2e-3)
    assert exact.force == pytest.approx(closed.force, rel=5e-3)
    assert exact.neutral_angle == pytest.approx(closed.neutral_angle, rel=2e-3)
    assert exact.torque == pytest.approx(closed.torque, rel=5e-3)
    np.testing.assert_allclose(exact.pressure.max(), closed.pressure.max(), rtol=3e-3)


@pytest.mark.parametrize("mu", [0.08, 0.1, 0.15])
def test_without_hardening_bland_and_ford_are_a_few_percent_off(mu):
    """Their neglect then costs 2 % of the force and 5 % of the neutral angle."""
    exact, closed = roll_by_slab(gap(mu=mu)), bland_ford(gap(mu=mu))
    assert exact.force == pytest.approx(closed.force, rel=0.02)
    assert closed.neutral_angle < exact.neutral_angle < 1.06 * closed.neutral_angle


def test_simple_estimate_is_near():
    assert mean_pressure_force(gap()) == pytest.approx(bland_ford(gap()).force, rel=0.1)


@pytest.mark.parametrize("orowan", [False, True])
def test_horizontal_forces_of_the_roll_balance_without_tension(orowan):
    """int s sin(phi) dphi = int tau cos(phi) dphi over the arc: the roll alone must not push the strip."""
    rolled = roll_by_slab(gap(), orowan=orowan, points=4001)
    push = np.trapezoid(rolled.pressure * np.sin(rolled.phi), rolled.phi)
    pull = np.trapezoid(rolled.friction * np.cos(rolled.phi), rolled.phi)
    assert pull == pytest.approx(push, rel=5e-3)


def test_front_tension_moves_the_neutral_point_to_the_entry_and_lowers_the_force():
    free, drawn = roll_by_slab(gap()), roll_by_slab(gap(front_tension=60.0))
    assert drawn.neutral_angle > free.neutral_angle
    assert drawn.force < free.force
    assert drawn.torque < free.torque
    closed = bland_ford(gap(front_tension=60.0))
    assert drawn.neutral_angle == pytest.approx(closed.neutral_angle, rel=0.06)


def test_sticking_friction_caps_the_pressure_hill():
    """With m k below mu s the hill is lower; with much mu the answer no longer depends on it."""
    rough = roll_by_slab(gap(mu=0.4))
    assert rough.force < roll_by_slab(gap(mu=0.4, m=1e3)).force
    assert roll_by_slab(gap(mu=2.0)).force == pytest.approx(roll_by_slab(gap(mu=4.0)).force, rel=1e-6)
    assert np.abs(rough.friction).max() <= 400 / np.sqrt(3) * (1 + 1e-9)


def test_orowans_field_lowers_the_force():
    """By nothing without friction, by up to pi/4 of 2k where it sticks."""
    assert inhomogeneity(0.0) == 1.0
    assert inhomogeneity(1.0) == pytest.approx(np.pi / 4)
    t = (np.arange(100000) + 0.5) / 100000
    assert inhomogeneity(0.6) == pytest.approx(np.sqrt(1 - (0.6 * t) ** 2).mean(), abs=1e-9)
    for mu, drop in ((0.1, 0.02), (0.4, 0.25)):
        plain, lower = roll_by_slab(gap(mu=mu)), roll_by_slab(gap(mu=mu), orowan=True)
        assert 0 < 1 - lower.force / plain.force < drop


def test_draft_beyond_friction_is_refused():
    """Largest draft mu^2 R: 1.5 mm at mu = 0.1; the strip slips well before, where the neutral point leaves the arc."""
    with pytest.raises(ValueError, match="no neutral point"):
        roll_by_slab(gap(mu=0.02))
