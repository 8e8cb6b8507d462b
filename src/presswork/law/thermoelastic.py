# SPDX-License-Identifier: Apache-2.0
"""Turns a Model's thermal expansion and elastic constants by temperature into the compiled law's curves."""

from __future__ import annotations

import numpy as np

from presswork.model import FloatArray, Thermoelastic


def make_curves(data: Thermoelastic | None) -> tuple[list[float], list[float], list[float]]:
    """Return thermal strain, factor of Young's modulus and Poisson's ratio, each by rows (temperature, c0, c1, c2).

    A row holds from its temperature on: c0 + c1 d + c2 d^2, d degrees on; the first also before.
    """
    if data is None:
        return [], [], []
    expansion = [] if data.expansion is None else expand(data.expansion, data.secant_from)
    return expansion, _join(data.young_factor), _join(data.poisson)


def find_thermal_strain(data: Thermoelastic, temperature: FloatArray) -> FloatArray:
    """Return the thermal strain at temperatures [degrees C], from one of no meaning on: differences count."""
    return find_strain(make_curves(data)[0], temperature)


def find_strain(curve: list[float], temperature: FloatArray) -> FloatArray:
    """Return the strain of a curve at temperatures [degrees C]."""
    return _evaluate(curve, temperature, 0.0)


def find_young_factor(data: Thermoelastic | None, temperature: FloatArray) -> FloatArray:
    """Return Young's modulus over that of the material at temperatures [degrees C]."""
    return _evaluate(make_curves(data)[1], temperature, 1.0)


def _evaluate(curve: list[float], temperature: FloatArray, otherwise: float) -> FloatArray:
    if not curve:
        return np.full_like(temperature, otherwise)
    rows = np.reshape(curve, (-1, 4))
    at = np.maximum(np.searchsorted(rows[:, 0], temperature, side="left") - 1, 0)
    start, c0, c1, c2 = np.moveaxis(rows[at], -1, 0)
    d = temperature - start
    return np.asarray(c0 + d * (c1 + d * c2))


def largest_young_factor(data: Thermoelastic | None) -> float:
    """Return the largest Young's modulus over that of the material."""
    return 1.0 if data is None or data.young_factor is None else max(1.0, float(data.young_factor[:, 1].max()))


def _join(rows: FloatArray | None) -> list[float]:
    """Straight lines between rows, constant beyond."""
    if rows is None:
        return []
    t, y = rows.T
    slopes = np.diff(y) / np.diff(t)
    first, last = [(t[0], y[0], 0.0, 0.0)], [(t[-1], y[-1], 0.0, 0.0)]
    between = [(a, b, slope, 0.0) for a, b, slope in zip(t, y, slopes, strict=False)]
    return [float(x) for row in first + between + last for x in row]


def expand(rows: FloatArray, secant_from: float | None) -> list[float]:
    """Return the curve of thermal strain of a coefficient with straight lines between rows, constant beyond.

    It is zero anywhere.
    """
    t, a = rows.T
    slopes = np.concatenate([[0.0], np.diff(a) / np.diff(t), [0.0]])
    starts, values = np.concatenate([[t[0]], t]), np.concatenate([[a[0]], a])
    if secant_from is not None:  # values (T - secant_from)
        away = starts - secant_from
        curve = np.column_stack([starts, values * away, values + slopes * away, slopes])
    else:
        grown = np.concatenate([[0.0, 0.0], np.cumsum(0.5 * (a[1:] + a[:-1]) * np.diff(t))])
        curve = np.column_stack([starts, grown, values, 0.5 * slopes])
    return [float(x) for x in curve.ravel()]
