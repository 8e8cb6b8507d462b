# SPDX-License-Identifier: Apache-2.0
"""Values from the points of one mesh to those of another."""

import numpy as np
import pytest

from presswork import _core
from presswork.model import CellBlock, Mesh
from presswork.remesh.carrier import Carrier, Part, SurfacePlaces, place_points
from presswork.remesh.fill import fill_with_quadrilaterals
from presswork.remesh.transfer import OldPoints, find_peak_takers, locate

SIZE = 0.05


def random_mesh(seed):
    """The unit square with cells of about SIZE, whose inner nodes are shaken."""
    random = np.random.default_rng(seed)
    size = SIZE * random.uniform(0.93, 1.07)
    n = 2 * round(0.5 / size)
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    sides = zip(corners, np.roll(corners, -1, axis=0), strict=True)
    line = np.concatenate([a + (np.arange(n) / n)[:, None] * (b - a) for a, b in sides])
    points, cells = fill_with_quadrilaterals(line, lambda p: np.full(len(p), size))
    points[len(line) :] += size * random.uniform(-0.15, 0.15, (len(points) - len(line), 2))
    return points, cells


def to_block(cells, element="quad4_fbar"):
    return CellBlock(element, np.ascontiguousarray(cells, dtype=np.int32), 0)


def place(mesh, element="quad4_fbar"):
    """Integration points of a mesh (n, 2)."""
    points, cells = mesh
    return place_points(to_block(cells, element), points)


def carry(old, new, values, element="quad4_fbar"):
    """Carry values at the integration points of one mesh to those of another, as a run does."""
    edges = np.zeros((0, 2), dtype=np.int32)
    blocks = to_block(old[1], element), to_block(new[1])
    meshes = [Mesh(points, (block,), {}, {}, edges) for (points, _), block in zip((old, new), blocks, strict=True)]
    none = np.zeros(0, dtype=np.intp)
    nowhere = SurfacePlaces(none, none, none, np.zeros(0), none, none)
    part = Part(range(len(old[0])), range(len(new[0])), 0, nowhere)
    given = values.reshape(len(old[1]), -1, values.shape[1])
    rest = np.zeros((len(new[1]), 4, values.shape[1]))
    (found,) = Carrier(meshes[0], old[0], meshes[1], [part]).points([given], [rest])
    return place(new), found.reshape(-1, values.shape[1])


def test_twenty_remeshings_keep_a_band_and_linear_states():
    """Across the band the value falls to 1/e within two cells.

    Marks: 0.45 % after one remeshing and 3.0 % after twenty are what the scheme was chosen by; nearest points lose
    8 % and 29 % here. A constant state stays to the last bit but for round-off, a linear one to 1e-10.
    """

    def band(points):
        return np.exp(-(((points @ [1.0, 0.6] - 0.8) / np.hypot(1, 0.6) / (2 * SIZE)) ** 2))

    mesh = random_mesh(0)
    points = place(mesh)
    values = np.stack([band(points), 1 + points @ [2.0, -3.0], np.full(len(points), 7.0)], axis=1)
    errors = []
    for seed in range(1, 21):
        other = random_mesh(seed)
        points, values = carry(mesh, other, values)
        mesh = other
        exact = band(points)
        errors.append(np.linalg.norm(values[:, 0] - exact) / np.linalg.norm(exact))
    assert errors[0] < 0.0045
    assert errors[-1] < 0.030
    assert np.abs(values[:, 1] - 1 - points @ [2.0, -3.0]).max() < 1e-10
    assert np.abs(values[:, 2] - 7).max() < 1e-12


def test_results_stay_within_the_range_of_the_donors_beside_a_jump():
    mesh, other = random_mesh(3), random_mesh(4)
    start = place(mesh)
    inner = place(other)
    _, found = carry(mesh, other, (start[:, :1] > 0.5).astype(float))
    away = (np.abs(inner - 0.5) < 0.4).all(axis=1)  # near the line the linear fit may reach beyond
    assert found[away].min() > -0.2
    assert found[away].max() < 1.2
    far = np.abs(inner[:, 0] - 0.5) > 4 * SIZE
    np.testing.assert_allclose(found[far, 0], inner[far, 0] > 0.5, atol=1e-12)


def test_values_do_not_cross_a_fold():
    """Two arms 0.02 apart that hang together at their foot only, one cold and one hot."""
    shape = np.array([[0, 0], [2.02, 0], [2.02, 3], [1.02, 3], [1.02, 1], [1.0, 1], [1.0, 3], [0, 3]])

    def mesh(size):
        sides = []
        for a, b in zip(shape, np.roll(shape, -1, axis=0), strict=True):
            n = 2 * max(1, round(np.linalg.norm(b - a) / size / 2))
            sides.append(a + (np.arange(n) / n)[:, None] * (b - a))
        return fill_with_quadrilaterals(np.concatenate(sides), lambda p: np.full(len(p), size))

    old, new = mesh(0.1), mesh(0.085)
    start = place(old)
    end, found = carry(old, new, (start[:, :1] > 1.01).astype(float))
    arms = end[:, 1] > 1.8
    np.testing.assert_allclose(found[arms, 0], end[arms, 0] > 1.01, atol=1e-12)


def carry_with_peaks(old, new, values):
    """Carry one field as carry does; return it at the new points without and with its peaks, and their volumes."""
    start, end = place(old), place(new)
    points = OldPoints(start, np.repeat(np.arange(len(old[1])), 4), old[1])
    fit = points.find_transfer(end, locate(*old, end).cell)
    volume = np.repeat(areas(new) / 4, 4)
    found = fit.apply(values[:, None])[:, 0]
    return found, find_peak_takers(values, points, end, fit).keep(values, found, volume), volume


def test_donors_that_are_kept_follow_fields_on_meshes_that_have_moved():
    """Quadratic fields stay exact however far nodes go together; where nothing has moved, so do all bits."""
    old, new = random_mesh(3), random_mesh(4)
    start, end = place(old), place(new)
    points = OldPoints(start, np.repeat(np.arange(len(old[1])), 4), old[1])
    fit = points.find_transfer(end, locate(*old, end).cell)
    same = points.refit(end, fit)
    assert np.array_equal(same.weight, fit.weight)
    assert np.array_equal(same.linear_weight, fit.linear_weight)
    stretch = np.array([[1.3, 0.4], [-0.2, 0.9]])
    moved = OldPoints(start @ stretch, points.cell_of, points.cells).refit(end @ stretch, fit)
    assert np.array_equal(moved.donor, fit.donor)
    x, y = (start @ stretch).T
    u, v = (end @ stretch).T
    found = (moved.weight * (1.0 + x * y - 2.0 * y**2)[fit.donor]).sum(axis=1)
    assert found == pytest.approx(1.0 + u * v - 2.0 * v**2, abs=1e-8)  # the ridge of the fit leaves 2e-9


def test_donors_are_the_nearest_points_within_four_neighbours():
    """Against the rings themselves, node by node, on two arms that hang together at their foot."""
    cells = np.array(
        [[i, i + 1, 40 + i + 1, 40 + i] for i in range(39)] + [[100 + i, 101 + i, 141 + i, 140 + i] for i in range(39)]
    )
    cells[39, [0, 3]] = cells[0, [0, 3]]
    centres = np.stack([np.concatenate([np.arange(39)] * 2), np.repeat([0.0, 0.1], 39)], axis=1)
    points = OldPoints(centres, np.arange(len(cells)), cells)
    for home in (0, 3, 20, 39, 41):
        reached = {home}
        for _ in range(_core.donor_rings):
            nodes = set(cells[sorted(reached)].ravel().tolist())
            reached = {c for c, corners in enumerate(cells.tolist()) if nodes & set(corners)}
        found = points.find_transfer(centres[[home]], np.array([home])).donor[0]
        assert set(found.tolist()) == reached
        assert found[0] == home


def test_donors_are_the_nearest_points_of_a_mesh_without_folds():
    old, new = random_mesh(9), random_mesh(10)
    start, end = place(old), place(new)
    found = OldPoints(start, np.repeat(np.arange(len(old[1])), 4), old[1]).find_transfer(end, locate(*old, end).cell)
    distance = np.linalg.norm(end[:, None] - start[None], axis=2)
    nearest = np.argsort(distance, axis=1)[:, : _core.most_donors]
    np.testing.assert_array_equal(found.donor, nearest)


def areas(mesh):
    corners = mesh[0][mesh[1]]
    first, second = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
    return 0.5 * (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])


def test_peaks_of_single_points_and_the_integral_stay():
    """Points of a cell differ in some elements: the fit alone takes more than a tenth of the largest value."""
    old, new = random_mesh(5), random_mesh(6)
    start = place(old)
    values = 1.0 + np.exp(-(((start - 0.5) / 0.2) ** 2).sum(axis=1))
    values *= np.random.default_rng(1).uniform(0.5, 1.5, len(values))
    flat, kept, volume = carry_with_peaks(old, new, values)
    assert flat.max() < 0.9 * values.max()
    assert kept.max() == values.max()
    assert kept @ volume == pytest.approx(flat @ volume, rel=1e-12)
    assert kept @ volume == pytest.approx(values @ np.repeat(areas(old) / 4, 4), rel=0.01)
    assert np.median(np.abs(kept / flat - 1)) < 0.05, "all but the peaks give a little"


def test_fields_of_the_second_order_have_no_peaks_to_restore():
    old, new = random_mesh(7), random_mesh(8)
    x, y = (place(old) - [0.4, 0.55]).T
    for values in (3.0 + x - 2 * y, 5.0 - x * x - 0.5 * y * y + 0.3 * x * y, np.full(len(x), 7.0)):
        flat, kept, _ = carry_with_peaks(old, new, values)
        np.testing.assert_array_equal(kept, flat)


def test_few_donors_give_a_linear_fit_then_the_nearest_value():
    points = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0.4]])

    def fit(n, at, values):
        one_cell = np.zeros(n, dtype=int), np.array([[0, 1, 2, 3]])
        return (
            OldPoints(points[:n], *one_cell).find_transfer(np.array([at]), np.zeros(1, dtype=int)).apply(values)[0, 0]
        )

    assert fit(5, [0.3, 0.6], points @ [[2.0], [1.0]]) == pytest.approx(1.2, abs=1e-9)
    assert fit(2, [0.8, 0.2], np.array([[3.0], [5.0]])) == 5.0


def test_nodes_are_located_and_linear_fields_continued_a_little_beyond():
    points, cells = random_mesh(5)
    wanted = np.array([[0.31, 0.77], [0.0, 0.5], [1.01, 0.2], [-0.003, -0.004]])
    places = locate(points, cells, wanted)
    np.testing.assert_allclose(places.interpolate(points @ [[2.0], [3.0]])[:, 0], wanted @ [2.0, 3.0], atol=1e-12)
    assert places.share[0].min() >= 0


def test_points_that_all_lie_inside_and_a_mesh_of_one_cell_are_located():
    points, cells = random_mesh(6)
    centres = points[cells].mean(axis=1)
    np.testing.assert_array_equal(locate(points, cells, centres).cell, np.arange(len(cells)))
    corner = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    one = locate(corner, np.array([[0, 1, 2, 3]]), np.array([[0.2, 0.9], [1.5, 0.5]]))
    np.testing.assert_array_equal(one.cell, [0, 0])
    np.testing.assert_allclose(one.interpolate(corner), [[0.2, 0.9], [1.5, 0.5]], atol=1e-14)
