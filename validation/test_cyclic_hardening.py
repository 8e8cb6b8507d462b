# SPDX-License-Identifier: Apache-2.0
"""A measured reversal against laws that are fitted to its first part."""

import pytest

from presswork.material.cyclic_laws import CYCLIC_LAWS
from validation.cyclic_hardening import YOUNG, fit, read_test

pytestmark = pytest.mark.validation
LARGEST = 302.2
KINEMATIC = [law for law in CYCLIC_LAWS if law != "isotropic"]


def test_both_branches_begin_with_the_modulus_of_aluminium() -> None:
    assert read_test().slopes == pytest.approx((YOUNG, YOUNG), rel=0.03)


@pytest.mark.parametrize("law", KINEMATIC)
def test_kinematic_laws_of_half_of_the_reversal_predict_the_rest(law: str) -> None:
    assert fit(law, 1.3).find_error(fitted=False) < 0.055 * LARGEST
    assert fit(law, 1.5).find_error(fitted=False) < 0.025 * LARGEST


def test_isotropic_hardening_does_not() -> None:
    assert fit("isotropic", 1.5).find_error(fitted=False) > 0.07 * LARGEST


def test_the_stagnation_of_yoshida_and_uemori_is_not_determined_early() -> None:
    assert "h" in fit("yoshida_uemori", 1.3).loose
    assert "h" not in fit("yoshida_uemori", 2.0).loose


def test_a_tenth_of_the_reversal_determines_no_law() -> None:
    assert min(fit(law, 1.1).find_error(fitted=False) for law in CYCLIC_LAWS) > 0.09 * LARGEST


def test_yoshida_and_uemori_fit_the_whole_test_best() -> None:
    errors = {law: fit(law, 2.0).find_error(fitted=True) for law in CYCLIC_LAWS}
    assert min(errors, key=lambda law: errors[law]) == "yoshida_uemori"
    assert errors["yoshida_uemori"] < 0.012 * LARGEST
    assert errors["isotropic"] > 0.06 * LARGEST
