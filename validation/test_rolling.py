# SPDX-License-Identifier: Apache-2.0
"""Strip rolling against the slab theories, which know no elastic arcs and no redundant work."""

import pytest

from validation import rolling

pytestmark = pytest.mark.validation


@pytest.mark.parametrize(("reduction", "mu"), rolling.PASSES)
def test_roll_force_and_torque_are_those_of_the_slab_theory(reduction, mu) -> None:
    """Force 5 to 8 % above (a longer arc of contact, shearing within the strip), torque within 3 %."""
    found, slab = rolling.roll(reduction, mu), rolling.theory(reduction, mu, orowan=False)
    assert 1.0 < found.force / slab.force < 1.09
    assert found.torque == pytest.approx(slab.torque, rel=0.03)
    assert found.spread < 0.02


@pytest.mark.parametrize(("reduction", "mu"), rolling.PASSES)
def test_the_neutral_point_moves_as_in_the_slab_theory(reduction, mu) -> None:
    found, slab = rolling.roll(reduction, mu), rolling.theory(reduction, mu, orowan=False)
    assert found.neutral == pytest.approx(rolling.RADIUS * slab.neutral_angle, rel=0.16)


def test_more_friction_moves_the_neutral_point_back_and_raises_the_forward_slip() -> None:
    passes = [rolling.roll(0.2, mu) for mu in (0.12, 0.15, 0.2)]
    assert passes[0].neutral < passes[1].neutral < passes[2].neutral
    assert passes[0].forward_slip < passes[1].forward_slip < passes[2].forward_slip
