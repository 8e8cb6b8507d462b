# SPDX-License-Identifier: Apache-2.0
"""Tools of any section: their surface against the distance from the polygon, roundings, sections that cannot be."""

import numpy as np
import pytest

from presswork.geometry.polygon import contains, list_sides, measure_distance
from presswork.geometry.section_tool import SectionError, draw_one_sided, draw_round_x, draw_section
from presswork.geometry.tool_surface import make_surface

STEEL = [(30.0, 3.0), (40.0, 3.0), (40.0, 12.0), (31.0, 12.0)]


@pytest.mark.parametrize("backwards", [False, True])
def test_gap_of_a_sharp_section_is_the_distance_from_its_polygon(backwards: bool) -> None:
    corners = STEEL[::-1] if backwards else STEEL
    x = np.random.default_rng(1).uniform([25, -5, -2], [45, 5, 17], (2000, 3))
    sides = list_sides(np.array(corners))
    expected = np.where(contains(sides, x[:, [0, 2]]), -1.0, 1.0) * measure_distance(sides, x[:, [0, 2]])
    gap = make_surface(draw_section(corners, [0.0] * 4, is_round=False)).nearest(x)[0]
    assert gap == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("is_round", [False, True])
def test_a_plate_with_a_round_edge_touches_on_both_faces_and_its_edge(is_round: bool) -> None:
    """Plate of 0.8 mm that ends at 30 mm in a half circle; its side on x = 0 is no surface."""
    plate = draw_section([(0, 0), (30, 0), (30, 0.8), (0, 0.8)], [0, 0.4, 0.4, 0], is_round=is_round)
    rng = np.random.default_rng(2)
    far, z, angle = rng.uniform(20, 32, 2000), rng.uniform(-1, 2, 2000), rng.uniform(0, 2 * np.pi, 2000)
    where = [far * np.cos(angle), far * np.sin(angle)] if is_round else [far, 10 * angle]
    gap = make_surface(plate).nearest(np.column_stack([*where, z]))[0]
    expected = np.where(far < 29.6, np.abs(z - 0.4) - 0.4, np.hypot(far - 29.6, z - 0.4) - 0.4)
    assert gap == pytest.approx(expected, abs=1e-12)


def test_an_inner_corner_is_rounded_off_the_metal() -> None:
    """An L, whose corner at (20, 10) faces the metal: a fillet of 2 mm leaves 2 (sqrt 2 - 1) in the corner."""
    corners = [(10.0, 0.0), (40.0, 0.0), (40.0, 10.0), (20.0, 10.0), (20.0, 30.0), (10.0, 30.0)]
    shape = draw_section(corners, [0, 0, 0, 2.0, 0, 0], is_round=False)
    gap = make_surface(shape).nearest(np.array([[22.0, 0.0, 12.0], [20.0 + 1e-3, 0.0, 20.0]]))[0]
    assert gap == pytest.approx([2.0, 1e-3], abs=1e-9)


def test_a_one_sided_tool_stands_where_it_is_drawn_alone() -> None:
    """A steel beyond the middle, its corner at (-15, 0) rounded by 4 mm; chords of 5 degrees."""
    corners = [(-90.0, -20.0), (-15.0, -20.0), (-15.0, 0.0), (-90.0, 0.0)]
    shape = make_surface(draw_one_sided(corners, [0, 0, 4.0, 0], 50.0))
    x = [
        [-50.0, 30.0, 2.0],
        [-13.0, -40.0, -10.0],
        [-19.0 + 6.0, 0.0, -4.0],
        [-19.0 + 3.0, 5.0, -4.0 + 4.0],
        [15, 0, 0],
    ]
    assert shape.nearest(np.array(x))[0][:4] == pytest.approx([2.0, 2.0, 2.0, 1.0], abs=0.005)
    assert shape.nearest(np.array(x))[0][4] > 29.0  # nothing on the other side
    assert shape.nearest(np.array([[-20.0, 0.0, -1.0]]))[0] == pytest.approx(-1.0)


def volume(shape) -> float:
    a, b, c = np.moveaxis(shape.points[shape.triangles], 1, 0)
    return float((a * np.cross(b, c)).sum() / 6.0)


@pytest.mark.parametrize("backwards", [False, True])
def test_a_die_round_a_tube_is_closed_and_has_the_volume_of_guldin(backwards: bool) -> None:
    """2 pi r A of a ring of 30 x 10 mm, its normals out of the metal; chords of 5 degrees take 1.2e-3."""
    corners = [(-15.0, 20.0), (15.0, 20.0), (15.0, 30.0), (-15.0, 30.0)]
    shape = draw_round_x(corners[::-1] if backwards else corners, [0.0] * 4)
    assert shape.is_closed
    assert volume(shape) == pytest.approx(np.pi * (30.0**2 - 20.0**2) * 30.0, rel=2e-3)
    x = np.array([[3.0, 0.0, 15.0], [3.0, 15.0, 0.0], [3.0, -25.0, 0.0], [20.0, 0.0, -25.0]])
    assert make_surface(shape).nearest(x)[0] == pytest.approx([5.0, 5.0, -5.0, 5.0], abs=0.02)


def test_a_mandrel_round_x_ends_on_the_axis() -> None:
    shape = draw_round_x([(-15.0, 0.0), (15.0, 0.0), (15.0, 10.0), (-15.0, 10.0)], [0.0, 0.0, 2.0, 2.0])
    assert volume(shape) == pytest.approx(np.pi * 10.0**2 * 30.0, rel=0.02)
    gap = make_surface(shape).nearest(np.array([[0.0, 0.0, 11.0], [17.0, 0.0, 0.0], [0.0, 0.0, 0.0]]))[0]
    assert gap == pytest.approx([1.0, 2.0, -10.0], abs=0.05)


@pytest.mark.parametrize(("corners", "radii", "told"), [
    ([(1, 0), (2, 0), (3, 0)], [0, 0, 0], "enclose no area"),
    ([(-1, 0), (2, 0), (2, 3)], [0, 0, 0], "beyond the middle"),
    ([(1, 0), (5, 4), (5, 0), (1, 6)], [0] * 4, "cross each other"),
    ([(1, 0), (5, 0), (5, 4), (1, 4)], [3, 3, 0, 0], "take 6 mm of it"),
])  # fmt: skip
def test_sections_that_cannot_be_are_refused(corners, radii, told) -> None:
    with pytest.raises(SectionError, match=told):
        draw_section(corners, radii, is_round=False)


def test_a_section_round_x_lies_on_one_side_of_the_axis() -> None:
    with pytest.raises(SectionError, match="z = -1, beyond the axis"):
        draw_round_x([(0.0, -1.0), (5.0, -1.0), (5.0, 4.0)], [0.0] * 3)


def test_a_corner_in_the_middle_has_no_radius() -> None:
    with pytest.raises(SectionError, match=r"corner \(0, 0.8\) lies in the middle of the tool"):
        draw_section([(0, 0), (30, 0), (30, 0.8), (0, 0.8)], [0, 0.2, 0.2, 0.5], is_round=False)
    with pytest.raises(SectionError, match=r"corner \(5, 0\) lies in the middle"):
        draw_round_x([(-5.0, 0.0), (5.0, 0.0), (5.0, 4.0), (-5.0, 4.0)], [0.0, 1.0, 0.0, 0.0])


def test_a_radius_that_is_none_leaves_the_corner_sharp() -> None:
    corners = [(-15.0, 20.0), (15.0, 20.0), (15.0, 30.0), (-15.0, 30.0)]
    assert volume(draw_round_x(corners, [1e-300] * 4)) == volume(draw_round_x(corners, [0.0] * 4))
