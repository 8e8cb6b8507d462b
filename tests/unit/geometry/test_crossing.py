# SPDX-License-Identifier: Apache-2.0
"""A profile that crosses or touches itself is found, one that does not is left alone."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.case import ProfilePoint
from presswork.case.tools.profile import draw_outline
from presswork.geometry.crossing import bound_segments, find_crossing
from presswork.model import FloatArray


def draw(*points: tuple[float, float] | ProfilePoint, closed: bool = False) -> FloatArray:
    return draw_outline([p if isinstance(p, ProfilePoint) else ProfilePoint(to=p) for p in points], closed).segments


HALF = ProfilePoint(to=(0, 2), centre=(0, 0), turn="left")
CROSSING = {
    "two lines": (draw((0, 0), (4, 0), (4, 4), (2, -2)), (0, 2), (8 / 3, 0)),
    "bow tie": (draw((0, 0), (4, 4), (4, 0), (0, 4), closed=True), (1, 3), (2, 2)),
    "end on a line": (draw((0, 0), (4, 0), (4, 4), (2, 4), (2, 0)), (0, 3), (2, 0)),
    "folded back": (draw((0, 0), (4, 0), (2, 0)), (0, 1), (2, 0)),
    "line and arc": (draw((0, -2), HALF, (5, 2), (5, 0), (1, 0)), (0, 3), (2, 0)),
    "line tangent to an arc": (draw((0, -2), HALF, (0, 5), (2, 5), (2, -5)), (0, 3), (2, 0)),
    "neighbours": (draw((0, -2), HALF, (3, -1)), (0, 1), (2, 0)),
}


@pytest.mark.parametrize("name", CROSSING)
def test_crossings_and_touches_are_found(name: str) -> None:
    segments, pieces, point = CROSSING[name]
    crossing = find_crossing(segments)
    assert crossing is not None
    assert (crossing.first, crossing.second) == pieces
    if name not in ("line and arc", "neighbours"):
        np.testing.assert_allclose(crossing.point, point, atol=1e-9)


@pytest.mark.parametrize(
    "segments",
    [
        draw((0, 0), (4, 0), (4, 4), (0, 4), closed=True),
        draw((0, 0), (4, 0), (4, 4), (0, 4), (0, 0)),
        draw((10, -20), ProfilePoint(to=(10, 0), radius=1), (50, 0)),
        draw((0, -2), HALF, (0, 5), (2.001, 5), (2.001, -5)),
        draw((2, 0), ProfilePoint(to=(-2, 0), centre=(0, 0), turn="left"), (-1, 0), (1, 0)),
    ],
)
def test_plain_profiles_are_left_alone(segments: FloatArray) -> None:
    assert find_crossing(segments) is None


def test_bounds_hold_the_bulge_of_an_arc() -> None:
    low, high = bound_segments(draw((0, -2), HALF))
    np.testing.assert_allclose([low, high], [[0, -2], [2, 2]], atol=1e-12)
