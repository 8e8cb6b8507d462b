# SPDX-License-Identifier: Apache-2.0
"""The least radius of a tool made of triangles, against the radii that it was drawn with."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.geometry.swept_tool import draw_punch, triangulate
from presswork.geometry.tool_radius import find_least_radius


@pytest.mark.parametrize("radius", [2.0, 5.0, 10.0])
@pytest.mark.parametrize("within", [0.1, 0.01])
def test_the_edge_radius_of_a_round_punch_is_found(radius: float, within: float) -> None:
    points, triangles = triangulate(draw_punch((25.0, 25.0), 25.0, radius, 30.0), within)
    found = find_least_radius(points, triangles, length=20.0)
    assert found == pytest.approx(radius, rel=0.1)


@pytest.mark.parametrize("spacing", [0.5, 1.0, 1.3])
def test_the_radius_of_a_channel_cut_into_a_regular_grid_is_found(spacing: float) -> None:
    """Fillets of 6 mm between a face and a wall of 60 degrees, as heights over a grid: facets of many widths."""
    x = np.arange(-30.0, 30.0, spacing)
    angle, radius = np.radians(60.0), 6.0
    far = radius * np.sin(angle)
    height = np.where(x < 0.0, 0.0, np.where(x < far, radius - np.sqrt(np.maximum(radius**2 - x**2, 0.0)), 0.0))
    height = np.where(x >= far, radius * (1.0 - np.cos(angle)) + (x - far) * np.tan(angle), height)
    points = np.array([[a, y, z] for a, z in zip(x, height, strict=True) for y in np.arange(0.0, 40.0, spacing)])
    n = len(np.arange(0.0, 40.0, spacing))
    i = (np.arange(len(x) - 1)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.concatenate([np.column_stack([i, i + n, i + n + 1]), np.column_stack([i, i + n + 1, i + 1])])
    assert find_least_radius(points, faces.astype(np.int32), length=20.0) == pytest.approx(radius, rel=0.1)


@pytest.mark.parametrize("shift", [0.0, 0.37])
@pytest.mark.parametrize(("angle", "top", "foot"), [(45, 6, 10), (60, 6, 6), (60, 10, 6), (75, 6, 6), (82, 6, 6)])
def test_the_radius_of_a_pan_as_heights_over_a_grid_is_found(
    angle: float, top: float, foot: float, shift: float
) -> None:
    """A rounded rectangle: in its corners the diagonals of the grid run along, across and askew to the wall."""
    points, triangles = _grid_pan(np.radians(angle), top, foot, shift)
    assert find_least_radius(points, triangles, length=20.0) == pytest.approx(min(top, foot), rel=0.1)


def _grid_pan(angle: float, top: float, foot: float, shift: float) -> tuple[np.ndarray, np.ndarray]:
    """Return a pan 20 mm deep on a grid of 1 mm, its radii at the flange and at the bottom."""
    x, y = np.meshgrid(np.arange(-90.0, 91.0) + shift, np.arange(-75.0, 76.0) + shift, indexing="ij")
    over = np.stack([np.abs(x) - 40.0, np.abs(y) - 25.0])
    away = np.linalg.norm(np.maximum(over, 0.0), axis=0) + np.minimum(over.max(axis=0), 0.0) - 20.0
    run = 20.0 / np.tan(angle)  # of the wall without radii
    low, high = -0.5 * run - foot * np.tan(0.5 * angle), 0.5 * run + top * np.tan(0.5 * angle)
    z = np.clip((away + 0.5 * run) * np.tan(angle) - 20.0, -20.0, 0.0)
    rises, falls = away - low, high - away
    z = np.where((rises > 0) & (rises < foot * np.sin(angle)), foot - 20.0 - _circle(foot, rises), z)
    z = np.where((falls > 0) & (falls < top * np.sin(angle)), _circle(top, falls) - top, z)
    n = x.shape[1]
    i = (np.arange(x.shape[0] - 1)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.concatenate([np.column_stack([i, i + n, i + n + 1]), np.column_stack([i, i + n + 1, i + 1])])
    return np.stack([x, y, z], axis=2).reshape(-1, 3), faces.astype(np.int32)


def _circle(radius: float, x: np.ndarray) -> np.ndarray:
    return np.sqrt(np.maximum(radius**2 - x**2, 0.0))


def test_a_sharp_edge_has_no_radius_and_a_flat_face_an_infinite_one() -> None:
    """Two faces of a box, of two triangles each, that share an edge of 10 mm."""
    points = np.array([[0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0], [0, 0, 10], [10, 0, 10]], float)
    flat = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    bent = np.concatenate([flat, np.array([[0, 5, 1], [0, 4, 5]], np.int32)])
    assert find_least_radius(points, flat, 5.0) == float("inf")
    assert find_least_radius(points, bent, 5.0) == 0.0
    assert find_least_radius(points, bent, 5.0, sharp_counts=False) == float("inf")
    assert find_least_radius(points, bent, 11.0) == float("inf")  # less than that is sharp
