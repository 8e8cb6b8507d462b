# SPDX-License-Identifier: Apache-2.0
"""Where a line runs beside a sheet, against what a drawing says."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.geometry.polygon import list_sides
from presswork.mesh.beside import find_beside

WHOLE = (False, False)


def rectangle(x: float, y: float, centre: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    """The corners of a rectangle of these sides."""
    return np.array([[-x, -y], [x, -y], [x, y], [-x, y]]) / 2.0 + centre


def test_a_line_in_the_sheet_is_nowhere_beside_it() -> None:
    assert find_beside(list_sides(rectangle(10, 8)), rectangle(9, 7), WHOLE) is None
    assert find_beside(list_sides(rectangle(10, 8)), rectangle(10, 7), WHOLE) is None  # on its edge


def test_what_runs_beside_is_measured() -> None:
    """A line 12 long and 6 wide about a sheet of 10 x 8: two ends of 6 + 2 x 1 mm are beside it, by 1 mm."""
    found = find_beside(list_sides(rectangle(10, 8)), rectangle(12, 6), WHOLE)
    assert found is not None
    assert found.depth == pytest.approx(1.0, abs=1e-9)
    assert abs(found.place[0]) == pytest.approx(6.0)
    assert found.length == pytest.approx(16.0, rel=0.02)
    assert found.whole == pytest.approx(36.0, rel=0.02)


@pytest.mark.parametrize("cut", [(True, False), (False, True), (True, True)])
def test_what_symmetry_planes_cut_away_is_not_beside(cut: tuple[bool, bool]) -> None:
    half = rectangle(10, 8)
    for axis, is_cut in enumerate(cut):
        half[:, axis] = np.maximum(half[:, axis], 0.0) if is_cut else half[:, axis]
    assert find_beside(list_sides(half), rectangle(9, 7), cut) is None
    found = find_beside(list_sides(half), rectangle(9, 9), cut)
    assert found is not None
    assert found.depth == pytest.approx(0.5, abs=1e-9)
    assert found.whole == pytest.approx(36.0 / 2 ** sum(cut), rel=0.02)


@pytest.mark.parametrize("signs", [(-1, 1), (1, -1), (-1, -1)])
def test_a_part_that_was_turned_over_lies_on_the_other_side_of_its_planes(signs: tuple[int, int]) -> None:
    quarter = np.maximum(rectangle(10, 8), 0.0) * signs
    assert find_beside(list_sides(quarter), rectangle(9, 7), (True, True)) is None
    found = find_beside(list_sides(quarter), rectangle(9, 9), (True, True))
    assert found is not None
    assert found.whole == pytest.approx(9.0, rel=0.02)


def test_a_notch_over_the_edge_is_beside_the_sheet() -> None:
    found = find_beside(list_sides(rectangle(10, 8)), rectangle(4, 4, (5.0, 0.0)), WHOLE)
    assert found is not None
    assert found.depth == pytest.approx(2.0, abs=1e-9)
