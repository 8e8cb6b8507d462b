# SPDX-License-Identifier: Apache-2.0
"""Axes of laws that were carried to a new mesh one value at a time."""

import numpy as np
import scipy
from scipy.spatial.transform import Rotation

from presswork.remesh.axes import straighten_axes


def find_axes(rotation: Rotation) -> np.ndarray:
    """Return x and y of turned axes (n, 6)."""
    return np.swapaxes(rotation.as_matrix()[:, :, :2], 1, 2).reshape(-1, 6)


def test_axes_stay_as_they_are() -> None:
    axes = find_axes(Rotation.random(50, random_state=1))
    np.testing.assert_allclose(straighten_axes(axes), axes, atol=1e-14)


def test_means_of_axes_become_axes() -> None:
    random = np.random.default_rng(2)
    turned = [find_axes(Rotation.from_rotvec(random.normal(0.0, 0.3, (200, 3)))) for _ in range(4)]
    x, y = np.split(straighten_axes(0.25 * sum(turned)), 2, axis=1)
    for product, wanted in ((x * x, 1.0), (y * y, 1.0), (x * y, 0.0)):
        np.testing.assert_allclose(product.sum(axis=1), wanted, atol=1e-14)


def test_none_are_nearer_in_least_squares() -> None:
    random = np.random.default_rng(3)
    for fitted in find_axes(Rotation.random(10, random_state=4)) + random.normal(0.0, 0.2, (10, 6)):
        pair, _ = scipy.linalg.polar(fitted.reshape(2, 3).T)
        np.testing.assert_allclose(straighten_axes(fitted), pair.T.ravel(), atol=1e-13)


def test_in_the_plane_x_gets_its_length_back() -> None:
    np.testing.assert_allclose(straighten_axes(np.array([[3.0, 4.0], [0.0, 0.0]])), [[0.6, 0.8], [0.0, 0.0]])
