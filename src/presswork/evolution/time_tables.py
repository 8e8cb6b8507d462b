# SPDX-License-Identifier: Apache-2.0
"""Isothermal transformation by a table of times (TTT), with additivity over any course of temperature.

At constant temperature the part X of what can form follows Johnson, Mehl, Avrami and Kolmogorov,

    X = 1 - exp(-b t^n),

with b and n by which X is FIRST and LAST at the times of the table. Their logarithms are straight between rows. In a
step at another temperature X goes on from the time that it would have taken there (Scheil 1935).
"""

from __future__ import annotations

import numpy as np

from presswork.model import FloatArray

FIRST, LAST = 0.01, 0.99
"""Parts that have formed at the times of a table."""


class TimeTable:
    """The times of one phase."""

    def __init__(self, rows: FloatArray) -> None:
        """Take temperatures [degrees C], times of FIRST and LAST [s], and the part of austenite that forms (n, 4)."""
        self._degrees, self._most = rows[:, 0], rows[:, 3]
        self._starts, self._ends = np.log(rows[:, 1:3].T)
        self._first, self._ratio = float(np.log(-np.log1p(-FIRST))), float(np.log(np.log1p(-LAST) / np.log1p(-FIRST)))

    def forms(self, temperature: FloatArray) -> FloatArray:
        """Return whether anything forms at temperatures: between the first row and the last."""
        return np.asarray((temperature >= self._degrees[0]) & (temperature <= self._degrees[-1]))

    def most(self, temperature: FloatArray) -> FloatArray:
        """Return the part of the austenite that forms in the end."""
        return np.asarray(np.interp(temperature, self._degrees, self._most))

    def advance(self, part: FloatArray, temperature: FloatArray, dt: float) -> FloatArray:
        """Return the parts X (n,) after dt [s] at temperatures (n,) [degrees C].

        >>> bainite = TimeTable(np.array([[300.0, 1.0, 100.0, 1.0], [500.0, 1.0, 100.0, 1.0]]))
        >>> bainite.advance(np.array([0.0, 0.01]), np.array([400.0, 400.0]), 99.0).round(4).tolist()
        [0.9894, 0.99]
        """
        start, end = (np.interp(temperature, self._degrees, times) for times in (self._starts, self._ends))
        power = self._ratio / (end - start)
        gone = -np.log1p(-np.minimum(part, 1.0 - 1e-12))
        time = np.where(gone > 0.0, np.exp(start + (np.log(np.maximum(gone, 1e-300)) - self._first) / power), 0.0)
        return np.asarray(-np.expm1(-np.exp(self._first + power * (np.log(time + dt) - start))))
