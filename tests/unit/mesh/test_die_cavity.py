# SPDX-License-Identifier: Apache-2.0
"""The wall of a die's cavity in space, and what a workpiece leaves open of it."""

import numpy as np
import pytest

from presswork.mesh.make.die_cavity import find_cavity

DOWN = np.array([0.0, 0.0, -1.0])


def make_die(*, land: float = 0.5, spacing: float = 0.5, start: float = -12.0):
    """A die over a square grid: a pocket 12 mm wide with a floor at 4 mm and walls of 45 degrees, a land, a gutter."""
    line = np.arange(start, 12.0 + 1e-9, spacing)
    x, y = np.meshgrid(line, line, indexing="ij")
    outside = np.maximum(np.abs(x), np.abs(y)) - 6.0
    height = np.clip(land - outside, land, 4.0)
    height = np.where(outside > 3.0, land + np.minimum(outside - 3.0, 1.0), height)
    n = len(line)
    points = np.stack([x, y, height], axis=-1).reshape(-1, 3)
    first = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    one, two = np.column_stack([first, first + n + 1, first + n]), np.column_stack([first, first + 1, first + n + 1])
    return points, np.concatenate([one, two]).astype(np.int32)


def test_the_wall_lies_within_the_land():
    wall = find_cavity(*make_die(), DOWN, np.zeros(3))
    floor, walls = 5.0**2, (12.0**2 - 5.0**2) * np.sqrt(2.0)
    assert wall.area.sum() == pytest.approx(floor + walls, rel=0.005)
    assert np.abs(wall.places[:, :2]).max() < 6.0
    assert np.ptp(wall.land[:, 2]) < 1e-12
    assert wall.land[0, 2] == 0.5


def test_a_quarter_that_ends_at_symmetry_planes_has_a_quarter_of_the_wall():
    whole = find_cavity(*make_die(), DOWN, np.zeros(3))
    planes = [(0, 0.0, 1.0), (1, 0.0, 1.0)]
    quarter = find_cavity(*make_die(start=0.0), DOWN, np.zeros(3), planes)
    over = find_cavity(*make_die(start=-1.0), DOWN, np.zeros(3), planes)
    assert quarter.area.sum() == pytest.approx(0.25 * whole.area.sum(), rel=0.005)
    assert over.area.sum() == pytest.approx(quarter.area.sum(), rel=1e-9)


def test_a_die_that_no_land_closes_has_no_cavity():
    assert find_cavity(*make_die(start=0.0), DOWN, np.zeros(3)) is None
    assert find_cavity(*make_die(), -DOWN, np.array([0.0, 0.0, 5.0])) is None


def test_long_facets_are_divided():
    fine, coarse = (find_cavity(*make_die(spacing=s), DOWN, np.zeros(3)) for s in (0.5, 1.0))
    assert coarse.area.sum() == pytest.approx(fine.area.sum(), rel=0.02)
    assert coarse.area.max() < 0.1
