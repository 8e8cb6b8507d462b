# SPDX-License-Identifier: Apache-2.0
"""Tools with rounded edges: flat where they are flat, smooth where they are not, whoever asks first."""

import itertools

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from presswork.geometry.mirrored import add_mirror_image
from presswork.geometry.rounded_surface import RoundedSurface
from presswork.geometry.tool_surface import make_surface
from presswork.model import Triangulation

SPACING = 0.25


def make_cube(*, hollow: bool = False, cut_at: float = -5.0) -> Triangulation:
    """Return a cube of 10 mm about the origin, its metal inside or outside; cut_at: z of its bottom."""
    points = np.array(list(itertools.product((-5.0, 5.0), (-5.0, 5.0), (cut_at, 5.0))))
    corners = ConvexHull(points).simplices.astype(np.int32)
    normal = np.cross(points[corners[:, 1]] - points[corners[:, 0]], points[corners[:, 2]] - points[corners[:, 0]])
    inward = np.einsum("ni,ni->n", normal, points[corners].mean(axis=1) - points.mean(axis=0)) < 0.0
    corners[inward != hollow] = corners[inward != hollow][:, ::-1]
    return Triangulation(points, corners, True)


def round_off(shape: Triangulation, fold=None) -> RoundedSurface:
    return RoundedSurface(make_surface(shape), SPACING, fold)


def test_flat_faces_stay_where_they_are():
    places = np.array([[1.0, 0.5, 5.03], [5.2, 0.3, 1.0], [1.1, -2.2, 4.9]])
    gap, normal, *_ = round_off(make_cube()).nearest(places)
    np.testing.assert_allclose(gap, [0.03, 0.2, -0.1], atol=1e-12)
    np.testing.assert_allclose(normal, [[0, 0, 1], [1, 0, 0], [0, 0, 1]], atol=1e-12)


@pytest.mark.parametrize("hollow", [False, True])
def test_an_edge_of_90_degrees_gets_about_the_radius_of_the_spacing(hollow):
    """Along the bisector a fillet of radius r lies r (sqrt 2 - 1) off the edge, inside the cube."""
    surface = round_off(make_cube(hollow=hollow))
    way = np.linspace(0.0, 0.5, 2001)[:, None] * np.array([-1.0, 0.0, -1.0]) / np.sqrt(2.0)
    gap, *_ = surface.nearest(np.array([5.0, 0.4, 5.0]) + way)
    off = np.linalg.norm(way[np.argmin(np.abs(gap))])
    assert off / (np.sqrt(2.0) - 1.0) == pytest.approx(SPACING, rel=0.1)


def test_slopes_are_the_derivatives_of_gap_and_normal():
    surface = round_off(make_cube())
    places = np.array([[5.0, 0.3, 5.0], [5.05, 5.0, 4.9], [4.8, 0.3, 4.95], [0.3, 0.2, 5.1]])
    rise, bend = surface.slopes(places)
    for axis in range(3):
        ahead, behind = (surface.nearest(places + side * 1e-6 * np.eye(3)[axis]) for side in (1.0, -1.0))
        np.testing.assert_allclose((ahead[0] - behind[0]) / 2e-6, rise[:, axis], atol=1e-5)
        np.testing.assert_allclose((ahead[1] - behind[1]) / 2e-6, bend[:, :, axis], atol=1e-4)


def test_halfway_between_the_walls_of_a_ridge_the_tool_as_it_is_drawn_answers():
    """The field has its least value there, and no direction."""
    cube = make_cube()
    wall = round_off(Triangulation(cube.points * [0.05, 1.0, 1.0], cube.triangles, True))
    places = np.array([[0.0, 0.3, 1.0], [1e-9, 0.3, 1.0], [0.2, 0.3, 1.0]])
    gap, normal, *_ = wall.nearest(places)
    np.testing.assert_allclose(gap, [-0.25, -0.25, -0.05], atol=1e-2)
    np.testing.assert_allclose(np.abs(normal), [[1, 0, 0]] * 3, atol=1e-12)
    assert all(np.isfinite(slopes).all() for slopes in wall.slopes(places))


def test_the_answer_does_not_depend_on_earlier_questions():
    places = np.random.default_rng(1).uniform(4.5, 5.5, (200, 3))
    at_once, later = round_off(make_cube()), round_off(make_cube())
    for place in places[::-1]:
        later.nearest(place[None])
    assert np.array_equal(at_once.nearest(places)[0], later.nearest(places)[0])


@pytest.mark.parametrize("walled", [False, True])
def test_a_tool_that_ends_at_a_symmetry_plane_is_the_half_of_one_that_goes_on(walled):
    half = make_cube(cut_at=0.0)
    if not walled:
        open_ = half.triangles[~(half.points[half.triangles, 2] == 0.0).all(axis=1)]
        half = Triangulation(half.points, open_, False)
    completed = add_mirror_image(half, 2, 0.0, 1.0, 1e-6)
    places = np.array([[5.02, 1.3, 0.0], [5.0, 5.0, 0.0], [4.9, 4.95, 0.1], [4.9, 4.95, -0.1]])
    for one, other in zip(
        round_off(make_cube()).nearest(places)[:2], round_off(completed).nearest(places)[:2], strict=True
    ):
        np.testing.assert_allclose(one, other, atol=1e-12)


def test_a_tool_that_goes_on_beyond_a_plane_stays_as_it_is():
    assert add_mirror_image(make_cube(), 2, 0.0, 1.0, 1e-6).points.shape == make_cube().points.shape
