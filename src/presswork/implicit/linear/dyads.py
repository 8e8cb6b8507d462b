# SPDX-License-Identifier: Apache-2.0
"""Parts c r^T of a tangent that couple all nodes, such as the pressure of a fluid that the whole sheet compresses.

They would fill the matrix, so they stay outside of it. With K y = b and K Z = C (Sherman, Morrison and Woodbury),

    (K + C R^T) x = b,        x = y - Z (I + R^T Z)^-1 R^T y.

Beside K the whole matrix has so many fewer negative eigenvalues as I + R^T Z has, where C and R are alike (Sylvester).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from presswork.model import FloatArray


class Dyads:
    """The dyads of one matrix that has been factorised."""

    def __init__(self, rows: Sequence[FloatArray], answers: FloatArray) -> None:
        """rows: R (n_points, freedoms) each; answers: Z (k, n_points, freedoms), both in the nodes' own frames."""
        self._rows = np.array(rows).reshape(len(rows), -1)
        self._answers = answers.reshape(len(rows), -1)
        self._core = np.eye(len(rows)) + self._rows @ self._answers.T

    @property
    def n_negative(self) -> int:
        """Number of negative eigenvalues of I + R^T Z."""
        return int((np.linalg.eigvals(self._core).real < 0.0).sum())

    def correct(self, solutions: FloatArray) -> FloatArray:
        """Return the solutions (k, n_points, freedoms) of the whole matrix, by those of what has been factorised."""
        flat = solutions.reshape(len(solutions), -1)
        shares = np.linalg.solve(self._core, self._rows @ flat.T)
        return np.asarray((flat - shares.T @ self._answers).reshape(solutions.shape))
