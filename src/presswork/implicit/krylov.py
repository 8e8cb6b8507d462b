# SPDX-License-Identifier: Apache-2.0
"""Stabilised bi-conjugate gradients for short time steps of heat, whose matrix the heat capacity conditions well.

Algorithm of van der Vorst (1992) with the diagonal as preconditioner. Sums are numpy's own, so that the bits do not
depend on the threads of a library.
"""

from __future__ import annotations

import numpy as np
import scipy

from presswork.model import FloatArray, IntArray

MOST_ITERATIONS = 80
"""Beyond which factors are cheaper."""


def solve_iteratively(
    indptr: IntArray, indices: IntArray, data: FloatArray, rhs: FloatArray, *, symmetric: bool, tolerance: float
) -> FloatArray | None:
    """Return the solution of a sparse system to a residual of `tolerance` times the right-hand side; None if it is far.

    symmetric: only one triangle of the matrix is stored.
    """
    n = len(rhs)
    matrix = scipy.sparse.csr_matrix((data, indices, indptr), shape=(n, n))
    diagonal = matrix.diagonal()
    if not (diagonal > 0.0).all():
        return None
    other = matrix.T.tocsr() if symmetric else None

    def multiply(x: FloatArray) -> FloatArray:
        product = matrix @ x
        return np.asarray(product if other is None else product + other @ x - diagonal * x)

    x, r = np.zeros(n), rhs.copy()
    shadow, p, v = rhs, np.zeros(n), np.zeros(n)
    rho = alpha = omega = 1.0
    goal = tolerance * _norm(rhs)
    for _ in range(MOST_ITERATIONS):
        if _norm(r) <= goal:
            return x
        rho_n, rho = rho, _sum(shadow, r)
        if rho == 0.0 or omega == 0.0:
            return None
        p = r + (rho / rho_n) * (alpha / omega) * (p - omega * v)
        direction = p / diagonal
        v = multiply(direction)
        alpha = rho / (_sum(shadow, v) or 1e-300)
        s = r - alpha * v
        second = s / diagonal
        t = multiply(second)
        omega = _sum(t, s) / (_sum(t, t) or 1e-300)
        x = x + alpha * direction + omega * second
        r = s - omega * t
    return None


def _sum(a: FloatArray, b: FloatArray) -> float:
    return float(np.einsum("i,i->", a, b))


def _norm(a: FloatArray) -> float:
    return float(np.sqrt(_sum(a, a)))
