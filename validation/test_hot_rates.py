# SPDX-License-Identifier: Apache-2.0
"""Hot flow laws on measured tests that they were not fitted to."""

import numpy as np
import pytest

from validation.hot_rates import FIRST, LAWS, SIMULATED, SPLITS, find_errors, simulate

pytestmark = pytest.mark.validation


def mean(split: str, law: str) -> float:
    return float(np.mean(list(find_errors(split, law).values())))


def test_between_the_fitted_tests_hensel_spittel_and_the_table_are_best() -> None:
    assert mean("between", "hensel_spittel") < 0.07
    assert mean("between", "table") < 0.075
    assert mean("between", "johnson_cook") > 0.1


def test_the_table_is_best_where_rates_lie_close() -> None:
    fast = [error for (_, rate), error in find_errors("between", "table").items() if rate >= 1.0]
    assert max(fast) < 0.02


def test_the_sinh_law_alone_extrapolates_to_slower_tests() -> None:
    errors = {law: mean("slower", law) for law in LAWS}
    assert errors.pop("sinh_arrhenius") < 0.11
    assert min(errors.values()) > 0.25


@pytest.mark.parametrize("split", SPLITS)
def test_the_sinh_law_has_one_error_wherever_it_is_used(split: str) -> None:
    assert 0.08 < mean(split, "sinh_arrhenius") < 0.115


@pytest.mark.parametrize(("start", "rate"), SIMULATED)
def test_specimens_with_friction_and_heat_are_predicted(start: float, rate: float) -> None:
    test, stress = simulate(start, rate)
    off = np.abs(stress / test.stress - 1.0)[test.strain >= FIRST]
    assert off.mean() < 0.1
    assert off.max() < 0.2
