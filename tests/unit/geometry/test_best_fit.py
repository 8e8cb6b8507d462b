# SPDX-License-Identifier: Apache-2.0
"""Deviation of one shape from another: none after a rigid motion, the distance between concentric spheres."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from presswork.geometry.best_fit import fit_rigidly, measure_deviation, nodal_areas


def cap(radius: float, quarter: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return 12 x 12 cells on a sphere about the origin, normals outward."""
    s = np.linspace(0.0 if quarter else -0.5, 0.5, 13)
    x, y = (a.ravel() for a in np.meshgrid(s, s))
    points = np.stack([x, y, np.ones_like(x)], axis=1)
    points *= radius / np.linalg.norm(points, axis=1, keepdims=True)
    first = (np.arange(12)[None, :] + 13 * np.arange(12)[:, None]).ravel()
    return points, np.stack([first, first + 1, first + 14, first + 13], axis=1).astype(np.int32)


@pytest.mark.parametrize("triangles", [False, True])
def test_a_moved_part_deviates_nowhere(triangles: bool) -> None:
    points, cells = cap(50.0, quarter=False)
    if triangles:
        cells = np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    moved = Rotation.from_rotvec([0.3, -0.2, 0.7]).apply(points) + np.array([3.0, -8.0, 20.0])
    np.testing.assert_allclose(measure_deviation(moved, points, [cells], (False, False)), 0.0, atol=1e-11)


def test_a_quarter_keeps_its_symmetry_planes() -> None:
    """A rotation about x is no motion of the whole part, so it stays; a shift along z is taken out."""
    points, _ = cap(50.0, quarter=True)
    weights = np.ones(len(points))
    shifted = fit_rigidly(points + np.array([0.0, 0.0, 2.0]), points, weights, (True, True))
    np.testing.assert_allclose(shifted, points, atol=1e-12)
    turned = Rotation.from_rotvec([0.01, 0.0, 0.0]).apply(points)
    fitted = fit_rigidly(turned, points, weights, (True, True))
    np.testing.assert_allclose(fitted[:, :2], turned[:, :2], atol=1e-12)


def test_a_sphere_that_grew_deviates_by_what_the_fit_leaves() -> None:
    """They lie d cos(angle) apart along z, of which the fit takes the weighted mean; facets tilt normals by 0.3 %."""
    points, cells = cap(50.0, quarter=True)
    found = measure_deviation(points * 1.01, points, [cells], (True, True))
    weights = np.linalg.norm(nodal_areas(points, [cells]), axis=1)
    normal_z = points[:, 2] / 50.0
    sunk = 0.01 * np.average(points[:, 2], weights=weights)
    inner = points[:, :2].min(axis=1) * points[:, :2].max(axis=1) > 0
    inner &= np.arange(len(points)) % 13 < 12
    inner[-13:] = False
    np.testing.assert_allclose(found[inner], (0.5 - sunk * normal_z)[inner], rtol=5e-3)


def test_areas_add_up_to_the_sheet() -> None:
    """Of a flat rectangle of 3 x 2 mm."""
    _, cells = cap(1.0, quarter=True)
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(0, 3, 13), np.linspace(0, 1, 13) ** 2 * 2))
    areas = nodal_areas(np.stack([x, y, 0 * x], axis=1), [cells])
    np.testing.assert_allclose(areas.sum(axis=0), [0.0, 0.0, 6.0], atol=1e-12)
