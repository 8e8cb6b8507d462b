# SPDX-License-Identifier: Apache-2.0
"""Values from the points of tetrahedra to those of others."""

import numpy as np
import pytest

from presswork import _core
from presswork.remesh.space.transfer import PointsInSpace, locate_in_tetrahedra
from tests.unit.remesh.space.bodies import mesh_box

SIZE = 0.1


def random_mesh(seed):
    """The unit cube with tetrahedra of about SIZE, whose inner nodes are shaken."""
    random = np.random.default_rng(seed)
    counts = random.integers(9, 12, 3)
    points, cells = mesh_box(counts, (1.0, 1.0, 1.0))
    inner = ((points > 0.0) & (points < 1.0)).all(axis=1)
    points[inner] += SIZE * random.uniform(-0.12, 0.12, (int(inner.sum()), 3))
    return points, cells


def find_middles(mesh):
    return mesh[0][mesh[1]].mean(axis=1)


def carry(old, new, values):
    """Carry values at the middles of the cells of one mesh to those of another."""
    end = find_middles(new)
    points = PointsInSpace(find_middles(old), np.arange(len(old[1])), old[1])
    return points.find_transfer(end, locate_in_tetrahedra(*old, end).cell).apply(values)


def test_twenty_remeshings_keep_a_band_and_linear_states():
    """Across the band the value falls to 1/e within two cells' edges; 0.45 and 3 % are the marks of the plane."""

    def band(points):
        way = np.array([1.0, 0.6, 0.4])
        return np.exp(-(((points @ way - 1.0) / np.linalg.norm(way) / (2 * SIZE)) ** 2))

    mesh = random_mesh(0)
    points = find_middles(mesh)
    slope = np.array([2.0, -3.0, 1.0])
    values = np.stack([band(points), 1 + points @ slope, np.full(len(points), 7.0)], axis=1)
    errors = []
    for seed in range(1, 21):
        other = random_mesh(seed)
        values = carry(mesh, other, values)
        mesh, points = other, find_middles(other)
        errors.append(np.linalg.norm(values[:, 0] - band(points)) / np.linalg.norm(band(points)))
    assert errors[0] < 0.0045
    assert errors[-1] < 0.03
    assert np.abs(values[:, 1] - 1 - points @ slope).max() < 1e-10
    assert np.abs(values[:, 2] - 7).max() < 1e-12


def test_values_do_not_cross_a_slit():
    """Two halves of a cube that share no node, a gap of a tenth of a cell between them, with values 0 and 1."""
    points, cells = mesh_box((8, 8, 8), (1.0, 1.0, 1.0))
    upper = points[:, 2] >= 0.5
    doubled = np.concatenate([points, points[upper] + [0.0, 0.0, 0.01]])
    number = np.arange(len(points))
    number[upper] = len(points) + np.arange(int(upper.sum()))
    is_upper = points[cells].mean(axis=1)[:, 2] > 0.5
    cells = np.where(is_upper[:, None], number[cells], cells)
    middles = doubled[cells].mean(axis=1)
    old = PointsInSpace(middles, np.arange(len(cells)), cells)
    near_slit = np.array([[0.4, 0.4, 0.499], [0.4, 0.4, 0.511]])
    found = old.find_transfer(near_slit, locate_in_tetrahedra(doubled, cells, near_slit).cell)
    values = found.apply(is_upper[:, None].astype(float))
    np.testing.assert_array_equal(values[:, 0], [0.0, 1.0])


def test_cells_near_others_are_those_that_share_a_node_with_a_common_neighbour():
    """By the definition, over sets of nodes."""
    cells = random_mesh(3)[1]
    random = np.random.default_rng(0)
    home, others = random.integers(0, len(cells), 60), random.integers(0, len(cells), (60, 25))
    others[:, 0] = home
    corners = [set(cell) for cell in cells.tolist()]
    reached = [set().union(*(cell for cell in corners if cell & corners[own])) for own in home]
    expected = [[bool(reached[i] & corners[other]) for other in row] for i, row in enumerate(others)]
    found = _core.find_near_cells(*(own.astype(np.int32) for own in (cells, home, others)))
    np.testing.assert_array_equal(found, expected)
    assert 0.02 < np.mean(expected[1:]) < 0.98
    with pytest.raises(ValueError, match="cells must exist"):
        _core.find_near_cells(cells.astype(np.int32), np.array([len(cells)], np.int32), np.zeros((1, 1), np.int32))


def test_points_are_located_and_linear_fields_continued_a_little_beyond():
    points, cells = random_mesh(5)
    wanted = np.random.default_rng(1).uniform(-0.01, 1.01, (500, 3))
    places = locate_in_tetrahedra(points, cells, wanted)
    np.testing.assert_allclose(places.interpolate(points), wanted, atol=1e-12)
    inside = ((wanted > 0.0) & (wanted < 1.0)).all(axis=1)
    assert places.share[inside].min() > -1e-12


def test_peaks_of_single_points_are_found():
    mesh = random_mesh(7)
    middles = find_middles(mesh)
    values = 0.1 + 0.02 * middles[:, 0]
    values[[100, 2000]] += 0.3
    found = PointsInSpace(middles, np.arange(len(middles)), mesh[1]).find_peaks(values)
    assert {100, 2000} <= set(found.tolist())


def test_peaks_are_the_points_above_all_their_donors_that_the_fit_misses():
    mesh = random_mesh(7)
    middles = find_middles(mesh)
    values = np.random.default_rng(3).uniform(0.5, 1.0, len(middles))
    points = PointsInSpace(middles, np.arange(len(middles)), mesh[1])
    fit = points.find_transfer(middles, points.cell_of)
    others = np.where(fit.donor == np.arange(len(middles))[:, None], 0.0, values[fit.donor]).max(axis=1)
    expected = np.flatnonzero((values > others) & (values > fit.apply(values[:, None])[:, 0]))
    np.testing.assert_array_equal(points.find_peaks(values), expected)
    assert 50 < len(expected) < 0.1 * len(middles)


def test_fields_that_are_zero_have_no_peaks():
    points, cells = random_mesh(7)
    middles = find_middles((points, cells))
    assert len(PointsInSpace(middles, np.arange(len(cells)), cells).find_peaks(np.zeros(len(cells)))) == 0
