# SPDX-License-Identifier: Apache-2.0
"""New boundary lines."""

from dataclasses import replace

import numpy as np
import pytest

from presswork.geometry.polygon import list_sides
from presswork.geometry.profile_path import ProfilePath
from presswork.mesh.checks import MeshError
from presswork.remesh.boundary import OldLine, find_folds, resample
from presswork.remesh.volume import enclosed_volume, restore_volume

FLAT = np.array([[60, 10, -5, 10, 0, 0, 0.0]])


def barrel(n):
    """The quarter section of an upset billet under a flat tool at y = 10: its side is a parabola."""
    y = np.linspace(0, 10, n)
    bottom = np.stack([np.linspace(0, 10, n)[:-1], np.zeros(n - 1)], axis=1)
    side = np.stack([10 + 0.08 * y * (10 - y), y], axis=1)
    top = np.stack([np.linspace(10, 0, n)[1:], np.full(n - 1, 10.0)], axis=1)
    left = np.stack([np.zeros(n - 2), np.linspace(10, 0, n)[1:-1]], axis=1)
    return np.concatenate([bottom, side, top, left])


def old_line(points, *, on_tool=None, profiles=(FLAT,), ring=True):
    held = np.abs(points[:, 1] - 10) < 1e-12 if on_tool is None else on_tool
    planes = np.stack([points[:, 0] == 0, points[:, 1] == 0], axis=1)
    return OldLine(points, held[None], planes, np.zeros(len(points), dtype=bool), profiles, ring)


def uniform(size):
    return lambda points: np.full(len(points), size)


@pytest.mark.parametrize("ring", [True, False])
def test_volume_planes_corners_and_tool_are_kept(ring):
    points = barrel(12)
    new = resample(old_line(points, ring=ring), uniform(0.6))
    assert enclosed_volume(new.points, ring=ring) == pytest.approx(enclosed_volume(points, ring=ring), rel=1e-12)
    assert len(new.points) % 2 == 0
    for corner in ([0, 0], [10, 0], [0, 10], [10, 10]):
        place = np.flatnonzero((new.points == corner).all(axis=1))
        assert len(place) == 1
        assert place[0] % 2 == 0
    side = (new.points[:, 0] > 0) & (new.points[:, 1] > 0) & (new.points[:, 1] < 10)
    np.testing.assert_array_equal(new.is_free, side)
    assert (new.points[new.place > 34, 0] == 0).all()  # exactly on the axis
    edges = np.linalg.norm(np.roll(new.points, -1, axis=0) - new.points, axis=1)
    assert edges.min() > 0.45
    assert edges.max() < 0.75


def test_free_arc_converges_to_the_curve_that_the_old_nodes_lie_on():
    """Nodes follow the cubic: what is left is the offset that keeps the volume of the old polygon, of second order."""
    errors = []
    for n in (9, 17, 33):
        new = resample(old_line(barrel(n)), uniform(5 / (n - 1)))
        x, y = new.points[new.is_free].T
        errors.append(np.abs(x - 10 - 0.08 * y * (10 - y)).max())
    assert errors[0] < 0.02  # curvature 0.16 / mm, edges of 1.25 mm: a sag of 0.021 mm
    assert errors[1] < errors[0] / 3.5
    assert errors[2] < errors[1] / 3.5


def test_nodes_lie_on_the_arc_of_a_tool_and_its_corner_becomes_one():
    """A punch with a rounded edge and a sharp one, pressed into a block."""
    profile = np.array(
        [
            [8, 20, 8, 10, 0, 0, 0],  # down the sharp side, the metal of the tool on the right
            [8, 10, 3, 10, 0, 0, 0],
            [3, 10, 1, 12, 3, 12, -1],
            [1, 12, 1, 20, 0, 0, 0],
        ],
        dtype=float,
    )
    way = ProfilePath(profile)
    touched = way.at(np.arange(8.0, 18.3, 0.7))  # from 2 above the sharp corner, round both, past the arc
    rest = np.array([[0.0, 14], [0, 7], [0, 0], [5, 0], [10, 0], [10, 7], [10, 14], [8, 14]])
    points = np.concatenate([touched[touched[:, 1] < 13], rest])
    held = np.arange(len(points)) < (touched[:, 1] < 13).sum()
    new = resample(old_line(points, on_tool=held, profiles=(profile,), ring=False), uniform(0.4))
    distance = way.find(new.points)[1]
    on_tool = ~new.is_free & (new.points[:, 0] > 0) & (new.points[:, 1] > 0)
    assert on_tool.sum() > 20
    assert distance[on_tool].max() < 1e-12
    corner = np.flatnonzero(np.linalg.norm(new.points - [8, 10], axis=1) < 1e-12)
    assert len(corner) == 1
    assert corner[0] % 2 == 0
    assert enclosed_volume(new.points, ring=False) == pytest.approx(enclosed_volume(points, ring=False), rel=1e-12)


def test_an_unfilled_inner_corner_of_a_tool_stays_void():
    """The edge across the corner of a cavity is free: no metal appears in the corner."""
    profile = np.array([[10, 0, 10, 10, 0, 0, 0], [10, 10, 0, 10, 0, 0, 0]], dtype=float)
    points = np.array([[0, 0], [5, 0], [10, 0], [10, 4], [10, 8], [8, 10], [4, 10], [0, 10], [0, 5]], dtype=float)
    held = np.array([False, False, True, True, True, True, True, True, False])
    new = resample(old_line(points, on_tool=held, profiles=(profile,), ring=False), uniform(0.5))
    assert enclosed_volume(new.points, ring=False) == pytest.approx(98.0, rel=1e-12)
    assert np.linalg.norm(new.points - 10, axis=1).min() > 1.2


def test_a_line_that_crosses_itself_is_found_and_refused():
    eight = np.array([[0, 0], [4, 4], [4, 0], [0, 4]], dtype=float)
    assert find_folds(list_sides(eight)).tolist() == [[0, 2]]
    assert not len(find_folds(list_sides(barrel(12))))
    points = barrel(12)
    points[16] = [-3.0, 5.0]
    with pytest.raises(MeshError, match="crosses itself"):
        resample(old_line(points), uniform(0.5))


def test_volume_lost_before_is_given_back():
    points = barrel(12)
    new = resample(replace(old_line(points), lost=2e-4), uniform(0.6))
    whole = enclosed_volume(points, ring=True) * (1 + 2e-4)
    assert enclosed_volume(new.points, ring=True) == pytest.approx(whole, rel=1e-12)


def test_free_nodes_that_the_offset_puts_into_a_tool_lie_on_it():
    """A pocket of two nodes 0.01 mm under a flat tool; the offset that gives the volume back is longer."""
    points = barrel(21)
    on_top = points[:, 1] == 10.0
    is_free = ~(on_top | (points[:, 1] == 0.0) | (points[:, 0] == 0.0))
    pocket = np.flatnonzero(on_top & (points[:, 0] > 3.0))[:2]
    points[pocket, 1] -= 0.01
    is_free[pocket] = True
    target = 1.01 * enclosed_volume(points, ring=True)
    new, still_free, offset = restore_volume(points, is_free, target, [FLAT], ring=True)
    assert offset > 0.01
    assert new[:, 1].max() <= 10.0
    assert not still_free[pocket].any()
    assert enclosed_volume(new, ring=True) == pytest.approx(target, rel=1e-12)


def test_a_small_lap_of_the_free_surface_is_closed():
    """Two lips of a notch in the side have met and overlap by 0.02: what they enclose is left out."""
    points = barrel(41)
    side = np.flatnonzero((points[:, 0] >= 10) & (points[:, 1] > 0) & (points[:, 1] < 10))
    middle = side[len(side) // 2]
    notch = points[middle] + [[0, -0.3], [-0.2, 0.01], [-0.5, -0.2], [-0.6, 0], [-0.5, 0.2], [-0.2, -0.01], [0, 0.3]]
    near = np.abs(points[:, 1] - points[middle, 1]) < 0.35
    lapped = np.concatenate([points[:middle][~near[:middle]], notch, points[middle:][~near[middle:]]])
    assert len(find_folds(list_sides(lapped)))
    new = resample(old_line(lapped), uniform(0.15))
    assert not len(find_folds(list_sides(new.points)))
    assert len(new.points) % 2 == 0
    assert new.points[:, 0].min() == 0.0
    for corner in ([0, 0], [10, 0], [0, 10], [10, 10]):
        place = np.flatnonzero((new.points == corner).all(axis=1))
        assert place.tolist()
        assert place[0] % 2 == 0


def test_contact_reaches_half_an_old_edge_beyond_its_last_node():
    """An edge leaves the tool at 8 degrees: finer nodes on its nearer half lie on the tool, those beyond do not."""
    points = np.array([[0, 0], [12, 0], [12, 5], [12, 9.7], [10, 10], [8, 10], [4, 10], [0, 10], [0, 5]], float)
    held = (points[:, 1] == 10) & (points[:, 0] <= 10)
    new = resample(old_line(points, on_tool=held, ring=False), uniform(0.25))
    on_tool = new.points[:, 1] == 10
    assert 10.75 < new.points[on_tool, 0].max() < 11.05
    assert not new.is_free[on_tool].any()
    assert enclosed_volume(new.points, ring=False) == pytest.approx(enclosed_volume(points, ring=False), rel=1e-12)
    steep = points.copy()
    steep[3] = [12, 8.8]
    new = resample(old_line(steep, on_tool=held, ring=False), uniform(0.25))
    assert new.points[new.points[:, 1] == 10, 0].max() == 10.0


def test_a_long_fold_that_has_closed_is_left_out_and_an_open_one_is_not():
    """The lips of a cut 4 mm deep overlap by 0.01 along all of it; of one that holds a wide void they only meet."""
    for width, closes in ((-0.01, True), (1.0, False)):
        points = barrel(41)
        way = np.linspace(0.0, 4.0, 41)[1:]
        half = 0.5 * width * np.clip(way - 1.0, 0.0, 1.0) - 0.01
        upper = np.column_stack([11.9 - way, 5.0 + half])
        lower = np.column_stack([11.9 - way, 5.0 - half])
        side = (points[:, 0] >= 10) & (points[:, 1] > 0) & (points[:, 1] < 10)
        first = int(np.flatnonzero(side & (points[:, 1] < 4.8)).max()) + 1
        last = int(np.flatnonzero(side & (points[:, 1] > 5.2)).min())
        lapped = np.concatenate([points[:first], lower, [[7.6, 5.0]], upper[::-1], points[last:]])
        assert len(find_folds(list_sides(lapped)))
        if not closes:
            with pytest.raises(MeshError, match="crosses itself"):
                resample(old_line(lapped), uniform(0.1))
            continue
        new = resample(old_line(lapped), uniform(0.1))
        assert not len(find_folds(list_sides(new.points)))
        assert len(new.points) % 2 == 0
        assert new.seams[0][0, 0] == pytest.approx(11.9, abs=0.2)
        assert new.seams[0][-1] == pytest.approx([7.6, 5.0], abs=0.1)
        assert np.abs(new.seams[0][:, 1] - 5.0).max() < 0.02
        inside = (np.abs(new.points[:, 1] - 5.0) < 0.1) & (new.points[:, 0] > 1.0) & (new.points[:, 0] < 11.0)
        assert not inside.any()
