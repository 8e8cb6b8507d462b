# SPDX-License-Identifier: Apache-2.0
"""Slivers collapsed and flipped: what must stay where it was, and what may not change at all."""

import numpy as np
import pytest

from presswork.mesh.make.remesh import POOR, RIM, SURFACE, mend_slivers
from presswork.mesh.triangles import (
    distance_to_segments,
    distance_to_triangles,
    double_areas,
    find_rims,
    triangle_quality,
)


def squares(nx: int, ny: int) -> tuple[np.ndarray, np.ndarray]:
    """Return points of a grid in the unit square (n, 2) and triangles."""
    x, y = np.meshgrid(np.linspace(0, 1, nx + 1), np.linspace(0, 1, ny + 1), indexing="ij")
    index = np.arange(len(x.ravel())).reshape(x.shape)
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1).reshape(-1, 4)
    return np.stack([x.ravel(), y.ravel()], axis=1), quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3).astype(np.int32)


def distances(x: np.ndarray, points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Return the distance of each of the places x from a surface."""
    n = len(triangles)
    return np.array([distance_to_triangles(np.broadcast_to(p, (n, 3)), *points[triangles.T]).min() for p in x])


def rim_distances(x: np.ndarray, points: np.ndarray, rims: list[np.ndarray]) -> np.ndarray:
    ends = np.concatenate([np.stack([points[r], points[np.roll(r, -1)]], axis=1) for r in rims])
    return np.array([distance_to_segments(np.broadcast_to(p, (len(ends), 3)), *ends.swapaxes(0, 1)).min() for p in x])


def folded_sheet() -> tuple[np.ndarray, np.ndarray]:
    """Return an L of 40 mm with a fillet of 4 mm in fine strips, a hole, and rows of slivers across all of it."""
    flat, triangles = squares(48, 24)
    rows = np.concatenate([np.arange(12), 11.0 + np.cumsum(np.resize([1e-4, 1.0], 13))])
    flat[:, 1] = rows[np.rint(24 * flat[:, 1]).astype(int)]
    flat *= [80.0, 30.0 / rows[-1]]
    s = flat[:, 0] - 37.0
    turn = np.clip(s / 4.0, 0.0, np.pi / 2)
    beyond = np.maximum(s - 2.0 * np.pi, 0.0)
    x = np.minimum(s, 0.0) + 4.0 * np.sin(turn)
    points = np.stack([x, flat[:, 1], 4.0 * (1.0 - np.cos(turn)) + beyond], axis=1)
    middle = flat[triangles].mean(axis=1)
    hole = np.linalg.norm(middle - [15.0, 11.0], axis=1) < 5.0
    used, numbers = np.unique(triangles[~hole], return_inverse=True)
    return points[used], numbers.reshape(-1, 3).astype(np.int32)


def test_slivers_go_and_surface_rims_and_holes_stay():
    points, triangles = folded_sheet()
    assert triangle_quality(points, triangles).min() < 1e-3
    size = 2.0
    x, t, collapsed, _ = mend_slivers(points, triangles, size)
    assert collapsed > 300
    assert triangle_quality(x, t).min() >= POOR
    area, before = (np.linalg.norm(double_areas(*mesh), axis=1).sum() for mesh in ((x, t), (points, triangles)))
    assert area == pytest.approx(before, rel=1e-4)
    assert distances(x[::17], points, triangles).max() < 1e-9, "points that stay lie on the facets given"
    assert distances(points[::17], x, t).max() <= SURFACE * size
    rims, old = find_rims(x, t), find_rims(points, triangles)
    assert len(rims) == len(old) == 2
    assert rim_distances(points[np.concatenate(old)], x, rims).max() <= RIM * size
    assert rim_distances(x[np.concatenate(rims)], points, old).max() < 1e-9


def test_sharp_edges_stay():
    """A roof with slivers along its ridge: each point of the ridge stays on it, and none is cut off."""
    flat, triangles = squares(16, 30)
    flat[:, 0] = np.sign(flat[:, 0] - 0.5) * np.abs(2.0 * flat[:, 0] - 1.0) ** 3
    points = np.stack([20.0 * flat[:, 0], 40.0 * flat[:, 1], -20.0 * np.abs(flat[:, 0])], axis=1)
    assert triangle_quality(points, triangles).min() < POOR
    x, t, *_ = mend_slivers(points, triangles, 2.5)
    assert triangle_quality(x, t).min() >= POOR
    ridge = np.stack([np.zeros(9), np.linspace(0.0, 40.0, 9), np.zeros(9)], axis=1)
    assert distances(ridge, x, t).max() <= SURFACE * 2.5
    assert x[:, 2] == pytest.approx(-np.abs(x[:, 0]), abs=1e-9)


def test_a_good_mesh_is_left_alone():
    flat, triangles = squares(9, 7)
    points = np.column_stack([flat, flat[:, 0] * flat[:, 1]])
    x, t, collapsed, flipped = mend_slivers(points, triangles, 0.01)
    assert (collapsed, flipped) == (0, 0)
    assert x.tobytes() == points.tobytes()
    assert (t == triangles).all()


def test_the_result_is_always_the_same():
    first, second = (mend_slivers(*folded_sheet(), 2.0) for _ in range(2))
    assert first[0].tobytes() == second[0].tobytes()
    assert first[1].tobytes() == second[1].tobytes()
