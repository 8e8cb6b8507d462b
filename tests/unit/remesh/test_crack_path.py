# SPDX-License-Identifier: Apache-2.0
"""Where cracks begin, which way they go, and where they end, in damage that is given."""

import numpy as np
import pytest

from presswork.geometry.polygon import list_sides
from presswork.remesh.crack_faces import part_faces
from presswork.remesh.crack_path import CrackPath, DamagedSection
from presswork.remesh.fill import close_loops

LENGTH = 0.2
GRID = np.stack(np.meshgrid(np.arange(0.025, 4.0, 0.05), np.arange(0.025, 2.0, 0.05), indexing="ij"), -1).reshape(-1, 2)
BOX = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]])


def section(ridge, peak, *, tips=None, is_open=(True, True, True, True), gains=None):
    """Damage that falls off a ridge y(x), or x = const where ridge is None, and reaches `peak` on it."""
    ratio = peak * np.exp(-((ridge(GRID) / 0.15) ** 2))
    found = DamagedSection(GRID, ratio, ratio if gains is None else gains, LENGTH, 1.0)
    found.see(list_sides(BOX), np.array(is_open), tips or {})
    return found


def slanted(places):
    return (places[:, 0] - 1.0 - 0.5 * places[:, 1]) / np.hypot(1.0, 0.5)


def test_a_crack_follows_the_ridge_from_surface_to_surface():
    path = section(slanted, 1.5).find_new(np.zeros((0, 2)))
    assert path is not None
    assert path.ends_outside
    assert not path.begins_inside
    assert {round(float(y), 6) for y in path.points[[0, -1], 1]} == {0.0, 2.0}
    assert np.abs(slanted(path.points)).max() < 0.08


def test_nothing_cracks_below_the_critical_value_or_where_damage_no_longer_grows():
    assert section(slanted, 0.95).find_new(np.zeros((0, 2))) is None
    assert section(slanted, 1.5, gains=np.full(len(GRID), 0.01)).find_new(np.zeros((0, 2))) is None


def test_a_crack_stops_where_the_metal_is_sound():
    def half(places):
        return np.where(places[:, 1] < 1.0, slanted(places), 10.0)

    path = section(half, 1.5).find_new(np.zeros((0, 2)))
    assert path is not None
    assert not path.ends_outside
    assert 0.8 < path.points[-1, 1] < 1.2


def test_a_crack_that_begins_inside_has_two_tips():
    def middle(places):
        return np.hypot(slanted(places), np.maximum(np.abs(places[:, 1] - 1.0) - 0.4, 0.0))

    path = section(middle, 1.5).find_new(np.zeros((0, 2)))
    assert isinstance(path, CrackPath)
    assert path.begins_inside
    assert not path.ends_outside
    assert sorted(path.points[[0, -1], 1]) == pytest.approx([0.6, 1.4], abs=0.15)


def test_a_crack_begins_at_no_plane_of_symmetry():
    def left(places):
        return np.hypot(places[:, 0], places[:, 1] - 1.0)

    free = section(left, 2.0).find_new(np.zeros((0, 2)))
    held = section(left, 2.0, is_open=(True, True, True, False)).find_new(np.zeros((0, 2)))
    assert free is not None
    assert not free.begins_inside
    assert held is None or held.begins_inside


def test_two_cracks_meet_at_their_tips():
    tip = np.array([1.75, 1.5])
    path = section(slanted, 1.5, tips={7: tip}).grow(np.array([1.25, 0.5]), np.array([0.4, 0.9]) / np.hypot(0.4, 0.9))
    assert path is not None
    assert path.met == 7
    assert path.points[-1] == pytest.approx(tip)


def test_no_crack_begins_beside_another():
    ridge = np.column_stack([1.0 + 0.5 * np.linspace(0, 2, 40), np.linspace(0, 2, 40)])
    assert section(slanted, 1.5).find_new(ridge) is None


def test_faces_that_cross_are_parted_and_a_gap_stays():
    """A block of 2 mm x 0.4 mm with a slit from x = 2 to 0.5, 0.01 wide, whose lower face then rises by 0.02."""
    x = np.linspace(0.5, 2.0, 16)
    low, high = (np.column_stack([x, np.full(16, y)]) for y in (0.195, 0.205))
    line = np.concatenate([[[0.0, 0.0], [2.0, 0.0]], low[::-1], [[0.45, 0.2]], high, [[2.0, 0.4], [0.0, 0.4]]])
    after, everything = close_loops([len(line)]), np.ones(len(line), dtype=bool)
    assert part_faces(line, after, everything, []) == pytest.approx(line)
    crossed = line.copy()
    crossed[3:17, 1] += 0.02
    free = everything.copy()
    free[[0, 1, 2, -3, -2, -1]] = False
    parted = part_faces(crossed, after, free, [])
    assert parted[3:16, 1].max() < parted[21:34, 1].min()
    above = np.array([[3.0, 0.21, -1.0, 0.21, 0.0, 0.0, 0.0]])  # a tool just above the slit
    assert parted[free, 1].max() == pytest.approx(0.213)
    assert part_faces(crossed, after, free, [above])[free, 1].max() == pytest.approx(0.21)
