# SPDX-License-Identifier: Apache-2.0
"""Kinematics of rams against their closed forms."""

import itertools
import math

import numpy as np
import pytest

from presswork.model import Crank, Drive, SpeedTable

RATIOS = [0.0, 0.1, 0.3, 0.9]


def height(angle: float, radius: float, ratio: float) -> float:
    """Return the exact slider-crank distance from bottom dead centre [mm], by the triangle of crank and rod."""
    if ratio == 0.0:
        return radius * (1.0 - math.cos(angle))
    rod = radius / ratio
    return radius + rod - radius * math.cos(angle) - math.sqrt(rod**2 - (radius * math.sin(angle)) ** 2)


@pytest.mark.parametrize("ratio", RATIOS)
def test_crank_follows_the_slider_crank_formula(ratio: float) -> None:
    radius, speed = 100.0, 2.0 * math.pi * 60 / 60.0
    for degrees in (180.0, 120.0, 60.0, 20.0, 1.0, 0.01):
        angle = math.radians(degrees)
        crank = Crank(radius, ratio, speed, height(angle, radius, ratio))
        assert crank.height_at(angle) == pytest.approx(height(angle, radius, ratio), rel=1e-12, abs=1e-9)
        # rounding of the height itself: near the dead centres a small change of it is a large one of the angle
        assert crank.angle_at(0.0) == pytest.approx(angle, rel=1e-6, abs=1e-6)
        h = 1e-5
        rate = (height(angle + h, radius, ratio) - height(angle - h, radius, ratio)) / (2 * h)
        assert crank.speed_at(0.0) == pytest.approx(speed * rate, rel=1e-5, abs=1e-4)


@pytest.mark.parametrize("ratio", RATIOS)
def test_way_and_time_of_a_crank_are_inverse(ratio: float) -> None:
    crank = Crank(100.0, ratio, 2.0 * math.pi, 60.0)
    for way in (0.0, 10.0, 35.0, 59.9, 60.0):
        assert crank.travel_at(crank.time_at(way)) == pytest.approx(way, abs=1e-9)
    assert crank.speed_at(60.0) == 0.0
    assert crank.travel_at(10.0) == 60.0, "it stays at bottom dead centre"


def test_crank_with_an_infinite_rod_takes_the_time_of_a_cosine() -> None:
    crank = Crank(100.0, 0.0, 2.0 * math.pi, 20.0)
    assert crank.time_at(20.0) == pytest.approx(math.acos(0.8) / (2.0 * math.pi), rel=1e-14)


def test_speed_table_takes_the_integral_of_the_way_over_the_speed() -> None:
    table = SpeedTable(np.array([[0.0, 100.0], [10.0, 100.0], [20.0, 25.0]]))
    assert table.time_at(5.0) == 0.05
    assert table.time_at(20.0) == pytest.approx(0.1 + math.log(4.0) / 7.5, rel=1e-14)  # ds/(100 - 7.5 s)
    assert table.time_at(30.0) - table.time_at(20.0) == pytest.approx(10.0 / 25.0, rel=1e-14)
    for way in (0.0, 3.0, 10.0, 14.0, 20.0, 27.0):
        assert table.travel_at(table.time_at(way)) == pytest.approx(way, abs=1e-12)


def test_parts_of_the_way_add_up_to_the_time_of_the_stage() -> None:
    drive = Drive(Crank(50.0, 0.2, 7.0, 40.0), 25.0)
    parts = np.linspace(0.0, 1.0, 8)
    times = [drive.time_between(a, b) for a, b in itertools.pairwise(parts)]
    assert sum(times) == pytest.approx(drive.duration, rel=1e-13)
    assert drive.part_at(0.5 * drive.duration) > 0.5, "the ram slows down towards bottom dead centre"
