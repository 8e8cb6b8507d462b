# SPDX-License-Identifier: Apache-2.0
"""Distance between two shapes of a sheet after the best rigid alignment."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from presswork.model import FloatArray, IntArray, find_cell


def nodal_areas(points: FloatArray, cells: Sequence[IntArray]) -> FloatArray:
    """Return the vector area of the cells round each node (n_points, 3) [mm2], each cell shared by its corners.

    points: (n_points, 3); cells: connectivities (n, 3) or (n, 4), of one sense of turning.
    """
    areas = np.zeros_like(points)
    for block in cells:
        one, other = (points[block[:, last]] - points[block[:, first]] for first, last in find_cell(2, block).spans)
        share = 0.5 * np.cross(one, other) / block.shape[1]
        for column in block.T:
            np.add.at(areas, column, share)
    return areas


def fit_rigidly(points: FloatArray, target: FloatArray, weights: FloatArray, planes: tuple[bool, bool]) -> FloatArray:
    """Return points (n, 3) moved as a rigid body so that the weighted squares of their distances to target are least.

    planes: symmetry planes normal to x and y through the origin; what lies behind them is fitted too, so the motion
    keeps them. Kabsch (1976), A solution for the best rotation to relate two sets of vectors, Acta Cryst. A32.
    """
    images = [np.ones(3)]
    for axis in (0, 1):
        if planes[axis]:
            images += [image * np.where(np.arange(3) == axis, -1.0, 1.0) for image in images]
    start, goal = (np.concatenate([p * image for image in images]) for p in (points, target))
    w = np.tile(weights / weights.sum(), len(images)) / len(images)
    from_middle, to_middle = w @ start, w @ goal
    u, _, vt = np.linalg.svd((start - from_middle).T @ ((goal - to_middle) * w[:, None]))
    turn = (u * [1.0, 1.0, np.sign(np.linalg.det(u @ vt))]) @ vt
    return np.asarray((points - from_middle) @ turn + to_middle)


def measure_deviation(
    points: FloatArray, target: FloatArray, cells: Sequence[IntArray], planes: tuple[bool, bool]
) -> FloatArray:
    """Return how far each node lies off the target shape along its normal, after the best fit (n_points,) [mm].

    points, target: the same nodes (n_points, 3) [mm] in the two shapes; positive: on the side the normals point to.
    """
    areas = nodal_areas(target, cells)
    size = np.linalg.norm(areas, axis=1)
    normals = areas / np.maximum(size, 1e-300)[:, None]
    off = fit_rigidly(points, target, size, planes) - target
    return np.asarray((off * normals).sum(axis=1))
