# SPDX-License-Identifier: Apache-2.0
"""Shape functions and quadrature on boundary edges (first end, last end[, mid-side])."""

from __future__ import annotations

import numpy as np

from presswork.model import FloatArray

GAUSS_3 = ((-np.sqrt(0.6), 5 / 9), (0.0, 8 / 9), (np.sqrt(0.6), 5 / 9))
"""Points s in [-1, 1] and weights."""


def edge_shape_functions(n_nodes: int, s: float) -> tuple[FloatArray, FloatArray]:
    """Return N and dN/ds, each (n_nodes,), at s in [-1, 1] of an edge with 2 or 3 nodes."""
    if n_nodes == 2:
        return np.array([0.5 * (1 - s), 0.5 * (1 + s)]), np.array([-0.5, 0.5])
    return np.array([0.5 * s * (s - 1), 0.5 * s * (s + 1), 1 - s * s]), np.array([s - 0.5, s + 0.5, -2 * s])
