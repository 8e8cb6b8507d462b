# SPDX-License-Identifier: Apache-2.0
"""Draws of inputs: points of the unit cube, made correlated by a Gaussian copula, and taken to each distribution."""

from __future__ import annotations

import numpy as np
from scipy import stats
from scipy.stats import qmc

from presswork.model import FloatArray
from presswork.study.scatter.study_file import Input, Method, ScatterStudy

EDGE = 1e-12
"""Distance of probabilities from 0 and 1."""


def draw_points(n: int, dimension: int, method: Method = "latin_hypercube", seed: int = 1) -> FloatArray:
    """Return points of the unit cube (n, dimension)."""
    random = np.random.default_rng(seed)
    if method == "latin_hypercube":
        strata = np.array([random.permutation(n) for _ in range(dimension)]).reshape(dimension, n).T
        points = (strata + random.random((n, dimension))) / n
    elif method == "sobol":  # moved as a whole: evenly spread, and without the point at the corner
        even = qmc.Sobol(dimension, scramble=False).random_base2((n - 1).bit_length())[:n]
        points = (even + random.random(dimension)) % 1.0
    else:
        points = random.random((n, dimension))
    return np.clip(points, EDGE, 1.0 - EDGE)


class Draws:
    """Values of a study's inputs by points of the unit cube.

    coils: measured values (n_coils, n) of the inputs that take a column.
    """

    def __init__(self, study: ScatterStudy, coils: FloatArray) -> None:
        self._inputs, self._drawn, self._coils = study.inputs, study.drawn, coils
        self._measured = tuple(index for index, each in enumerate(study.inputs) if each.column)
        matrix = study.correlation_matrix()
        self._root = np.linalg.cholesky(matrix) if len(matrix) else matrix
        self.are_independent = not study.correlations and len(self._measured) < 2
        """Whether each input varies by itself."""

    @property
    def dimension(self) -> int:
        """Number of a point's coordinates: one for each input with a distribution, and one for the choice of a coil."""
        return len(self._drawn) + bool(self._measured)

    def values_at(self, points: FloatArray, narrowed: int | None = None, factor: float = 1.0) -> FloatArray:
        """Return the inputs' values (n, n_inputs) at points (n, dimension).

        narrowed: an input whose deviation is taken so many times, about its median.
        """
        values = np.empty((len(points), len(self._inputs)))
        normal = stats.norm.ppf(points[:, : len(self._drawn)]) @ self._root.T
        for place, index in enumerate(self._drawn):
            share = factor if index == narrowed else 1.0
            values[:, index] = find_quantile(self._inputs[index], stats.norm.cdf(share * normal[:, place]))
        if self._measured:
            row = np.minimum((points[:, -1] * len(self._coils)).astype(int), len(self._coils) - 1)
            values[:, self._measured] = self._coils[row]
            for place, index in enumerate(self._measured):
                if index == narrowed:
                    middle = np.median(self._coils[:, place])
                    values[:, index] = middle + factor * (values[:, index] - middle)
        return values


def find_quantile(of: Input, probability: FloatArray) -> FloatArray:
    """Return values of an input below which a part of its distribution lies (n,).

    >>> thickness = Input(key="blank.thickness", mean=0.8, deviation=0.01)
    >>> find_quantile(thickness, np.array([0.5, 0.8413447])).round(6).tolist()
    [0.8, 0.81]
    """
    low, high = of.bounds
    if of.distribution == "uniform":
        return low + probability * (high - low)
    mean, deviation = of.moments
    if of.distribution == "lognormal":
        spread = np.sqrt(np.log1p((deviation / mean) ** 2))
        whole = stats.lognorm(s=spread, scale=mean * np.exp(-0.5 * spread**2))
    else:
        whole = stats.norm(mean, deviation)
    first, last = float(whole.cdf(low)), float(whole.cdf(high))
    return np.asarray(whole.ppf(first + probability * (last - first)), dtype=float)
