# SPDX-License-Identifier: Apache-2.0
"""Into how many steps a span of time is divided."""

import numpy as np
import pytest

from presswork.explicit.dynamics import LONGER, count_even_steps


@pytest.mark.parametrize("span", [0.3, 1.0, 26.1, 1e5])
def test_no_step_is_longer_than_allowed_and_few_are_more_than_needed(span: float) -> None:
    for before in (0.5, 1.0, 2.0):
        n = count_even_steps(span, 1.0, before)
        assert span / n <= 1.0 + 1e-9
        assert n <= np.ceil(span / (1.0 - LONGER))


def test_a_step_stays_while_the_bound_of_a_vibrating_body_swings() -> None:
    """A tenth of a per cent to either side of a whole number of steps."""
    span, before, counts = 28.0, 1.0, []
    for row in range(100):
        n = count_even_steps(span, 1.0 + 1e-3 * np.sin(row), before)
        before = span / n
        counts.append(n)
    assert set(counts[10:]) == {29}


def test_what_is_left_of_a_span_is_divided_by_the_same_step() -> None:
    n = count_even_steps(26.1, 1.0, 1.0)
    step = 26.1 / n
    assert count_even_steps(26.1 - 10 * step, 1.0, step) == n - 10
