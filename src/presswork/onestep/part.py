# SPDX-License-Identifier: Apache-2.0
"""The finished part as the one-step solver sees it: triangles in their planes, nodal normals, curvature."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.model import BoolArray, FloatArray, IntArray


class OneStepError(Exception):
    """The blank could not be found."""


@dataclass(frozen=True)
class PartSurface:
    """The finished part's mid-surface, prepared for the solver."""

    points: FloatArray
    """(n_nodes, 3) [mm]."""
    triangles: IntArray
    """(n, 3), counter-clockwise as the normals see them."""
    share: FloatArray
    """Part of each triangle that counts (n,): 1/2 for a quadrilateral's four, which overlap."""
    normals: FloatArray
    """Normals of the nodes (n_nodes, 3), unit."""
    axes: FloatArray
    """Axes of the triangles (n, 2, 3), unit, in their planes."""
    edges: FloatArray
    """Edges 01 and 02 as columns in these axes (n, 2, 2) [mm]."""
    curvature: FloatArray
    """xx, yy, xy in these axes, above zero where the side of the normal is stretched (n, 3) [1/mm]."""

    @property
    def areas(self) -> FloatArray:
        """What each triangle counts (n,) [mm2]."""
        twice = self.edges[:, 0, 0] * self.edges[:, 1, 1] - self.edges[:, 0, 1] * self.edges[:, 1, 0]
        return np.asarray(0.5 * self.share * twice)

    @property
    def nodal_areas(self) -> FloatArray:
        """Area of the surface that belongs to each node (n_nodes,) [mm2]."""
        third = np.repeat(self.areas / 3.0, 3)
        return np.asarray(np.bincount(self.triangles.ravel(), third, minlength=len(self.points)))


def prepare_part(
    points: FloatArray,
    triangles: IntArray,
    quadrilaterals: IntArray,
    *,
    held: tuple[BoolArray, BoolArray] | None = None,
    with_bending: bool = True,
    normals: FloatArray | None = None,
) -> PartSurface:
    """Prepare a part's mesh. Quadrilaterals are cut along both diagonals, each cut counting half.

    points (n_nodes, 3); triangles (n, 3) and quadrilaterals (m, 4), all with their normals to the same side. held:
    nodes on symmetry planes normal to x | y, in which their normals lie. normals: of the nodes, unit (n_nodes, 3);
    without them, those of the triangles round each node.
    """
    q = quadrilaterals.reshape(-1, 4)
    halves = [q[:, [0, 1, 2]], q[:, [0, 2, 3]], q[:, [0, 1, 3]], q[:, [1, 2, 3]]]
    cells = np.ascontiguousarray(np.concatenate([triangles.reshape(-1, 3), *halves]), dtype=np.int32)
    share = np.concatenate([np.ones(len(triangles)), np.full(4 * len(q), 0.5)])
    first, second = (points[cells[:, i]] - points[cells[:, 0]] for i in (1, 2))
    normal = np.cross(first, second)
    length = np.linalg.norm(first, axis=1)
    x = first / length[:, None]
    y = np.cross(normal, x) / np.linalg.norm(normal, axis=1)[:, None]
    axes = np.stack([x, y], axis=1)
    edges = np.stack([np.einsum("nai,ni->na", axes, e) for e in (first, second)], axis=2)
    nodal = np.zeros_like(points) if normals is None else normals.copy()
    for corner in range(3) if normals is None else ():
        np.add.at(nodal, cells[:, corner], share[:, None] * normal)
    for i, on_plane in enumerate(held or ()):
        nodal[on_plane, i] = 0.0
    nodal /= np.maximum(np.linalg.norm(nodal, axis=1, keepdims=True), 1e-300)
    curvature = _find_curvature(points, cells, nodal, axes) if with_bending else np.zeros((len(cells), 3))
    return PartSurface(points, cells, share, nodal, axes, np.ascontiguousarray(edges), curvature)


def _find_curvature(points: FloatArray, cells: IntArray, normals: FloatArray, axes: FloatArray) -> FloatArray:
    """Fit the symmetric B of dn = B dx to the three edges of each triangle; shape (n, 3): xx, yy, xy."""
    rows, right = [], []
    for a, b in ((0, 1), (1, 2), (2, 0)):
        dx = np.einsum("nai,ni->na", axes, points[cells[:, b]] - points[cells[:, a]])
        dn = np.einsum("nai,ni->na", axes, normals[cells[:, b]] - normals[cells[:, a]])
        zero = np.zeros(len(cells))
        rows += [np.stack([dx[:, 0], zero, dx[:, 1]], axis=1), np.stack([zero, dx[:, 1], dx[:, 0]], axis=1)]
        right += [dn[:, 0], dn[:, 1]]
    matrix, values = np.stack(rows, axis=1), np.stack(right, axis=1)
    normal_matrix = np.einsum("nki,nkj->nij", matrix, matrix)
    return np.asarray(np.linalg.solve(normal_matrix, np.einsum("nki,nk->ni", matrix, values)[..., None])[..., 0])
