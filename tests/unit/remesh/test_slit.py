# SPDX-License-Identifier: Apache-2.0
"""Slits in outlines: what they leave of the area, how many loops there are, and where they begin."""

import numpy as np
import pytest

from presswork.geometry.polygon import polygon_area
from presswork.mesh.checks import MeshError
from presswork.remesh.fill import fill_with_quadrilaterals, measure_quality
from presswork.remesh.forced_sides import find_missing, force_sides
from presswork.remesh.slit import Mouth, Outline, Slit, blunt_spikes, cut_outline, place_mouth

WIDTH = 1e-3


def square(low: float, high: float, n: int, *, hole: bool = False) -> np.ndarray:
    part = np.linspace(0.0, 1.0, n, endpoint=False)[:, None]
    corners = np.array([[low, low], [high, low], [high, high], [low, high]])
    line = np.concatenate([a + part * (b - a) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)])
    return line[::-1] if hole else line


def areas(outline: Outline) -> list[float]:
    return sorted(polygon_area(outline.points[loop]) for loop in outline.loops)


@pytest.fixture
def whole() -> Outline:
    points = square(0.0, 4.0, 4)
    return Outline(points, (np.arange(16),))


def everywhere(outline: Outline) -> np.ndarray:
    return np.ones(len(outline.points), dtype=bool)


def test_a_slit_to_the_inside_takes_half_its_width_times_its_length(whole):
    mouth = place_mouth(whole, np.array([2.1, -0.1]), everywhere(whole))
    path = np.array([[2.0, 0.0], [2.0, 1.0], [2.0, 2.0]])
    cut = cut_outline(whole, Slit(path, WIDTH, mouth))
    assert mouth == Mouth(2)
    assert len(cut.loops) == 1
    assert areas(cut)[0] == pytest.approx(16.0 - 0.5 * WIDTH * 2.0, abs=1e-12)


def test_a_slit_that_goes_on_from_its_tip_to_the_other_side_leaves_two_pieces(whole):
    path = np.array([[2.0, 0.0], [2.0, 1.0], [2.0, 2.0]])
    first = cut_outline(whole, Slit(path, WIDTH, Mouth(2)))
    tip = first.firm[-1]
    assert first.points[tip] == pytest.approx([2.0, 2.0])
    on = np.array([[2.0, 2.0], [2.2, 3.0], [2.0, 4.0]])
    end = place_mouth(first, on[-1], everywhere(first))
    both = cut_outline(first, Slit(on, WIDTH, Mouth(tip, is_tip=True), end))
    assert len(both.loops) == 2
    assert sum(areas(both)) == pytest.approx(16.0, rel=3e-4)
    assert min(areas(both)) > 7.5


def test_two_tips_that_meet_leave_two_pieces(whole):
    one = cut_outline(whole, Slit(np.array([[2.0, 0.0], [2.0, 1.5]]), WIDTH, Mouth(2)))
    low = one.firm[-1]
    two = cut_outline(one, Slit(np.array([[2.0, 4.0], [2.0, 2.5]]), WIDTH, Mouth(10)))
    high = two.firm[-1]
    path = np.array([[2.0, 1.5], [2.0, 2.0], [2.0, 2.5]])
    cut = cut_outline(two, Slit(path, WIDTH, Mouth(low, is_tip=True), Mouth(high, is_tip=True)))
    assert areas(cut) == pytest.approx([8.0, 8.0], rel=1e-3)


def test_a_slit_inside_is_a_hole_and_joins_the_outline_when_it_reaches_it(whole):
    inside = cut_outline(whole, Slit(np.array([[2.0, 1.0], [2.0, 2.0], [2.0, 3.0]]), WIDTH))
    assert len(inside.loops) == 2
    assert areas(inside)[0] == pytest.approx(-0.5 * WIDTH * 2.0, rel=1e-6)
    tip = next(node for node in inside.firm if inside.points[node][1] == 1.0)
    path = np.array([[2.0, 1.0], [2.0, 0.5], [2.0, 0.0]])
    joined = cut_outline(inside, Slit(path, WIDTH, Mouth(tip, is_tip=True), Mouth(2)))
    assert len(joined.loops) == 1
    assert areas(joined)[0] == pytest.approx(16.0, rel=1e-3)


def test_a_slit_from_a_node_to_itself_is_refused(whole):
    with pytest.raises(MeshError, match="begins and ends at one node"):
        cut_outline(whole, Slit(np.array([[2.0, 0.0], [2.5, 1.0], [2.1, 0.0]]), WIDTH, Mouth(2), Mouth(2)))
    with pytest.raises(MeshError, match="no node"):
        place_mouth(whole, np.zeros(2), np.zeros(16, dtype=bool))


def test_spikes_of_metal_lose_their_ends_and_slits_stay():
    line = np.insert(square(0.0, 4.0, 8), 9, [[4.05, 0.2], [5.0, 0.25], [4.05, 0.3]], axis=0)
    spiked = Outline(line, (np.arange(len(line)),))
    cut = cut_outline(spiked, Slit(np.array([[2.0, 0.0], [2.0, 2.0]]), WIDTH, Mouth(4)))
    blunt = blunt_spikes(cut, 0.5)
    assert blunt.points[blunt.loops[0]][:, 0].max() < 4.1
    assert cut.firm[-1] in blunt.loops[0]
    assert blunt_spikes(cut, 0.1).points[cut.loops[0]][:, 0].max() == 5.0


@pytest.mark.parametrize("width", [1e-2, 1e-4])
def test_metal_round_a_slit_whose_faces_have_unlike_nodes_is_filled(width):
    def face(start, end, n):
        return [np.asarray(start) + (np.asarray(end) - start) * i / n for i in range(n)]

    right, left, tip = [1.0 + 0.5 * width, 1.0], [1.0 - 0.5 * width, 1.0], [1.0, 0.4]
    line = [*face([0.0, 0.0], [2.0, 0.0], 20), *face([2.0, 0.0], [2.0, 1.0], 10), *face([2.0, 1.0], right, 10)]
    line += [*face(right, tip, 8), *face(tip, left, 10), *face(left, [0.0, 1.0], 10), *face([0.0, 1.0], [0.0, 0.0], 10)]
    line = np.array(line)
    with pytest.raises(MeshError, match="too coarse for its shape"):
        fill_with_quadrilaterals(line, lambda places: np.full(len(places), 0.1))
    points, cells = fill_with_quadrilaterals(line, lambda places: np.full(len(places), 0.1), has_slits=True)
    assert measure_quality(points, cells).min() > 0.2
    assert sum(polygon_area(points[cell]) for cell in cells) == pytest.approx(polygon_area(line), rel=1e-12)


def test_flips_bring_a_side_that_is_missing():
    points = np.array([[0.0, 0.0], [4.0, 0.0], [1.0, 1.0], [2.0, -1.0], [3.0, 1.0]])
    triangles = np.array([[0, 3, 2], [2, 3, 4], [3, 1, 4]])
    side = np.array([[0, 1]])
    assert list(find_missing(triangles, side)) == [0]
    forced = force_sides(points, triangles, side)
    assert not len(find_missing(forced, side))
    assert sum(polygon_area(points[t]) for t in forced) == pytest.approx(
        sum(polygon_area(points[t]) for t in triangles)
    )
    assert force_sides(points, forced, side) is forced
