# SPDX-License-Identifier: Apache-2.0
"""Shape functions and quadrature on boundary edges (first end, last end[, mid-side])."""

from __future__ import annotations

import numpy as np

from presswork.model import FloatArray, IntArray

GAUSS_3 = ((-np.sqrt(0.6), 5 / 9), (0.0, 8 / 9), (np.sqrt(0.6), 5 / 9))
"""Points s in [-1, 1] and weights."""


def edge_shape_functions(n_nodes: int, s: float) -> tuple[FloatArray, FloatArray]:
    """Return N and dN/ds, each (n_nodes,), at s in [-1, 1] of an edge with 2 or 3 nodes."""
    if n_nodes == 2:
        return np.array([0.5 * (1 - s), 0.5 * (1 + s)]), np.array([-0.5, 0.5])
    return np.array([0.5 * s * (s - 1), 0.5 * s * (s + 1), 1 - s * s]), np.array([s - 0.5, s + 0.5, -2 * s])


def edge_areas(points: FloatArray, edges: IntArray, thickness: float | None) -> FloatArray:
    """Return the area that each node of each edge stands for, int N dA (n_edges, n_nodes) [mm2].

    points (n_points, 2); thickness [mm]: out of the plane; None: the edges are rings about the axis.
    """
    x, n = points[edges], edges.shape[1]
    if n == 2:
        along = x[:, 1] - x[:, 0]
        half = 0.5 * np.sqrt((along * along).sum(axis=1))[:, None]
        if thickness is not None:
            return np.repeat(half * thickness, 2, axis=1)
        radius = x[:, :, 0]
        return np.asarray(2.0 * np.pi / 3.0 * half * (radius + radius.sum(axis=1, keepdims=True)))
    areas = np.zeros(edges.shape)
    length = 0.5 * np.linalg.norm(x[:, 1] - x[:, 0], axis=1)  # by s, of a straight edge everywhere
    for s, weight in GAUSS_3:
        N, dN = edge_shape_functions(n, s)
        if n > 2:
            length = np.linalg.norm(np.einsum("a,eai->ei", dN, x), axis=1)
        width = 2.0 * np.pi * (x[:, :, 0] @ N) if thickness is None else thickness
        areas += weight * (length * width)[:, None] * N
    return areas
