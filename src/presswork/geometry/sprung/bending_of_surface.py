# SPDX-License-Identifier: Apache-2.0
"""How much a small displacement bends and stretches a surface of triangles, edge by edge.

Bending is the change of the angle between the two triangles at an edge (Bridson, Marino and Fedkiw 2003, Simulation of
clothing with folds and wrinkles, SCA 2003), in the measure of Grinspun et al. (2003, Discrete shells): the sum of the
squares of all rows is in proportion to the integral of the squared change of curvature, three times it where squares
are cut in two. Stretching is the change of an edge's length. Both are linear in the displacement, and no rigid motion
changes them. Symmetry planes are taken in by images.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from presswork.model import FloatArray, IntArray

_ON_PLANE = 1e-6
"""Distance from a symmetry plane over the surface's size, within which a point lies on it."""


@dataclass(frozen=True)
class SurfaceEdges:
    """Rows of a surface's edges, for displacements as (3 n_points,) with x, y, z of each point."""

    bending: sparse.csr_matrix
    """A row for each inner edge, images included (n_inner, 3 n_points) [1/mm]."""
    ends: IntArray
    """Points at the ends of each inner edge (n_inner, 2)."""
    stretching: sparse.csr_matrix
    """A row for each edge: strain times the root of the edge's part of the area (n_edges, 3 n_points)."""


def find_edges(points: FloatArray, triangles: IntArray, planes: tuple[bool, bool]) -> SurfaceEdges:
    """Return the rows of the edges of a surface: points (n_points, 3) [mm], triangles (n, 3), wound alike.

    planes: symmetry planes x = 0 | y = 0, across which the surface goes on.
    """
    full, cells, origin, fold = _add_images(points, triangles, planes)
    one, other, ends = _pair_triangles(cells)
    rows, measure = _bend(full, ends, one, other)
    corners = np.stack([one, other, ends[:, 0], ends[:, 1]], axis=1)
    bending = _assemble(measure[:, None, None] * rows, corners, len(full)) @ fold
    edges = np.unique(np.sort(np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]]), axis=1), axis=0)
    along = full[edges[:, 1]] - full[edges[:, 0]]
    share = np.sqrt(_areas(full, cells).sum() / len(edges))
    along *= (share / (along**2).sum(axis=1))[:, None]
    stretching = _assemble(np.stack([-along, along], axis=1), edges, len(full)) @ fold
    return SurfaceEdges(bending.tocsr(), origin[ends], stretching.tocsr())


def _add_images(
    points: FloatArray, triangles: IntArray, planes: tuple[bool, bool]
) -> tuple[FloatArray, IntArray, IntArray, sparse.csr_matrix]:
    """Return the whole surface, which point each is an image of, and its displacement from that of the points."""
    near = _ON_PLANE * float(np.ptp(points, axis=0).max())
    origin = np.arange(len(points))
    signs = np.ones_like(points)
    for axis in (0, 1):
        if not planes[axis]:
            continue
        own = np.abs(points[:, axis]) <= near
        number = np.arange(len(points))
        number[~own] = len(points) + np.arange(int((~own).sum()))
        flip = np.where(np.arange(3) == axis, -1.0, 1.0)
        points = np.concatenate([points, points[~own] * flip])
        signs = np.concatenate([signs, signs[~own] * flip])
        signs[: len(own)][own, axis] = 0.0  # a point on the plane stays there
        triangles = np.concatenate([triangles, number[triangles][:, ::-1]])
        origin = np.concatenate([origin, origin[~own]])
    column = (3 * origin[:, None] + np.arange(3)).ravel()
    shape = (3 * len(points), 3 * (int(origin.max()) + 1))
    fold = sparse.csr_matrix((signs.ravel(), (np.arange(shape[0]), column)), shape)
    return points, triangles.astype(np.int32), origin.astype(np.int32), fold


def _pair_triangles(cells: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """Return the corners off each inner edge on its two sides, and the edge's ends (n, 2)."""
    ends = np.sort(np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]]), axis=1)
    off = np.concatenate([cells[:, 2], cells[:, 0], cells[:, 1]])
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    ends, off = ends[order], off[order]
    first = np.flatnonzero((ends[1:] == ends[:-1]).all(axis=1))
    return off[first], off[first + 1], ends[first]


def _bend(x: FloatArray, ends: IntArray, one: IntArray, other: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return how the angle at each edge follows its four points (n, 4, 3), and the measure's factor (n,)."""
    p, q, a, b = x[ends[:, 0]], x[ends[:, 1]], x[one], x[other]
    edge = q - p
    length = np.linalg.norm(edge, axis=1)[:, None]
    left, right = np.cross(p - a, q - a), np.cross(q - b, p - b)
    twice = [np.linalg.norm(normal, axis=1) for normal in (left, right)]
    left, right = left / (twice[0] ** 2)[:, None], right / (twice[1] ** 2)[:, None]
    dot = [(((c - end) * edge).sum(axis=1))[:, None] / length for c, end in ((a, q), (b, q), (a, p), (b, p))]
    rows = [length * left, length * right, dot[0] * left + dot[1] * right, -dot[2] * left - dot[3] * right]
    return np.stack(rows, axis=1), np.sqrt(6.0 / (twice[0] + twice[1])) * length[:, 0]


def _assemble(rows: FloatArray, corners: IntArray, count: int) -> sparse.csr_matrix:
    """Return a matrix of rows (n, k, 3) that belong to the points of corners (n, k)."""
    column = (3 * corners[:, :, None] + np.arange(3)).ravel()
    row = np.repeat(np.arange(len(rows)), 3 * corners.shape[1])
    return sparse.csr_matrix((rows.ravel(), (row, column)), (len(rows), 3 * count))


def _areas(points: FloatArray, cells: IntArray) -> FloatArray:
    a, b, c = (points[cells[:, k]] for k in range(3))
    return np.asarray(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1))
