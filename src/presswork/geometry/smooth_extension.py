# SPDX-License-Identifier: Apache-2.0
"""Values at all nodes of a surface from those at some of them, as smooth as can be."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix, diags, eye
from scipy.sparse.linalg import spsolve

from presswork.model import BoolArray, FloatArray, IntArray

_HELD = 1e-9
"""Weight of the values' own squares, for parts of the surface that touch no known node."""


def extend_smoothly(values: FloatArray, known: BoolArray, triangles: IntArray) -> FloatArray:
    """Return nodal values (n, k) with those that are not known (n,) found from their neighbours.

    The squares of the differences between a node and the mean of its neighbours are least: values go on with their
    slope where known nodes end, and pass smoothly from some to others.
    """
    if known.all() or not known.any():
        return values
    n = len(values)
    ends = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    ones = np.ones(2 * len(ends))
    joined = coo_matrix((ones, (np.concatenate([ends[:, 0], ends[:, 1]]), ends[:, ::-1].T.reshape(-1))), (n, n)).tocsr()
    joined.data[:] = 1.0
    count = np.asarray(joined.sum(axis=1)).ravel()
    rough = eye(n) - diags(1.0 / np.maximum(count, 1.0)) @ joined
    square = (rough.T @ rough + _HELD * eye(n)).tocsr()
    free = np.flatnonzero(~known)
    found = values.copy()
    right = -square[free][:, np.flatnonzero(known)] @ values[known]
    found[free] = spsolve(square[free][:, free].tocsc(), right).reshape(len(free), -1)
    return found
