# SPDX-License-Identifier: Apache-2.0
"""Boundary faces of solids in space: quadrilaterals of hexahedra, triangles of tetrahedra, wound outwards.

The faces of 10-node tetrahedra have their corners first, then the middles of the sides 01, 12 and 20. Integrals over
them take the values there, a third of the area each (exact to degree 2 on flat faces): an even pressure loads the
mid-side nodes alone, and corners stand for no area.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from presswork.model import CELLS, FloatArray, IntArray, find_cell, take_corners

_GAUSS_2 = (-np.sqrt(1 / 3), np.sqrt(1 / 3))


def list_cell_faces(connectivity: IntArray) -> IntArray:
    """Return the faces of every cell one after the other: six of a hexahedron (6 n_cells, 4), four of a tetrahedron
    (4 n_cells, 3 | 6).
    """
    faces = find_cell(3, connectivity).faces
    return connectivity[:, faces].reshape(-1, faces.shape[1])


def find_boundary_faces(connectivities: Sequence[IntArray]) -> tuple[IntArray, IntArray]:
    """Return the faces that one cell only has (n, 3 | 4 | 6), and the number of that cell (n,), through the blocks.

    All blocks are of one kind of cell.
    """
    faces = np.concatenate([list_cell_faces(connectivity) for connectivity in connectivities])
    corners = np.sort(take_corners(faces), axis=1)
    order = np.lexsort(corners.T)
    differs = np.ones(len(order) + 1, dtype=bool)  # from the face before, in this order
    differs[1:-1] = (corners[order[1:]] != corners[order[:-1]]).any(axis=1)
    own = np.sort(order[differs[1:] & differs[:-1]])
    faces_of_cell = len(find_cell(3, connectivities[0]).faces)
    return np.ascontiguousarray(faces[own], dtype=np.int32), (own // faces_of_cell).astype(np.int32)


def split_faces(faces: IntArray) -> IntArray:
    """Return triangles (n, 3) that cover faces between their corners."""
    return np.concatenate([faces[:, corners] for corners in find_cell(2, faces).simplices])


def take_bearing(faces: IntArray) -> IntArray:
    """Return the nodes of faces that stand for area (n, 3 | 4): all, or the middles of the sides of 6-node ones."""
    return faces[:, 3:] if _takes_middles(faces) else faces


def find_face_middles(points: FloatArray, faces: IntArray) -> FloatArray:
    """Return where the middles of faces are (n_faces, 3) [mm]."""
    corners = points[take_corners(faces)].mean(axis=1)
    if not _takes_middles(faces):
        return np.asarray(corners)
    return np.asarray((4.0 * points[faces[:, 3:]].mean(axis=1) - corners) / 3.0)


def select_faces(faces: IntArray, nodes: IntArray) -> IntArray:
    """Return the faces all of whose nodes are among the nodes given."""
    return faces[np.isin(faces, nodes).all(axis=1)]


def face_areas(points: FloatArray, faces: IntArray) -> FloatArray:
    """Return the area that each node of each face stands for, int N dA (n_faces, 3 | 4 | 6) [mm2]."""
    areas = np.zeros(faces.shape)
    for N, dN in _rule(faces):
        first, second = np.einsum("ja,fai->jfi", dN, points[faces])
        areas += np.linalg.norm(np.cross(first, second), axis=1)[:, None] * N
    return areas


def nodal_normals(points: FloatArray, faces: IntArray, weight: FloatArray | None = None) -> FloatArray:
    """Return the outward area vector of each node, int N n dA over the faces (n_points, 3) [mm2].

    weight: of each face (n_faces,); None: 1.
    """
    normals = np.zeros_like(points)
    whole = 1.0 if weight is None else weight[:, None, None]
    for N, dN in _rule(faces):
        first, second = np.einsum("ja,fai->jfi", dN, points[faces])
        np.add.at(normals, faces, whole * N[None, :, None] * np.cross(first, second)[:, None])
    return normals


def press_faces(points: FloatArray, faces: IntArray, pressure: float) -> tuple[FloatArray, FloatArray]:
    """Return the nodal forces (n_faces, k, 3) [N] of a pressure [MPa] against faces, and its stiffness.

    The stiffness is d(-force)/d(position), (n_faces, k, k, 3, 3) by nodes and components. points (n_points, 3): where
    the nodes are. With the tangents t of the face the force is -p int N t_1 x t_2.
    """
    x = points[faces]
    force, stiffness = np.zeros(x.shape), np.zeros((*faces.shape, faces.shape[1], 3, 3))
    for N, dN in _rule(faces):
        first, second = np.einsum("ja,fai->jfi", dN, x)
        force -= pressure * np.einsum("a,fi->fai", N, np.cross(first, second))
        # d(t_1 x t_2) = dN_1 (dx x t_2) - dN_2 (dx x t_1)
        along = dN[0][None, :, None] * second[:, None] - dN[1][None, :, None] * first[:, None]
        stiffness += pressure * np.einsum("a,fbij->fabij", N, _cross_matrix(along))
    return force, stiffness


def _rule(faces: IntArray) -> list[tuple[FloatArray, FloatArray]]:
    """Return shape functions (k,) times the weight and their derivatives (2, k) at the points of the faces' rule."""
    cell = find_cell(2, faces)
    if _takes_middles(faces):
        return _rule_of_middles()
    if cell.is_quadratic:
        rule = cell.rules[max(cell.rules)]
        return [(w * N, dN.T) for w, N, dN in zip(rule.weights, rule.shapes, rule.slopes, strict=True)]
    if cell.is_simplex:
        return [(np.full(3, 1.0 / 6.0), np.array([[-1.0, 1.0, 0.0], [-1.0, 0.0, 1.0]]))]
    corner, found = cell.places, []
    for r in _GAUSS_2:
        for s in _GAUSS_2:
            one, two = 0.5 * (1 + corner[:, 0] * r), 0.5 * (1 + corner[:, 1] * s)
            found.append((one * two, 0.5 * np.stack([corner[:, 0] * two, corner[:, 1] * one])))
    return found


def _takes_middles(faces: IntArray) -> bool:
    """Return whether integrals over faces take the values in the middle of their sides."""
    return find_cell(2, faces).name == "tri6"


def _rule_of_middles() -> list[tuple[FloatArray, FloatArray]]:
    """Return the same for the middles of the sides of 6-node triangles, where only their own nodes count."""
    found = []
    slopes = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])  # of the corners' shares
    edges = CELLS["tri6"].edges.tolist()
    for *ends, middle in edges:
        share, dN = np.zeros(3), np.zeros((2, 6))
        share[ends] = 0.5
        dN[:, :3] = (slopes * (4.0 * share - 1.0)[:, None]).T
        for a, b, side in edges:
            dN[:, side] = 4.0 * (slopes[a] * share[b] + share[a] * slopes[b])
        N = np.zeros(6)
        N[middle] = 1.0 / 6.0
        found.append((N, dN))
    return found


def _cross_matrix(v: FloatArray) -> FloatArray:
    """Return the matrices (..., 3, 3) that take dx to dx x v."""
    zero = np.zeros(v.shape[:-1])
    x, y, z = np.moveaxis(v, -1, 0)
    return np.stack([zero, z, -y, -z, zero, x, y, -x, zero], axis=-1).reshape(*v.shape[:-1], 3, 3)
