# SPDX-License-Identifier: Apache-2.0
"""Strain of the middle surface of cells of a sheet between two instants, with its derivative by the later positions.

At the middle of a cell the metric a = g^T g of its base vectors g goes from a_n to a. With s the sum and d the
difference of the principal logarithmic strains, and no change of volume, the equivalent strain is

    e = sqrt(s^2 + d^2/3),   s = ln(det b)/2,   cosh d = c = tr b/(2 sqrt(det b)),   b = a_n^-1 a.
"""

from __future__ import annotations

import numpy as np

from presswork.model import FloatArray, IntArray

SMALL = 1e-6
"""Difference of strains below which d/sinh d is taken as 1."""


def find_slopes(cells: IntArray) -> FloatArray:
    """Return the slopes (n, 2, 4) of the corners of cells (n, 4) at their middles; a triangle has its last node twice.

    >>> find_slopes(np.array([[0, 1, 2, 2]])).tolist()
    [[[-1.0, 1.0, 0.0, 0.0], [-1.0, 0.0, 1.0, 0.0]]]
    """
    slopes = np.tile(0.25 * np.array([[-1.0, 1.0, 1.0, -1.0], [-1.0, -1.0, 1.0, 1.0]]), (len(cells), 1, 1))
    slopes[cells[:, 2] == cells[:, 3]] = [[-1.0, 1.0, 0.0, 0.0], [-1.0, 0.0, 1.0, 0.0]]
    return slopes


def find_strains(before: FloatArray, after: FloatArray, cells: IntArray) -> FloatArray:
    """Return the equivalent strains (n,) of cells (n, 4) from positions before to those after (n_points, 3) [mm].

    >>> flat = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> float(find_strains(flat, flat * [np.exp(0.1), np.exp(-0.05), 1.0], np.array([[0, 1, 2, 3]]))[0].round(12))
    0.1
    """
    return _find(before, after, cells)[0]


def find_strain_gradients(before: FloatArray, after: FloatArray, cells: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return find_strains and their derivatives by the positions of the corners (n, 4, 3) [1/mm].

    Where a cell has no strain its derivative is taken as zero.
    """
    strain, s, d, trace, inverse_n, inverse, base = _find(before, after, cells)
    cosh = np.cosh(d)
    ratio = np.where(np.abs(d) < SMALL, 1.0, d / np.sinh(np.maximum(np.abs(d), SMALL)))
    by_s = s / np.maximum(strain, 1e-300)
    by_c = ratio / (3.0 * np.maximum(strain, 1e-300))
    along = (0.5 * by_s - 0.5 * by_c * cosh)[:, None, None] * inverse + (by_c * cosh / trace)[:, None, None] * inverse_n
    return strain, 2.0 * np.einsum("cab,caj,cbi->cji", along, find_slopes(cells), base)


def _find(before: FloatArray, after: FloatArray, cells: IntArray) -> tuple[FloatArray, ...]:
    """Return strain, s, d, tr b, a_n^-1, a^-1, and the base vectors after (n, 2, 3)."""
    slopes = find_slopes(cells)
    base_n, base = (np.einsum("caj,cji->cai", slopes, x[cells]) for x in (before, after))
    metric_n, metric = (np.einsum("cai,cbi->cab", g, g) for g in (base_n, base))
    inverse_n = np.linalg.inv(metric_n)
    trace = np.einsum("cab,cba->c", inverse_n, metric)
    det = np.linalg.det(metric) / np.linalg.det(metric_n)
    s = 0.5 * np.log(det)
    d = np.arccosh(np.maximum(0.5 * trace / np.sqrt(det), 1.0))
    return np.sqrt(s**2 + d**2 / 3.0), s, d, trace, inverse_n, np.linalg.inv(metric), base
