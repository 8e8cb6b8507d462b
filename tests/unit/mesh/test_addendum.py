# SPDX-License-Identifier: Apache-2.0
"""A flange added to a part: its width, its corners, symmetry planes, and what is refused."""

import numpy as np
import pytest

from presswork.mesh import MeshError
from presswork.mesh.make.addendum import widen


def area(points: np.ndarray, quads: np.ndarray) -> float:
    x, y = points[quads, 0], points[quads, 1]
    return 0.5 * float((x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum())


def outline(corners: list[tuple[float, float]], n: int) -> np.ndarray:
    """Return points along a polygon, n on each side, at z = 7."""
    after = [*corners[1:], corners[0]]
    t = np.arange(n)[:, None] / n
    xy = np.concatenate([np.array(a) + t * (np.array(b) - a) for a, b in zip(corners, after, strict=True)])
    return np.column_stack([xy, np.full(len(xy), 7.0)])


def test_a_rectangle_grows_on_all_sides():
    loop = outline([(-20.0, -10.0), (20.0, -10.0), (20.0, 10.0), (-20.0, 10.0)], 8)
    points, quads = widen(loop, np.arange(len(loop)), 6.0, (False, False))
    assert np.ptp(points, axis=0) == pytest.approx([52.0, 32.0, 0.0])
    assert area(points, quads) == pytest.approx(52.0 * 32.0 - 40.0 * 20.0)


def test_a_quarter_grows_along_its_symmetry_planes_alone():
    loop = outline([(0.0, 0.0), (20.0, 0.0), (20.0, 10.0), (0.0, 10.0)], 8)
    points, quads = widen(loop, np.arange(len(loop)), 6.0, (True, True))
    assert points.min(axis=0) == pytest.approx([0.0, 0.0, 7.0])
    assert points.max(axis=0) == pytest.approx([26.0, 16.0, 7.0])
    assert area(points, quads) == pytest.approx(26.0 * 16.0 - 20.0 * 10.0)


def test_an_outline_that_rises_is_refused():
    loop = outline([(-20.0, -10.0), (20.0, -10.0), (20.0, 10.0), (-20.0, 10.0)], 8)
    loop[:, 2] += 0.1 * loop[:, 0]
    with pytest.raises(MeshError, match="outline rises from z = 5 to 9"):
        widen(loop, np.arange(len(loop)), 6.0, (False, False))


def test_a_hollow_outline_takes_a_narrow_flange_only():
    loop = outline(
        [(-20.0, -20.0), (20.0, -20.0), (20.0, 20.0), (2.0, 20.0), (0.0, 0.0), (-2.0, 20.0), (-20.0, 20.0)], 6
    )
    widen(loop, np.arange(len(loop)), 0.2, (False, False))
    with pytest.raises(MeshError, match="overlaps itself near"):
        widen(loop, np.arange(len(loop)), 15.0, (False, False))
