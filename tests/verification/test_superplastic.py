# SPDX-License-Identifier: Apache-2.0
"""Sheets that gas forms at a held strain rate, against the membrane: domes and channels."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.problems.bulges import RADIUS, THICKNESS
from tests.problems.superplastic import RATE, K, find_time, make_channel, make_dome, read_dome
from tests.regression.whole_runs import run_stamping

HIGHEST = 0.83671, 66.78
"""Largest p b/(stress t0) of a channel, and half its angle there [degrees]: (2/sqrt 3) sin^2 a/a."""


def test_a_channel_is_blown_at_a_constant_rate(tmp_path: Path) -> None:
    """Rate within 0.2 %, largest pressure within 0.5 % at its angle within a degree, wall of half a circle 2/pi."""
    history = run_stamping(make_channel(0.5), tmp_path / "out").history
    height, p = (
        history["pressure.oil.height"] / RADIUS,
        history["pressure.oil.p"] * RADIUS / (K * RATE**0.5 * THICKNESS),
    )
    led = height > 0.1
    np.testing.assert_allclose(history["pressure.oil.strain_rate"][led], RATE, rtol=0.002)
    assert p.max() == pytest.approx(HIGHEST[0], rel=0.005)
    assert 2.0 * np.rad2deg(np.arctan(height[p.argmax()])) == pytest.approx(HIGHEST[1], abs=1.0)
    wall = np.interp(1.0, height, history["pressure.oil.thickness"] / THICKNESS)
    assert wall == pytest.approx(2.0 / np.pi, rel=0.005)
    assert abs(history["energy_error_percent"][-1]) < 0.5


@pytest.mark.validation
def test_a_channel_under_a_constant_pressure_takes_the_time_of_the_membrane(tmp_path: Path) -> None:
    """Half a circle within 0.5 %: a target that is never reached leaves the pressure at its upper limit."""
    m, p = 0.5, 0.02
    case = make_channel(m, target=0.02, most=p)
    case["stages"][0]["duration"] = 700
    case["implicit"] = {"min_increment": 1e-9, "initial_increment": 1e-7}
    history = run_stamping(case, tmp_path / "out").history
    angle = np.linspace(1e-4, 0.5 * np.pi, 20001)
    strain = 2.0 / np.sqrt(3.0) * np.log(angle / np.sin(angle))
    expected = find_time(strain, 2.0 / np.sqrt(3.0) * np.sin(angle) ** 2 / angle, m)
    expected *= (K * THICKNESS / (p * RADIUS)) ** (1.0 / m)
    found = np.interp(RADIUS, history["pressure.oil.height"], history["time"])
    assert found == pytest.approx(expected, rel=0.005)


@pytest.mark.validation
@pytest.mark.parametrize(
    ("m", "size", "pole", "near"),
    [(0.3, 2.5, 0.2410, 0.01), (0.5, 3.5, 0.3205, 0.004), (0.75, 3.5, 0.3715, 0.004), (1.0, 3.5, 0.3974, 0.004)],
)
def test_a_dome_is_blown_at_a_constant_rate(tmp_path: Path, m: float, size: float, pole: float, near: float) -> None:
    """Pole of the hemisphere, and pressures on the way within 1 % (own integration of the membrane)."""
    history = run_stamping(make_dome(m, size), tmp_path / "out").history
    height, p = history["pressure.oil.height"] / RADIUS, history["pressure.oil.p"] * RADIUS / (K * RATE**m * THICKNESS)
    assert np.interp(1.0, height, history["pressure.oil.thickness"] / THICKNESS) == pytest.approx(pole, rel=near)
    table = read_dome(m)
    rows = table[:, 0] > 0.2
    np.testing.assert_allclose(np.interp(table[rows, 0], height, p), table[rows, 1], rtol=0.01)
    assert p.max() == pytest.approx(table[:, 1].max(), rel=0.003)


def test_the_time_of_a_dome_under_a_constant_pressure_lies_between_two_theories() -> None:
    """m = 0.5: (K t0/(p a))^2 times 0.934 by the table; 11/12 by Jovane, 0.95 by Hill."""
    table = np.vstack([(0.0, 0.0, 1.0), read_dome(0.5)])
    assert 11.0 / 12.0 < find_time(-np.log(table[:, 2]), table[:, 1], 0.5) < 0.95
