# SPDX-License-Identifier: Apache-2.0
"""A surrogate for dear runs: a Gaussian process with Matern's kernel of order 5/2, a length for each input, and noise.

Rasmussen & Williams 2006, Gaussian Processes for Machine Learning: likelihood and its gradient (5.8, 5.9), errors of
points left out (5.12).
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import minimize

from presswork.model import FloatArray

ROOT5 = np.sqrt(5.0)
LENGTHS, SIZES, NOISE = (0.05, 100.0), (1e-2, 1e3), (1e-8, 1.0)
"""Bounds of lengths, of inputs whose standard deviation is 1, and of variances, of values whose variance is 1."""
BEGIN = ((1.0, 1e-4), (4.0, 1e-2))
"""Length and noise from which the likelihood is climbed."""
AT_ONCE = 4096
"""Points that are predicted at a time."""


class GaussianProcess:
    """A function through values y (n,) measured at points x (n, d)."""

    def __init__(self, x: FloatArray, y: FloatArray) -> None:
        self._middle, self._spread = x.mean(axis=0), np.maximum(x.std(axis=0), 1e-300)
        self._mean, self._size = float(y.mean()), max(float(y.std()), 1e-300)
        self._x, values = (x - self._middle) / self._spread, (y - self._mean) / self._size
        bounds = np.log([*[LENGTHS] * x.shape[1], SIZES, NOISE])
        climbed = [
            minimize(
                lambda found: self._find_likelihood(found, values),
                np.log([*[length] * x.shape[1], 1.0, noise]),
                jac=True,
                method="L-BFGS-B",
                bounds=bounds,
            )
            for length, noise in BEGIN
        ]
        self._best: FloatArray = min(climbed, key=lambda found: float(found.fun)).x
        self._factor = cho_factor(self._find_covariance(self._best)[0], lower=True)
        self._weights = cho_solve(self._factor, values)
        left_out = self._size * self._weights / np.diag(cho_solve(self._factor, np.eye(len(y))))
        around = float(((y - self._mean) ** 2).sum())
        self.explained = 1.0 - float((left_out**2).sum()) / max(around, 1e-300)
        """Part of the variance that the function through the others foretells; below 0 the mean is better."""

    def __call__(self, x: FloatArray) -> FloatArray:
        """Return values at points (n, d)."""
        parts = [covariance @ self._weights for covariance in self._find_covariances(x)]
        return np.asarray(self._mean + self._size * np.concatenate([*parts, np.zeros(0)]))

    def find_deviation(self, x: FloatArray) -> FloatArray:
        """Return the standard deviation of what was measured about the values at points (n, d)."""
        known = [
            (covariance * cho_solve(self._factor, covariance.T).T).sum(axis=1)
            for covariance in self._find_covariances(x)
        ]
        size, noise = np.exp(self._best[-2:])
        return np.asarray(self._size * np.sqrt(np.maximum(size + noise - np.concatenate(known), 0.0)))

    def _find_covariances(self, x: FloatArray) -> Iterator[FloatArray]:
        """Yield the covariances of points (n, d) with those that were measured, some rows at a time."""
        scaled = (x - self._middle) / self._spread
        lengths, size = np.exp(self._best[:-2]), np.exp(self._best[-2])
        for a, b in pairwise([*range(0, len(x), AT_ONCE), len(x)]):
            yield size * _correlate(scaled[a:b], self._x, lengths)[0]

    def _find_covariance(self, parameters: FloatArray) -> tuple[FloatArray, list[FloatArray]]:
        """Return the covariance of the points (n, n), and its derivatives by the parameters.

        parameters: logarithms of the lengths (d), of the variance and of the noise's.
        """
        size, noise = np.exp(parameters[-2:])
        correlation, slope, squares = _correlate(self._x, self._x, np.exp(parameters[:-2]))
        own = noise * np.eye(len(self._x))
        return size * correlation + own, [*(size * slope * each for each in squares), size * correlation, own]

    def _find_likelihood(self, parameters: FloatArray, values: FloatArray) -> tuple[float, FloatArray]:
        """Return the negative logarithm of the likelihood without its constant, and its gradient."""
        covariance, derivatives = self._find_covariance(parameters)
        try:
            factor = cho_factor(covariance, lower=True)
        except np.linalg.LinAlgError:
            return 1e10, np.zeros(len(parameters))
        weights, inverse = cho_solve(factor, values), cho_solve(factor, np.eye(len(values)))
        gain = inverse - np.outer(weights, weights)
        likelihood = 0.5 * values @ weights + np.log(np.diag(factor[0])).sum()
        return float(likelihood), np.array([0.5 * float((gain * each).sum()) for each in derivatives])


def _correlate(a: FloatArray, b: FloatArray, lengths: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return correlations of points (n, m), their slopes by squared distance, and the squares by input (d, n, m)."""
    squares = ((a.T[:, :, None] - b.T[:, None, :]) / lengths[:, None, None]) ** 2
    distance = ROOT5 * np.sqrt(squares.sum(axis=0))
    decay = np.exp(-distance)
    return (1.0 + distance + distance**2 / 3.0) * decay, (5.0 / 3.0) * (1.0 + distance) * decay, squares
