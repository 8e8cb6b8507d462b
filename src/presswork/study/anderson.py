# SPDX-License-Identifier: Apache-2.0
"""Anderson's acceleration of a fixed-point iteration."""

from __future__ import annotations

import numpy as np

from presswork.model import FloatArray

_KEPT = 3
"""Differences of steps that are combined."""
_DAMPING = 0.07
"""Weight of the shares' own squares, over the root sum of squares of all differences of residuals."""


class Anderson:
    """Finds x where a residual vanishes, of which x - residual(x) is a better x.

    Anderson (1965), Iterative procedures for nonlinear integral equations, J. ACM 12, 547, as written by Walker and Ni
    (2011), Anderson acceleration for fixed-point iterations, SIAM J. Numer. Anal. 49, 1715. The least squares are
    damped (Scieur, d'Aspremont and Bach 2016, Regularized nonlinear acceleration): differences that are nearly alike
    would else be distinguished by their noise. A residual that has grown forgets what was before.
    """

    def __init__(self, weight: FloatArray) -> None:
        """weight: of each value's square (n,)."""
        self._root = np.sqrt(weight / weight.sum())[:, None]
        self._x: list[FloatArray] = []
        self._residual: list[FloatArray] = []

    def step(self, x: FloatArray, residual: FloatArray) -> FloatArray:
        """Return the next x (n, k)."""
        if self._residual and np.linalg.norm(self._root * residual) > np.linalg.norm(self._root * self._residual[-1]):
            self._x, self._residual = [], []
        self._x.append(x)
        self._residual.append(residual)
        del self._x[: -_KEPT - 1], self._residual[: -_KEPT - 1]
        if len(self._x) == 1:
            return x - residual
        moved, changed = np.diff(np.array(self._x), axis=0), np.diff(np.array(self._residual), axis=0)
        columns = (self._root * changed).reshape(len(changed), -1).T
        square = columns.T @ columns
        square += _DAMPING**2 * np.trace(square) * np.eye(len(square))
        share, *_ = np.linalg.lstsq(square, columns.T @ (self._root * residual).ravel(), rcond=None)
        return np.asarray(x - residual - np.einsum("m,mnk->nk", share, moved - changed))
