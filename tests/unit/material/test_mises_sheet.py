# SPDX-License-Identifier: Apache-2.0
"""The one equation of von Mises in plane stress against the four of any yield function, which the tangent asks for."""

import numpy as np
import pytest

from presswork import _core
from tests.problems.sheet_paths import VON_MISES

RATES = {
    "none": {},
    "cowper_symonds": {"D": 40.0, "q": 5.0},
    "johnson_cook": {"C": 0.05, "reference_rate": 1.0},
    "logarithmic": {"C": 0.05, "reference_rate": 1.0},
}
SOFT = {"start": 800.0, "reference": 650.0, "melting": 1480.0, "exponent": 0.8, "heating": 0.0}
HARDENING = {"linear": [200.0, 500.0], "voce": [130.0, 330.0, 8.0], "swift": [500.0, 1e-3, 0.2]}


def make_law(rate: str, hardening: str, **options: object) -> _core.SheetLaw:
    kind = _core.HardeningLaw[hardening]
    given = {"rate": _core.RateLaw[rate], "rate_parameters": RATES[rate], **options}
    return _core.SheetLaw(150e3, 0.3, VON_MISES, kind, HARDENING[hardening], **given)


@pytest.mark.parametrize("packed", [True, False])
@pytest.mark.parametrize("soft", [None, SOFT])
@pytest.mark.parametrize("hardening", HARDENING)
@pytest.mark.parametrize("rate", RATES)
def test_stress_and_strain_are_those_of_the_general_return_mapping(rate, hardening, soft, packed) -> None:
    law = make_law(rate, hardening, thermal=_core.Thermal(**soft) if soft else None)
    rng, n = np.random.default_rng(5), 400
    strain = 10.0 ** rng.uniform(-7, -1, (n, 1)) * rng.standard_normal((n, 3))
    stress, history = 60 * rng.standard_normal((n, 3)), rng.uniform(0, 0.5, (n, 1))
    given = {"dt": 1e-4, "temperature": rng.uniform(400, 1300, n), "packed": packed}
    one, four = (law.update(strain, stress, history, tangent=asked, **given) for asked in (False, True))
    assert not one[4].any()
    assert not four[4].any()
    flows = four[1][:, 0] > history[:, 0]
    assert 50 < flows.sum() < n
    scale = np.abs(four[0]).max(axis=1, keepdims=True)
    assert np.abs((one[0] - four[0]) / scale).max() < 1e-8
    assert one[1] == pytest.approx(four[1], rel=1e-9, abs=1e-12)
    assert one[2] == pytest.approx(four[2], rel=1e-8, abs=1e-12)


def test_strain_that_is_no_number_fails_alone() -> None:
    law = make_law("johnson_cook", "voce", thermal=_core.Thermal(**SOFT))
    strain = np.full((9, 3), 0.01)
    strain[4] = np.nan
    stress, _, _, _, failed = law.update(strain, np.zeros((9, 3)), np.zeros((9, 1)), dt=1e-4, tangent=False)
    assert list(np.flatnonzero(failed)) == [4]
    assert np.isfinite(stress).all()
