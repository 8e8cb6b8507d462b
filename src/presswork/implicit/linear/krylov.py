# SPDX-License-Identifier: Apache-2.0
"""Krylov methods with a preconditioner. Sums run in one thread, so the bits do not depend on the number of threads."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from presswork.model import FloatArray

Operator = Callable[[FloatArray], FloatArray]
"""Multiplies a vector (n,) with a matrix."""

RESTART = 60
"""Directions that generalised minimal residuals keep."""


class NotDefiniteError(ArithmeticError):
    """Conjugate gradients met a direction along which the matrix is not positive."""


def solve_symmetric(
    matrix: Operator, preconditioner: Operator, rhs: FloatArray, *, tolerance: float, most: int
) -> tuple[FloatArray, int, float]:
    """Return solution, iterations and relative residual by conjugate gradients (Hestenes & Stiefel 1952).

    Raises NotDefiniteError.
    """
    x, r = np.zeros_like(rhs), rhs.copy()
    size = _norm(rhs)
    if size == 0.0:
        return x, 0, 0.0
    z = preconditioner(r)
    p, rz = z.copy(), _dot(r, z)
    for count in range(1, most + 1):
        q = matrix(p)
        curvature = _dot(p, q)
        if not (curvature > 0.0 and rz > 0.0):
            raise NotDefiniteError
        alpha = rz / curvature
        x += alpha * p
        r -= alpha * q
        if _norm(r) <= tolerance * size:
            return x, count, _norm(r) / size
        z = preconditioner(r)
        rz, before = _dot(r, z), rz
        p *= rz / before
        p += z
    return x, most, _norm(r) / size


def solve_unsymmetric(
    matrix: Operator, preconditioner: Operator, rhs: FloatArray, *, tolerance: float, most: int
) -> tuple[FloatArray, int, float]:
    """Return solution, iterations and relative residual by generalised minimal residuals (Saad & Schultz 1986)."""
    x, r = np.zeros_like(rhs), rhs.copy()
    size, count = _norm(rhs), 0
    residual = size
    while residual > tolerance * size and count < most:
        steps = min(RESTART, most - count)
        basis, scaled = [r / residual], []
        triangle, goal = np.zeros((steps + 1, steps)), np.zeros(steps + 1)
        turns, goal[0], k = np.zeros((steps, 2)), residual, 0
        while k < steps and abs(goal[k]) > tolerance * size:
            scaled.append(preconditioner(basis[k]))
            w = matrix(scaled[k])
            for i, v in enumerate(basis):
                triangle[i, k] = _dot(v, w)
                w -= triangle[i, k] * v
            length = _norm(w)
            for i, (c, s) in enumerate(turns[:k]):
                above, below = triangle[i, k], triangle[i + 1, k]
                triangle[i, k], triangle[i + 1, k] = c * above + s * below, c * below - s * above
            whole = float(np.hypot(triangle[k, k], length))
            if whole == 0.0:
                break
            turns[k] = triangle[k, k] / whole, length / whole
            triangle[k, k] = whole
            goal[k], goal[k + 1] = turns[k, 0] * goal[k], -turns[k, 1] * goal[k]
            basis.append(w / length if length > 0.0 else w)
            k += 1
        if k == 0:
            break
        share = np.zeros(k)
        for i in reversed(range(k)):
            share[i] = (goal[i] - _dot(triangle[i, i + 1 : k], share[i + 1 :])) / triangle[i, i]
        for part, z in zip(share, scaled, strict=True):
            x += part * z
        count += k
        r = rhs - matrix(x)
        residual = _norm(r)
    return x, count, residual / size if size else 0.0


def _dot(a: FloatArray, b: FloatArray) -> float:
    return float(np.einsum("i,i->", a, b))


def _norm(a: FloatArray) -> float:
    return float(np.sqrt(_dot(a, a)))
