# SPDX-License-Identifier: Apache-2.0
"""Angles and curl radius of a hat's wall, from sections drawn with known ones."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.post import springback
from presswork.post.section import SheetSection


def hat(bottom: float, flange: float, radius: float | None) -> SheetSection:
    """Bottom, wall of 50 mm and flange with these angles [degree] between them; radius of the wall, None for straight.

    The angles are those at the ends of the wall.
    """
    pieces = 60
    length = np.full(pieces, 50.0 / pieces)
    start = np.radians(180.0 - bottom)
    turn = 0.0 if radius is None else 50.0 / radius
    wall = start + turn * (np.arange(pieces) + 0.5) / pieces
    leaving = start + turn - np.radians(180.0 - flange)
    angle = np.concatenate([np.zeros(20), wall, np.full(20, leaving)])
    steps = np.concatenate([np.full(20, 1.0), length, np.full(20, 1.0)])
    ends = np.vstack([[0, 0], np.cumsum(steps[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]), axis=0)])
    line = np.stack([ends[:-1], ends[1:]], axis=1)
    return SheetSection(np.arange(len(line), dtype=float), line, np.arange(len(line), dtype=np.int32))


@pytest.fixture
def measure(monkeypatch: pytest.MonkeyPatch):
    """Measure a pair of sections as those of the steps 0 and 1."""

    def run(formed: SheetSection, free: SheetSection) -> springback.SectionSpringback:
        monkeypatch.setattr(springback, "find_formed_step", lambda result, step: 0)
        monkeypatch.setattr(springback, "cut_sheet", lambda result, angle, step, start: (formed, free)[step])
        return springback.measure_springback(None, 0.0, 1)  # type: ignore[arg-type]

    return run


def test_a_straight_wall_that_opens(measure) -> None:
    ((formed, free),) = measure(hat(90, 90, None), hat(104, 77, None)).walls
    assert (formed.bottom_angle, formed.flange_angle) == (pytest.approx(90), pytest.approx(90))
    assert (free.bottom_angle, free.flange_angle) == (pytest.approx(104), pytest.approx(77))
    assert np.isinf(free.curl_radius)


def test_a_curled_wall_has_the_radius_of_its_arc(measure) -> None:
    ((_, free),) = measure(hat(90, 90, None), hat(100, 80, 130.0)).walls
    assert free.curl_radius == pytest.approx(130.0, rel=1e-3)
    sixth = np.degrees(50.0 / 130.0) / 6  # half of the third over which an angle is measured
    assert free.bottom_angle == pytest.approx(100 - sixth, abs=1e-6)
    assert free.flange_angle == pytest.approx(80 + sixth, abs=1e-6)


def test_a_wall_whose_points_lie_to_both_sides_of_its_middle_is_nearly_straight(measure) -> None:
    """Five points of a low wall of a drawn pan, 16 mm high, off a line by 0.1 mm; a parabola has 1647 mm."""
    wall = np.array([[80.38, -22.34], [80.54, -18.28], [80.53, -14.22], [80.33, -10.18], [80.62, -6.13]])
    line = np.concatenate([[[0.0, -22.34]], wall, [[120.0, -6.13]]])
    section = SheetSection(np.arange(6.0), np.stack([line[:-1], line[1:]], axis=1), np.arange(6, dtype=np.int32))
    ((_, free),) = measure(section, section).walls
    assert free.curl_radius == pytest.approx(1647.0, rel=0.01)


def test_a_dome_has_no_wall(measure) -> None:
    flat = hat(150, 150, None)
    assert measure(flat, flat).walls == ()
