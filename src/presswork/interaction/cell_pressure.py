# SPDX-License-Identifier: Apache-2.0
"""Pressure on cells of shells along their present normals, with its stiffness."""

from __future__ import annotations

import numpy as np

from presswork.model import FloatArray, IntArray


def make_skew(v: FloatArray) -> FloatArray:
    """Return the matrices (..., 3, 3) that take w to v x w."""
    matrix = np.zeros((*v.shape, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        matrix[..., i, j], matrix[..., j, i] = -v[..., k], v[..., k]
    return matrix


def press_cells(
    points: FloatArray, cells: IntArray, shape: tuple[FloatArray, ...], pressure: float | FloatArray, force: FloatArray
) -> tuple[IntArray, FloatArray]:
    """Add p n over cells to force; return d(-force)/d(position) as node pairs and blocks (n, 6, 6).

    points: present (n_points, 3) [mm]; pressure: of all cells or of each (n,) [MPa]. shape: of the cells' element, as
    _core.shell_shape gives it. force: (n_points, 3 or more) [N], which is added to.
    """
    N, slopes, weights, _ = shape
    n = cells.shape[1]
    p = np.broadcast_to(np.asarray(pressure, dtype=float), len(cells))[:, None, None]
    base = np.einsum("qaj,cai->cqji", slopes, points[cells])
    normal = np.cross(base[:, :, 0], base[:, :, 1])
    np.add.at(force[:, :3], cells, p * np.einsum("q,qa,cqi->cai", weights, N, normal))
    first, second = make_skew(base[:, :, 0]), make_skew(base[:, :, 1])
    turning = np.einsum("qb,cqij->cqbij", slopes[:, :, 1], first) - np.einsum("qb,cqij->cqbij", slopes[:, :, 0], second)
    stiffness = np.zeros((len(cells), n, n, 6, 6))
    stiffness[..., :3, :3] = -p[..., None, None] * np.einsum("q,qa,cqbij->cabij", weights, N, turning)
    rows, columns = np.repeat(cells, n, axis=1), np.tile(cells, (1, n))
    pairs = np.stack([rows, columns], axis=-1).reshape(-1, 2).astype(np.int32)
    return np.ascontiguousarray(pairs), stiffness.reshape(-1, 6, 6)
