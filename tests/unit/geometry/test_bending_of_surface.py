# SPDX-License-Identifier: Apache-2.0
"""Bending and stretching of a surface of triangles by a displacement, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.geometry.sprung.bending_of_surface import find_edges


def plate(n: int, width: float = 10.0) -> tuple[np.ndarray, np.ndarray]:
    """Return a square plate from the origin, of 2 n n triangles."""
    x, y = np.meshgrid(np.linspace(0.0, width, n + 1), np.linspace(0.0, width, n + 1), indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    a = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    b, c, d = a + n + 1, a + n + 2, a + 1
    return points, np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]).astype(np.int32)


def test_a_cylinder_has_the_curvature_of_its_radius() -> None:
    """An edge has 3 (angle x length)^2 over both areas (Grinspun et al. 2003): 3/R^2 an area on squares cut in two."""
    points, triangles = plate(40)
    edges = find_edges(points, triangles, (False, False))
    bent = np.zeros_like(points)
    bent[:, 2] = 0.5 * points[:, 0] ** 2 / 500.0
    energy = ((edges.bending @ bent.ravel()) ** 2).sum()
    assert energy == pytest.approx(3.0 * 97.5 / 500.0**2, rel=1e-3)  # of 39 inner edges of 40


def test_rigid_motions_neither_bend_nor_stretch() -> None:
    points, triangles = plate(6)
    points[:, 2] = 0.3 * np.sin(points[:, 0])
    edges = find_edges(points, triangles, (False, False))
    motion = np.array([0.3, -0.2, 0.7]) + np.cross(np.array([0.01, 0.02, -0.03]), points)
    assert np.abs(edges.bending @ motion.ravel()).max() < 1e-12
    assert np.abs(edges.stretching @ motion.ravel()).max() < 1e-12


def test_stretching_is_the_strain_over_the_area() -> None:
    points, triangles = plate(5)
    edges = find_edges(points, triangles, (False, False))
    assert ((edges.stretching @ (0.01 * points).ravel()) ** 2).sum() == pytest.approx(1e-4 * 100.0)


def test_a_surface_bends_at_its_symmetry_planes() -> None:
    """A quarter that turns about its plane bends there as the whole surface does; on the plane it cannot move off."""
    points, triangles = plate(4)
    quarter = find_edges(points, triangles, (True, False))
    both = np.concatenate([points, points[points[:, 0] > 0.0] * [-1.0, 1.0, 1.0]])
    number = np.arange(len(points))
    number[points[:, 0] > 0.0] = len(points) + np.arange((points[:, 0] > 0.0).sum())
    whole = find_edges(both, np.concatenate([triangles, number[triangles][:, ::-1]]).astype(np.int32), (False, False))
    turned, all_turned = np.zeros_like(points), np.zeros_like(both)
    turned[:, 2], all_turned[:, 2] = 0.01 * points[:, 0], 0.01 * np.abs(both[:, 0])
    energy = [
        (edge.bending @ x.ravel()) @ (edge.bending @ x.ravel()) for edge, x in ((quarter, turned), (whole, all_turned))
    ]
    assert energy[0] == pytest.approx(energy[1])
    assert energy[0] > 1e-6
    off = np.zeros_like(points)
    off[points[:, 0] == 0.0, 0] = 1.0
    assert not (quarter.stretching @ off.ravel()).any()
