# SPDX-License-Identifier: Apache-2.0
"""Identification of Yld2000-2d: its eight parameters by weighted least squares over all data that were measured.

Any number of directions of tension, each with yield stress, r-value or both, and the balanced biaxial test. With the
usual eight data (stress and r at 0, 45 and 90 degrees and biaxial) the fit solves them exactly.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork import _core
from presswork.case.errors import CaseError, Problem
from presswork.model import FloatArray

R_WEIGHT = 1.0
"""Weight of an r-value: an error of 0.01 in r/(1 + r) counts as one of 1 % in a yield stress."""
WORST = 0.15
"""Error of a datum beyond which the data are of no sheet, or there is a slip in them."""
N_PARAMETERS = 8


def tension(angle: FloatArray) -> FloatArray:
    """Return unit tension at angles [rad] from the rolling direction, shape (n, 3): xx, yy, xy."""
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(np.stack([c * c, s * s, s * c], axis=-1))


def r_value(function: _core.YieldFunction, angle: FloatArray) -> FloatArray:
    """Return width strain over thickness strain in tension at angles [rad], shape (n,)."""
    gradient = function.evaluate(tension(angle))[1]
    width = (gradient * tension(angle + np.pi / 2)).sum(axis=1)
    return np.asarray(-width / (gradient[:, 0] + gradient[:, 1]))


@dataclass(frozen=True)
class YieldData:
    """What was measured of a sheet's yield; nan where it was not."""

    angle: FloatArray
    """Angle of tension from the rolling direction (n,) [degrees]."""
    stress: FloatArray
    """Yield stress over one reference, that at 0 degrees as a rule (n,)."""
    r: FloatArray
    """Width strain over thickness strain (n,)."""
    biaxial: float = np.nan
    """Balanced biaxial yield stress over the reference."""
    r_biaxial: float = np.nan
    """Strain across over strain along the rolling direction in balanced stretching."""

    def count(self) -> int:
        """Return how many numbers were measured."""
        values = (*self.stress, *self.r, self.biaxial, self.r_biaxial)
        return int(np.isfinite(values).sum())


@dataclass(frozen=True)
class Yld2000Fit:
    """Yld2000-2d fitted to data, beside what it makes of them."""

    alpha: tuple[float, ...]
    exponent: int
    data: YieldData
    """What was measured."""
    found: YieldData
    """The same by the fitted function, at all angles."""

    def worst(self) -> tuple[float, float]:
        """Return the largest relative error of a stress and the largest error of an r-value."""
        given, found = self.data, self.found
        stress = np.append(found.stress, found.biaxial) / np.append(given.stress, given.biaxial) - 1
        r = np.append(found.r, found.r_biaxial) - np.append(given.r, given.r_biaxial)
        return tuple(float(np.nanmax(np.abs(x), initial=0.0)) for x in (stress, r))  # type: ignore[return-value]


def fit_yld2000(data: YieldData, exponent: int, *, r_weight: float = R_WEIGHT) -> Yld2000Fit:
    """Fit Yld2000-2d's alpha 1 to 8 to data by least squares.

    The residuals are those of the yield stresses, relative, and of r/(1 + r), nearly linear in the slope of the yield
    surface, times `r_weight`. Raises CaseError for data that are no metal's, or fewer than eight.
    """
    from scipy.optimize import least_squares  # slow to import

    _check(data, r_weight)
    has_stress, has_r = np.isfinite(data.stress), np.isfinite(data.r)

    def miss(alpha: FloatArray) -> FloatArray:
        found = _predict(alpha, exponent, data.angle)
        slope, given = found.r / (1 + found.r), data.r / (1 + data.r)
        parts = [
            (data.stress / found.stress - 1)[has_stress],
            r_weight * (slope - given)[has_r],
            np.array([data.biaxial / found.biaxial - 1]),
            r_weight * np.array([found.r_biaxial / (1 + found.r_biaxial) - data.r_biaxial / (1 + data.r_biaxial)]),
        ]
        return np.concatenate([part[np.isfinite(part)] for part in parts])

    best = least_squares(miss, np.ones(N_PARAMETERS), xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=2000)
    if np.abs(best.fun).max() > WORST:
        text = f"no parameters give the data; the best misses one by {np.abs(best.fun).max():.2g}"
        raise CaseError([Problem("", text, "check the data, or the exponent")], "Yld2000-2d")
    alpha = tuple(float(value) for value in best.x)
    return Yld2000Fit(alpha, exponent, data, _predict(best.x, exponent, data.angle))


def _predict(alpha: FloatArray, exponent: int, angle: FloatArray) -> YieldData:
    function = _core.YieldFunction.yld2000(list(alpha), exponent)
    radians = np.radians(angle)
    value, gradient, _ = function.evaluate(np.concatenate([tension(radians), [[1.0, 1.0, 0.0]]]))
    ratio = float(gradient[-1, 1] / gradient[-1, 0])
    return YieldData(angle, 1.0 / value[:-1], r_value(function, radians), float(1.0 / value[-1]), ratio)


def _check(data: YieldData, r_weight: float) -> None:
    problems = []
    named = [(f"stress at {a:g} degrees", s) for a, s in zip(data.angle, data.stress, strict=True)]
    named += [(f"r at {a:g} degrees", r) for a, r in zip(data.angle, data.r, strict=True)]
    named += [("biaxial stress", data.biaxial), ("biaxial r", data.r_biaxial)]
    problems += [Problem(name, "expected a value > 0", "check the datum", v) for name, v in named if v <= 0]
    if data.count() < N_PARAMETERS:
        text = f"{data.count()} data for its eight parameters"
        remedy = "measure stress and r in three directions and the balanced biaxial test, or take hill1948"
        problems.append(Problem("", text, remedy))
    if not r_weight > 0:
        problems.append(Problem("r_weight", "expected a weight > 0", "1 by default", r_weight))
    if problems:
        raise CaseError(problems, "Yld2000-2d")
