# SPDX-License-Identifier: Apache-2.0
"""How far a correction of Newton's method is taken."""

from collections.abc import Callable

import pytest

from presswork.implicit.line_search import ENOUGH, MOST_PARTS, LineSearch


def walk(work: Callable[[float], float]) -> list[float]:
    """Return the parts that are tried until the work along a correction is small enough."""
    search, parts = LineSearch(work(0.0), work(1.0), 1.0), []
    for tried in range(MOST_PARTS):
        if tried and not search.is_closed:
            break
        parts.append(search.find_part())
        if search.note(parts[-1], work(parts[-1])):
            break
    return parts


def test_a_correction_that_leaves_little_work_is_taken_whole() -> None:
    assert not LineSearch(1.0, -0.5, 1.0).has_overshot
    assert LineSearch(1.0, -0.9, 1.0).has_overshot
    assert LineSearch(1.0, 0.9, 1.0).has_overshot


def test_linear_work_vanishes_at_the_first_part() -> None:
    assert walk(lambda part: 1.0 - 3.0 * part) == [pytest.approx(1.0 / 3.0)]


@pytest.mark.parametrize("steep", [5.0, 20.0, 60.0])
def test_work_that_rises_once_metal_yields_back_is_small_at_the_last_part(steep: float) -> None:
    """A tangent of flowing metal, and beyond a fifth of the correction that of metal that unloads: far stiffer."""

    def work(part: float) -> float:
        return 1.0 - part - steep * max(part - 0.2, 0.0)

    parts = walk(work)
    assert 1 <= len(parts) <= MOST_PARTS
    assert abs(work(parts[-1])) <= ENOUGH


def test_a_search_that_is_not_closed_tries_once() -> None:
    assert walk(lambda part: 1.0 + part) == [pytest.approx(0.1)]
