# SPDX-License-Identifier: Apache-2.0
"""Ring compression by Avitzur's upper bound with a parallel velocity field: rigid, perfectly plastic, no bulge.

The field is u_R = (U/2T)(R - s/R) with s = R_n^2, T the height, U the platens' approach; the neutral radius R_n
minimises the power (Avitzur, Metal Forming: Processes and Analysis, 1968):
(1/2)[asinh(s/(sqrt3 R_i^2)) - asinh(s/(sqrt3 R_o^2))] = (m/T)(R_o - R_i)           if R_n <= R_i,
                                                       = (m/T)(R_o + R_i - 2 R_n)   else.
"""

from __future__ import annotations

import math

import numpy as np
import scipy
from numpy.typing import ArrayLike

from presswork.model import FloatArray

RING_6_3_2 = (3.0, 1.5, 2.0)
"""Outer radius, inner radius, height, in any unit."""


def find_neutral_square(m: float, outer: float, inner: float, height: float) -> float:
    """Return s = R_n^2, in the unit of the radii squared; it is less than R_i^2 where all of the ring flows out."""

    def excess(s: float) -> float:
        field = math.asinh(s / (math.sqrt(3) * inner**2)) - math.asinh(s / (math.sqrt(3) * outer**2))
        friction = outer - inner if s <= inner**2 else outer + inner - 2 * math.sqrt(s)
        return 0.5 * field - m / height * friction

    return float(scipy.optimize.brentq(excess, 0.0, outer**2, xtol=1e-14 * outer**2))


def integrate_ring(
    m: float, reductions: ArrayLike, shape: tuple[float, float, float] = RING_6_3_2
) -> tuple[FloatArray, FloatArray]:
    """Return bore and outer radius over their first values at height reductions (fractions), each shape (n,).

    m: friction factor, 0 to 1; shape: outer radius, inner radius and height in one unit. NaN once the bore has closed.
    """
    outer_0, inner_0, height_0 = shape
    wanted = -np.log1p(-np.atleast_1d(np.asarray(reductions, dtype=np.float64)))
    volume = (outer_0**2 - inner_0**2) * height_0

    def rate(log_height: float, square: FloatArray) -> list[float]:
        """d(R_i^2)/d ln(T_0/T) = R_i^2 - s."""
        height = height_0 * math.exp(-log_height)
        outer = math.sqrt(square[0] + volume / height)
        return [square[0] - find_neutral_square(m, outer, math.sqrt(square[0]), height)]

    def bore_is_open(_: float, square: FloatArray) -> float:
        return float(square[0] - 1e-4 * inner_0**2)

    bore_is_open.terminal = True  # type: ignore[attr-defined]
    path = scipy.integrate.solve_ivp(
        rate,
        (0.0, float(max(wanted.max(), 1e-9))),
        [inner_0**2],
        dense_output=True,
        events=bore_is_open,
        rtol=1e-9,
        atol=1e-12 * inner_0**2,
    )
    square = np.where(wanted <= path.t[-1], path.sol(np.minimum(wanted, path.t[-1]))[0], np.nan)
    outer = np.sqrt(square + volume / (height_0 * np.exp(-wanted)))
    return np.sqrt(square) / inner_0, outer / outer_0
