# SPDX-License-Identifier: Apache-2.0
"""Stretching over a hemispherical punch on a fine mesh: the two procedures, the defaults, and solids beside shells."""

from __future__ import annotations

import numpy as np
import pytest

from tests.problems.punch_stretching import stretch_solids
from validation.hemispherical_punch import PUBLISHED, beside_solids, differences, explicit, implicit, travel_at_forces

pytestmark = pytest.mark.validation
STRAINS = ("thickness_strain", "radial_strain")


@pytest.mark.parametrize("mu", [0.0, 0.15])
@pytest.mark.parametrize("strain", STRAINS)
def test_explicit_comes_to_the_implicit_profile(mu: float, strain: str) -> None:
    """Within 1 % of the largest strain everywhere at 3 m/s and below; the force within 0.6 %."""
    assert max(differences(explicit(mu, 3), implicit(mu), strain)) < 1.0
    assert explicit(mu, 3).force == pytest.approx(implicit(mu).force, rel=6e-3)


def test_inertia_shows_at_the_pole_when_the_punch_is_fast() -> None:
    """At 10 m/s the difference there is more than twice that at 3 m/s."""
    fast, slow = (differences(explicit(0.0, v), implicit(0.0), "thickness_strain")[0] for v in (10, 3))
    assert fast > 2 * slow


def test_defaults_of_the_implicit_procedure_are_a_little_softer() -> None:
    """Within 2.5 % of the largest thickness strain, most of it where the sheet sinks into the die's shoulder."""
    off = differences(implicit(0.0, fine=False), implicit(0.0), "thickness_strain")
    assert 0.5 < max(off) < 2.5


def test_solids_stretch_more_on_the_punch_because_its_pressure_helps_them_to_flow() -> None:
    """Plane stress leaves that out: 3 % of the strain there at t/R = 1/51, below 1 % at a quarter of the thickness."""
    thick = beside_solids(implicit(0.0), stretch_solids(0.0))
    thin = beside_solids(implicit(0.0, thickness=0.25), stretch_solids(0.0, 0.25, 480))
    for zone in (0, 1):
        assert -4.0 < thick[zone] < -2.0
        assert abs(thin[zone]) < 1.2
    assert implicit(0.0).force == pytest.approx(stretch_solids(0.0).force, rel=6e-3)


@pytest.fixture(scope="module")
def travel() -> np.ndarray:
    return travel_at_forces()


def test_travel_without_friction_is_the_published_one(travel: np.ndarray) -> None:
    """Up to 60 kN, within 5 % of the figures quoted by code_aster's SSNV501A, which asks 10 % of itself."""
    np.testing.assert_allclose(travel[:-1], PUBLISHED[:-1], rtol=0.05)


@pytest.mark.xfail(
    strict=True, reason="5.05 %, and 5.00 at half the speed: near the largest force, where travel says little"
)
def test_travel_at_70_kn_is_the_published_one(travel: np.ndarray) -> None:
    np.testing.assert_allclose(travel[-1], PUBLISHED[-1], rtol=0.05)
