# SPDX-License-Identifier: Apache-2.0
"""Stretching over a hemispherical punch: explicit against implicit on the same mesh; validation/ has the full one."""

import numpy as np
import pytest

from tests.problems.punch_stretching import stretch

FINE = ("implicit.contact_stiffness=0.1", "implicit.max_increment=0.01")


@pytest.mark.parametrize("mu", [pytest.param(0.0, marks=pytest.mark.validation), 0.15])
def test_explicit_and_implicit_stretch_alike(mu: float) -> None:
    """Thickness and radial strain of every element within 2 % of the largest, the punch's force within 1 %."""
    explicit, implicit = stretch("explicit", mu), stretch("implicit", mu, 5.0, *FINE)
    assert explicit.kinetic < 1e-4
    for name in ("thickness_strain", "radial_strain"):
        one, other = getattr(explicit, name), getattr(implicit, name)
        assert np.abs(one - other).max() < 0.02 * np.abs(other).max(), name
    assert explicit.force == pytest.approx(implicit.force, rel=0.01)
    assert implicit.thickness_strain.min() < -0.2


def test_fully_integrated_explicit_shells_stretch_like_those_of_one_point() -> None:
    """Thickness strain of every element within 1 % of the largest, force within 0.5 %; no hourglass energy."""
    one, four = stretch("explicit", 0.15), stretch("explicit", 0.15, 5.0, 'explicit.element="shell4_mitc_plus"')
    assert np.abs(one.thickness_strain - four.thickness_strain).max() < 0.01 * np.abs(one.thickness_strain).max()
    assert four.force == pytest.approx(one.force, rel=0.005)


def test_friction_moves_the_thinnest_ring_off_the_pole() -> None:
    """Without friction the sheet is thinnest at the pole, with it some way off."""
    slippery, rough = stretch("explicit", 0.0), stretch("explicit", 0.15)
    assert slippery.radius[np.argmin(slippery.thickness_strain)] < 5.0
    assert 10.0 < rough.radius[np.argmin(rough.thickness_strain)] < 25.0
    assert rough.thickness_strain.min() > slippery.thickness_strain.min()


@pytest.mark.validation
def test_stiffer_contact_holds_the_sheet_nearer_to_the_tools() -> None:
    """The punch meets it earlier, and its force is larger; by less than 1 %."""
    soft = stretch("implicit", 0.0, 5.0, "implicit.contact_stiffness=0.01")
    stiff = stretch("implicit", 0.0, 5.0, *FINE)
    assert soft.force < stiff.force < 1.01 * soft.force
