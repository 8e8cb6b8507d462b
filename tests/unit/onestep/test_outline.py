# SPDX-License-Identifier: Apache-2.0
"""Outlines of blanks: area, mirror images, nesting."""

import numpy as np
import pytest

from presswork.onestep import BlankOutline, nest

SQUARE = np.array([[0.0, 0.0], [40.0, 0.0], [40.0, 20.0], [0.0, 20.0]])


def circle(radius: float, n: int = 90) -> np.ndarray:
    angle = 2 * np.pi * np.arange(n) / n
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def test_area_takes_holes_off():
    outline = BlankOutline((circle(50.0, 720), circle(10.0, 720)[::-1]))
    assert outline.area == pytest.approx(np.pi * (2500 - 100), rel=2e-4)
    assert outline.extent == pytest.approx((100.0, 100.0))


def test_a_quarter_is_mirrored_to_the_whole():
    angle = np.linspace(0, np.pi / 2, 40)
    arc = 30.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    sides = [[0.0, 20.0], [0.0, 10.0], [0.0, 0.0], [10.0, 0.0], [20.0, 0.0]]
    arc[0, 1] = arc[-1, 0] = 0.0
    for shift in (0, 17, 41):
        quarter = BlankOutline((np.roll(np.concatenate([arc, sides]), shift, axis=0),))
        whole = quarter.mirrored((True, True))
        assert len(whole.loops) == 1
        assert whole.area == pytest.approx(np.pi * 900, rel=1e-3)
        assert len(whole.loops[0]) == 4 * 39


def test_a_hole_beside_the_plane_gets_its_image():
    half = np.array([[0.0, -30.0], [50.0, -30.0], [50.0, 30.0], [0.0, 30.0], [0.0, 0.0]])
    whole = BlankOutline((half, circle(5.0)[::-1] + np.array([25.0, 0.0]))).mirrored((True, False))
    assert len(whole.loops) == 3
    assert whole.area == pytest.approx(100 * 60 - 2 * np.pi * 25, rel=1e-3)


def test_a_rectangle_fills_its_strip():
    found = nest(BlankOutline((SQUARE,)))
    assert found.utilisation == pytest.approx(1.0)
    assert found.angle in (0.0, 90.0)


def test_a_disc_and_a_web():
    found = nest(BlankOutline((circle(50.0, 720),)), web=2.0)
    assert found.utilisation == pytest.approx(np.pi * 2500 / (102 * 104), rel=1e-3)


def test_a_triangle_nests_no_better_than_by_its_widest_height():
    """Shifted along its base by the base's length: half of the strip is waste, whichever side lies on the edge."""
    triangle = np.array([[0.0, 0.0], [30.0, 0.0], [12.0, 25.0]])
    assert nest(BlankOutline((triangle,))).utilisation == pytest.approx(0.5, abs=0.01)
