# SPDX-License-Identifier: Apache-2.0
"""The ring's measures on rings whose flow is known, and Avitzur's curves against the table."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

from presswork.results import ResultError
from presswork.study import integrate_ring, measure_ring

DATA = Path(__file__).parents[2] / "data" / "ring_6_3_2_avitzur.csv"
HEIGHTS = np.linspace(12.0, 6.0, 41)


@dataclass
class Mesh:
    points: np.ndarray


@dataclass
class FlownRing:
    """A ring 36:18:12 that follows R^2 = s + (R_0^2 - s) T_0/T, with a bulge, as a Result shows it."""

    square: float = 100.0
    bulge: float = 0.0
    whole: bool = False
    info: dict = field(default_factory=lambda: {"analysis": "axisymmetric"})
    folder: Path = Path("ring")

    @property
    def times(self):
        return np.arange(len(HEIGHTS))

    @property
    def mesh(self):
        y = np.linspace(-6.0 if self.whole else 0.0, 6.0, 21)
        x, y = np.meshgrid(np.linspace(9, 18, 5), y)
        return Mesh(np.column_stack([x.ravel(), y.ravel()]))

    @property
    def tools(self):
        platens = {"upper": np.array([[0, 6.0, 60, 6, 0, 0, 0]])}
        return {**platens, "lower": np.array([[60, -6.0, 0, -6, 0, 0, 0]])} if self.whole else platens

    def points(self, step):
        x, y = self.mesh.points.T
        ratio = HEIGHTS[step] / HEIGHTS[0]
        r = np.sqrt(self.square + (x**2 - self.square) / ratio)
        return np.column_stack([r + self.bulge * (1 - ratio) * (1 - (y / 6) ** 2), y * ratio])


@pytest.mark.parametrize("whole", [False, True])
def test_ring_measures_of_a_known_flow(whole):
    ring = measure_ring(FlownRing(whole=whole))
    bore = np.sqrt(100 + (81 - 100) * HEIGHTS[0] / HEIGHTS) / 9
    np.testing.assert_allclose(ring.height_reduction, 1 - HEIGHTS / 12)
    np.testing.assert_allclose(ring.bore_mean, bore)
    np.testing.assert_allclose(ring.bore_mid, bore)
    np.testing.assert_allclose(ring.outer_mid, np.sqrt(100 + (18**2 - 100) * HEIGHTS[0] / HEIGHTS) / 18)
    np.testing.assert_allclose(ring.neutral_radius[1:-1], 10.0, rtol=1e-3)
    assert ring.initial_bore == 18


@pytest.mark.parametrize("whole", [False, True])
def test_bulge_shows_at_mid_height_and_by_two_thirds_in_the_mean(whole):
    flat, bulged = measure_ring(FlownRing(whole=whole)), measure_ring(FlownRing(whole=whole, bulge=-1.0))
    assert bulged.bore_mid[-1] - flat.bore_mid[-1] == pytest.approx(-0.5 / 9)
    assert bulged.bore_mean[-1] - flat.bore_mean[-1] == pytest.approx(-0.5 / 9 * 2 / 3, rel=0.01)


def test_frictionless_ring_has_its_neutral_radius_on_the_axis():
    ring = measure_ring(FlownRing(square=0.0))
    assert np.all(ring.neutral_radius[1:-1] < 0.05 * 9)


def test_ring_measures_refuse_what_is_no_ring():
    with pytest.raises(ResultError, match="not a ring"):
        measure_ring(FlownRing(info={"analysis": "plane_strain"}))


def test_avitzur_curves_agree_with_the_table_to_its_digits():
    table = np.loadtxt(DATA, delimiter=",", skiprows=2)
    for m in np.unique(table[:, 0]):
        rows = table[table[:, 0] == m]
        bore, outer = integrate_ring(m, rows[:, 1])
        np.testing.assert_allclose(bore, rows[:, 2], atol=1e-5)
        np.testing.assert_allclose(outer, rows[:, 3], atol=1e-5)


def test_avitzur_bore_is_nan_once_it_has_closed():
    bore, _ = integrate_ring(1.0, [0.5, 0.9])
    assert np.isfinite(bore[0])
    assert np.isnan(bore[1])
