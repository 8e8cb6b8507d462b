# SPDX-License-Identifier: Apache-2.0
"""Cubic splines through points of the plane."""

from __future__ import annotations

import numpy as np

from presswork.model import FloatArray


class CubicSpline:
    """A cubic spline through points, whose third derivative is continuous at the second and the last but one.

    These are the ends of de Boor (2001, A Practical Guide to Splines, chapter IV, "not a knot"); through three points
    it is a parabola, through two a line. The pieces are Hermite polynomials, with the slopes at the points from a
    tridiagonal system. SciPy's spline is the same; it takes a quarter of a second to import.
    """

    def __init__(self, length_along: FloatArray, points: FloatArray) -> None:
        """way: parameter of each point, increasing (n,); points: (n, 2) [mm]."""
        self._length_along, self._points = length_along, points
        self._slope = _find_slopes(np.diff(length_along), np.diff(points @ np.array([1.0, 1.0j])))

    def __call__(self, at: FloatArray) -> FloatArray:
        """Return points (m, 2) at parameters (m,)."""
        piece = np.clip(np.searchsorted(self._length_along, at, side="right") - 1, 0, len(self._length_along) - 2)
        length = self._length_along[piece + 1] - self._length_along[piece]
        t = ((at - self._length_along[piece]) / length)[:, None]
        begin, end = (self._slope[piece + k] * length[:, None] for k in (0, 1))
        step = self._points[piece + 1] - self._points[piece]
        square, cube = 3.0 * step - 2.0 * begin - end, begin + end - 2.0 * step
        return np.asarray(self._points[piece] + t * (begin + t * (square + t * cube)))


def _find_slopes(length: FloatArray, step: FloatArray) -> FloatArray:
    """Return the derivatives at the points (n, 2) from lengths of the pieces (n - 1,) and steps over them, complex."""
    h, rise = length.tolist(), (step / length).tolist()
    n = len(h) + 1
    if n == 2:
        return _to_plane([rise[0]] * 2)
    if n == 3:
        bend = (rise[1] - rise[0]) / (h[0] + h[1])
        return _to_plane([rise[0] - bend * h[0], rise[0] + bend * h[0], rise[1] + bend * h[1]])
    # rows of the system: below, on and above the diagonal, right-hand side
    on, above, right = [h[1]], [h[0] + h[1]], [_end_rise(h[0], h[1], rise[0], rise[1])]
    for i in range(1, n - 1):
        factor = h[i] / on[-1]
        on.append(2.0 * (h[i - 1] + h[i]) - factor * above[-1])
        right.append(3.0 * (h[i] * rise[i - 1] + h[i - 1] * rise[i]) - factor * right[-1])
        above.append(h[i - 1])
    factor = (h[-1] + h[-2]) / on[-1]
    on.append(h[-2] - factor * above[-1])
    right.append(_end_rise(h[-1], h[-2], rise[-1], rise[-2]) - factor * right[-1])
    slope = [right[-1] / on[-1]]
    for i in range(n - 2, -1, -1):
        slope.append((right[i] - above[i] * slope[-1]) / on[i])
    return _to_plane(slope[::-1])


def _end_rise(h: float, next_h: float, rise: complex, next_rise: complex) -> complex:
    """Return the right-hand side at an end, where the first two pieces are one cubic."""
    both = h + next_h
    return ((h + 2.0 * both) * next_h * rise + h * h * next_rise) / both


def _to_plane(values: list[complex]) -> FloatArray:
    return np.array([[value.real, value.imag] for value in values])
