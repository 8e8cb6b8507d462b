# SPDX-License-Identifier: Apache-2.0
"""Faces of tools moved along their normals, and cut along a line in the plan."""

import numpy as np
import pytest

from presswork.geometry.polygon import polygon_area
from presswork.geometry.swept_tool import draw_hemispherical_punch, triangulate
from presswork.mesh.checks import MeshError
from presswork.mesh.make.surface_offset import cut_surface, move_surface
from presswork.mesh.triangles import double_areas, find_rims
from presswork.model import FloatArray, Triangulation


def bowl(radius: float) -> Triangulation:
    points, triangles = triangulate(draw_hemispherical_punch(radius, radius), 1e-3 * radius)
    return Triangulation(points, triangles, is_closed=False)


def plate(n: int = 20) -> Triangulation:
    """A wavy plate of 20 x 20 mm, cells of 20/n mm."""
    x, y = (each.ravel() for each in np.meshgrid(*[np.linspace(-10, 10, n + 1)] * 2, indexing="ij"))
    corner = np.add.outer(np.arange(n) * (n + 1), np.arange(n)).ravel()
    lower = np.stack([corner, corner + n + 1, corner + n + 2], axis=1)
    upper = np.stack([corner, corner + n + 2, corner + 1], axis=1)
    points = np.column_stack([x, y, np.sin(x)])
    return Triangulation(points, np.concatenate([lower, upper]).astype(np.int32), is_closed=False)


def circle(n: int, radius: float) -> FloatArray:
    angle = 2 * np.pi * (np.arange(n) + 0.3) / n
    return radius * np.column_stack([np.cos(angle), np.sin(angle)]) + [0.7, -0.4]


@pytest.mark.parametrize("distance", [-2.0, 1.5])
def test_a_half_sphere_is_moved_to_one_of_another_radius(distance: float) -> None:
    surface = bowl(20.0)
    moved = move_surface(surface, distance)  # its normals point out of it
    low = surface.points[:, 2] < 15.0
    radius = np.linalg.norm(moved.points[low] - [0.0, 0.0, 20.0], axis=1)
    np.testing.assert_allclose(radius, 20.0 + distance, atol=0.01)


def test_a_face_is_not_moved_beyond_its_radius() -> None:
    with pytest.raises(MeshError, match=r"moved by 3 mm the surface turns over, first near .* a radius"):
        move_surface(bowl(2.0), -3.0)


@pytest.mark.parametrize("n", [3, 4, 48])
@pytest.mark.parametrize("inside", [True, False])
def test_what_is_cut_has_the_area_of_the_line_and_no_cracks(n: int, inside: bool) -> None:
    line = circle(n, 6.0)
    part = cut_surface(plate(), line, inside=inside)
    area = 0.5 * double_areas(part.points, part.triangles)
    wanted = polygon_area(line) if inside else 400.0 - polygon_area(line)
    assert area[:, 2].sum() == pytest.approx(wanted, rel=1e-4)
    assert area[:, 2].min() > 0.0  # none is turned over
    assert len(find_rims(part.points, part.triangles)) == (1 if inside else 2)


@pytest.mark.parametrize(("inside", "fault"), [(True, "nothing of the surface lies inside"), (False, "cuts nothing")])
def test_a_line_beside_the_surface_is_refused(inside: bool, fault: str) -> None:
    with pytest.raises(MeshError, match=fault):
        cut_surface(plate(), circle(8, 2.0) + 100.0, inside=inside)
