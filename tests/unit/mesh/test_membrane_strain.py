# SPDX-License-Identifier: Apache-2.0
"""Strain of the middle surface between two instants, and its derivative."""

from __future__ import annotations

import numpy as np

from presswork.mesh.membrane_strain import find_strain_gradients, find_strains


def test_strain_is_that_of_plane_strain_and_of_equal_stretching_and_none_of_a_rotation() -> None:
    square = np.array([[0.0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]])
    cells = np.array([[0, 1, 2, 3], [0, 1, 2, 2]])
    turned = square @ np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    np.testing.assert_allclose(find_strains(square, turned, cells), 0.0, atol=1e-7)
    for stretch, strain in (([0.2, 0.0], 0.4 / np.sqrt(3.0)), ([0.2, 0.2], 0.4), ([0.2, -0.1], 0.2)):
        stretched = turned * 0.0 + (square * np.exp([*stretch, 0.0])) @ (np.linalg.pinv(square) @ turned)
        np.testing.assert_allclose(find_strains(square, stretched, cells), strain, rtol=1e-12)


def test_derivative_of_strain_is_that_of_finite_differences() -> None:
    random = np.random.default_rng(1)
    before = np.array([[0.0, 0, 0], [1, 0, 0.1], [1, 1.2, 0], [0, 1, 0]])
    after, cells = before + 0.1 * random.normal(size=before.shape), np.array([[0, 1, 2, 3], [0, 1, 2, 2]])
    strain, gradient = find_strain_gradients(before, after, cells)
    np.testing.assert_array_equal(strain, find_strains(before, after, cells))
    for number, cell in enumerate(cells):
        own = np.zeros_like(after)
        np.add.at(own, cell, gradient[number])
        direction = random.normal(size=after.shape)
        ahead, back = (find_strains(before, after + h * direction, cells)[number] for h in (1e-6, -1e-6))
        np.testing.assert_allclose((own * direction).sum(), (ahead - back) / 2e-6, rtol=1e-7)
