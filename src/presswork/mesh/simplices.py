# SPDX-License-Identifier: Apache-2.0
"""Cells as simplices of their corners: triangles in the plane and of sheets, tetrahedra in space."""

from __future__ import annotations

import numpy as np
import scipy

from presswork.model import FloatArray, IndexArray, Mesh, cell_of

NEAREST = 64
"""Simplices with the nearest middles, among which the one that holds a place is looked for."""


def list_simplices(mesh: Mesh) -> IndexArray:
    """Return the nodes of simplices that cover all cells (n, 3), in space (n, 4)."""
    parts = []
    for block in mesh.blocks:
        simplices = cell_of(block.element).simplices
        parts.append(block.connectivity[:, simplices].reshape(-1, simplices.shape[1]))
    return np.concatenate(parts).astype(np.intp)


def find_simplices(mesh: Mesh, position: FloatArray, places: FloatArray) -> tuple[IndexArray, FloatArray, FloatArray]:
    """Return nodes (n, k) of the simplices that hold places (n, d), the shares in them (n, k), and how far outside
    each place lies (n,) [mm].
    """
    simplices = list_simplices(mesh)
    tree = scipy.spatial.cKDTree(position[simplices].mean(axis=1))
    _, near = tree.query(places, k=min(NEAREST, len(simplices)))
    near = near.reshape(len(places), -1)
    nodes = np.zeros((len(places), simplices.shape[1]), dtype=np.intp)
    share, outside = np.zeros(nodes.shape), np.zeros(len(places))
    for number, (place, candidates) in enumerate(zip(places, near, strict=True)):
        shares, distance = measure_shares(position[simplices[candidates]], place)
        best = int(np.argmin(distance))
        nodes[number], share[number], outside[number] = simplices[candidates[best]], shares[best], distance[best]
    return nodes, share, outside


def measure_shares(corners: FloatArray, place: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the shares of a place (d,) in simplices (n, k, d), (n, k), a bound for how far outside it is (n,) [mm].

    A triangle in space takes the foot of the place in its plane; the distance from the plane counts.
    """
    edges = np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2)
    away = place - corners[:, 0]
    inner = np.einsum("nkd,nd->nk", np.linalg.pinv(edges), away)
    shares = np.column_stack([1.0 - inner.sum(axis=1), inner])
    held = np.clip(shares, 0.0, None)
    held /= held.sum(axis=1, keepdims=True)
    distance = np.linalg.norm(np.einsum("nk,nkd->nd", held, corners) - place, axis=1)
    return shares, np.asarray(
        np.where(
            shares.min(axis=1) >= -1e-12,
            np.linalg.norm(np.einsum("nk,nkd->nd", shares, corners) - place, axis=1),
            distance,
        )
    )
