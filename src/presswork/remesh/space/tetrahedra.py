# SPDX-License-Identifier: Apache-2.0
"""Tetrahedra as arrays: their skin, volumes and quality. A tetrahedron's fourth corner sees the first three clockwise:
the edges from its first corner have a positive triple product.
"""

from __future__ import annotations

import numpy as np

from presswork.model import CELLS, FloatArray, IndexArray, find_cell

_FACES = CELLS["tet4"].faces
_EDGES = np.sort(CELLS["tet4"].edges, axis=1)
_EDGES = _EDGES[np.lexsort(_EDGES.T[::-1])]
"""Ends of the edges in order."""


def find_skin(cells: IndexArray) -> tuple[IndexArray, IndexArray]:
    """Return the faces (k, 3) that one of the cells (n, 4) only has, and that cell (k,)."""
    faces = cells[:, _FACES].reshape(-1, 3)
    low, middle, high = np.sort(faces, axis=1).T.astype(np.int64)
    first_two = low * (int(cells.max(initial=-1)) + 1) + middle
    order = np.lexsort((high, first_two))
    first_two, high = first_two[order], high[order]
    same = (first_two[1:] == first_two[:-1]) & (high[1:] == high[:-1])
    shared = np.zeros(len(faces), dtype=bool)
    shared[1:] |= same
    shared[:-1] |= same
    own = np.sort(order[~shared])
    return faces[own], own // len(_FACES)


def measure_volumes(points: FloatArray, cells: IndexArray) -> FloatArray:
    """Return the volumes of cells (n, 4); negative where one is inside out (n,) [mm3]."""
    a, b, c = (points[cells[:, k]] - points[cells[:, 0]] for k in (1, 2, 3))
    return np.asarray(np.einsum("ni,ni->n", a, np.cross(b, c)) / 6.0)


def enclosed_volume(points: FloatArray, faces: IndexArray) -> float:
    """Return the volume within closed faces (k, 3), counter-clockwise seen from outside [mm3]."""
    middle = points[faces[:, 0]].mean(axis=0)  # near the body, so that little is lost to round-off
    a, b, c = (points[faces[:, k]] - middle for k in (0, 1, 2))
    return float(np.einsum("ni,ni->n", a, np.cross(b, c)).sum() / 6.0)


def area_vectors(points: FloatArray, faces: IndexArray) -> FloatArray:
    """Return the area of each face (k, 3) along its normal outwards (k, 3) [mm2]."""
    first, second = (points[faces[:, k]] - points[faces[:, 0]] for k in (1, 2))
    return np.asarray(0.5 * np.cross(first, second))


def nodal_areas(points: FloatArray, faces: IndexArray, which: IndexArray | None = None) -> FloatArray:
    """Return the area vector of each node, a third of its faces' (n_points, 3) [mm2]; which: faces that count."""
    own = faces if which is None else faces[which]
    areas, total = area_vectors(points, own) / 3.0, np.zeros_like(points)
    for k in range(3):
        np.add.at(total, own[:, k], areas)
    return total


def list_edges(simplices: IndexArray) -> IndexArray:
    """Return every edge of triangles or tetrahedra once (m, 2), the lower node first, in order."""
    pairs = find_cell(simplices.shape[1] - 1, simplices).edges
    low, high = np.sort(simplices[:, pairs].reshape(-1, 2), axis=1).T.astype(np.int64)
    n_points = int(simplices.max(initial=0)) + 1
    return np.stack(np.divmod(np.unique(low * n_points + high), n_points), axis=1).astype(simplices.dtype)


def measure_quality(points: FloatArray, cells: IndexArray) -> FloatArray:
    """Return the mean ratio 12 (3 V)^(2/3) / sum of the squared edges (Liu & Joe 1994) of cells (n, 4).

    1: regular, 0: flat, negative: inside out.
    """
    return rate_tetrahedra(points[cells])


def rate_tetrahedra(corners: FloatArray) -> FloatArray:
    """Return the same of tetrahedra with these corners (n, 4, 3) [mm]."""
    a, b, c = (corners[:, k] - corners[:, 0] for k in (1, 2, 3))
    volume = np.einsum("ni,ni->n", a, np.cross(b, c)) / 6.0
    edges = np.empty((len(corners), len(_EDGES), 3))
    for k, (first, second) in enumerate(_EDGES):
        np.subtract(corners[:, second], corners[:, first], out=edges[:, k])
    square = np.maximum(np.square(edges, out=edges).sum(axis=(1, 2)), 1e-300)
    return np.asarray(np.sign(volume) * 12.0 * np.cbrt(3.0 * np.abs(volume)) ** 2 / square)
