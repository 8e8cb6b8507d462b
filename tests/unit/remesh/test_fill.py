# SPDX-License-Identifier: Apache-2.0
"""Quadrilaterals inside a line."""

import numpy as np
import pytest

from presswork.mesh.checks import MeshError
from presswork.mesh.topology import find_boundary_edges
from presswork.remesh.fill import fill_with_quadrilaterals, measure_quality
from presswork.remesh.volume import enclosed_volume


def polygon(corners, size):
    """A closed line with an even number of edges of about this size on each side."""
    corners = np.array(corners, dtype=float)
    sides = []
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        n = 2 * max(1, round(np.linalg.norm(b - a) / size / 2))
        sides.append(a + (np.arange(n) / n)[:, None] * (b - a))
    return np.concatenate(sides)


def uniform(size):
    return lambda points: np.full(len(points), size)


SHAPES = {
    "rectangle": [[0, 0], [15, 0], [15, 10.6], [0, 10.6]],
    "wedge": [[0, 0], [12, 0], [9, 6]],
    "hub": [[0, 0], [24, 0], [24, 1.5], [20, 1.5], [19.5, 5], [10, 5], [6, 8], [5, 10], [0, 10]],
    "hollow corner": [[0, 0], [10, 0], [10, 10], [5, 10], [5, 4], [0, 4]],
}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("size", [0.9, 0.5, 0.31])
def test_cells_fill_the_line_whole_with_its_own_nodes(shape, size):
    line = polygon(SHAPES[shape], size)
    points, cells = fill_with_quadrilaterals(line, uniform(size))
    np.testing.assert_array_equal(points[: len(line)], line)
    edges = find_boundary_edges([cells.astype(np.int32)])
    following = {tuple(edge) for edge in edges.tolist()}
    assert following == {(i, (i + 1) % len(line)) for i in range(len(line))}
    x, y = points[cells].transpose(2, 0, 1)
    area = 0.5 * (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)
    assert area.min() > 0
    assert area.sum() == pytest.approx(enclosed_volume(line, ring=False), rel=1e-12)
    assert measure_quality(points, cells).min() > 0.2
    assert area.mean() == pytest.approx(size**2, rel=0.35)


def test_most_cells_of_a_rectangle_are_nearly_square():
    line = polygon(SHAPES["rectangle"], 0.5)
    quality = measure_quality(*fill_with_quadrilaterals(line, uniform(0.5)))
    assert np.median(quality) > 0.9
    assert quality.mean() > 0.85


def test_cells_follow_a_size_that_changes_over_the_plane():
    def size(points):
        return 0.2 + 0.26 * np.maximum(0.0, np.hypot(points[:, 0], points[:, 1]) - 1.0)

    def side(a, b):
        fine = np.array(a) + np.linspace(0, 1, 2001)[:, None] * (np.array(b) - np.array(a, dtype=float))
        step = np.linalg.norm(np.diff(fine, axis=0), axis=1)
        way = np.concatenate([[0], np.cumsum(step / size(0.5 * (fine[1:] + fine[:-1])))])
        n = 2 * round(way[-1] / 2)
        at = np.arange(n) * way[-1] / n
        return np.stack([np.interp(at, way, fine[:, k]) for k in (0, 1)], axis=1)

    corners = [(0, 0), (10, 0), (10, 10), (0, 10)]
    line = np.concatenate([side(a, b) for a, b in zip(corners, [*corners[1:], corners[0]], strict=True)])
    points, cells = fill_with_quadrilaterals(line, size)
    x, y = points[cells].transpose(2, 0, 1)
    area = 0.5 * (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)
    ratio = np.sqrt(area) / size(points[cells].mean(axis=1))
    assert ratio.min() > 0.4
    assert ratio.max() < 1.8
    assert np.median(ratio) == pytest.approx(1.0, abs=0.2)


def test_the_same_line_gives_the_same_bits():
    line = polygon(SHAPES["hub"], 0.4)
    one, other = (fill_with_quadrilaterals(line, uniform(0.4)) for _ in range(2))
    assert one[0].tobytes() == other[0].tobytes()
    assert one[1].tobytes() == other[1].tobytes()


def test_a_line_too_coarse_for_its_shape_or_odd_is_refused():
    """A slit 0.02 wide, one side of which is a single edge and the other one is fine."""
    fine = np.stack([np.full(20, 4.99), np.linspace(0.5, 10, 20)], axis=1)
    line = np.concatenate(
        [[[0, 0], [5, 0], [10, 0], [10, 5], [10, 10], [7.5, 10], [5.01, 10], [5.01, 5.2]], [[5, 0.5]]]
    )
    line = np.concatenate([line, fine[1:], [[2.5, 10], [0, 10], [0, 5]]])
    assert len(line) % 2 == 1
    with pytest.raises(MeshError, match="even number"):
        fill_with_quadrilaterals(line, uniform(2.0))
    with pytest.raises(MeshError, match="too coarse for its shape near"):
        fill_with_quadrilaterals(np.insert(line, 8, [5.01, 2.8], axis=0), uniform(2.0))


@pytest.mark.parametrize("rows", [2.6, 3.0, 4.0, 5.3])
def test_thin_metal_has_at_least_three_rows_of_cells(rows):
    """Between walls that are `rows` sizes apart, in the middle of a long strip."""
    size = 0.5
    line = polygon([[0, 0], [20, 0], [20, rows * size], [0, rows * size]], size)
    points, cells = fill_with_quadrilaterals(line, uniform(size))
    corners = points[cells]
    across = (corners[..., 0].min(axis=1) < 10.02) & (corners[..., 0].max(axis=1) > 10.02)
    assert across.sum() >= 3
