# SPDX-License-Identifier: Apache-2.0
"""The one-step solver's law: Hill's metric of strains for a material, and the compiled law of deformation theory."""

from __future__ import annotations

import numpy as np

from presswork import _core
from presswork.model import Material
from presswork.onestep.part import OneStepError


def strain_metric(hill: tuple[float, float, float, float]) -> list[float]:
    """Return Q by rows, the inverse of Hill's matrix of plane stress. hill: F, G, H, N with G + H = 1."""
    f, g, h, n = hill
    matrix = np.array([[g + h, -h, 0.0], [-h, f + h, 0.0], [0.0, 0.0, 2.0 * n]])
    return [float(v) for v in np.linalg.inv(matrix).ravel()]


STRAIN_METRIC = strain_metric((0.5, 0.5, 0.5, 1.5))
"""Strain metric of von Mises."""


def turn_metric(metric: list[float], angle: float) -> list[float]:
    """Return Q in axes from which the rolling direction lies at the angle [rad], counter-clockwise."""
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c * c, s * s, c * s], [s * s, c * c, -c * s], [-2 * c * s, 2 * c * s, c * c - s * s]])
    return [float(v) for v in (turn.T @ np.array(metric).reshape(3, 3) @ turn).ravel()]


def find_metric(material: Material, rolling_direction: float) -> list[float]:
    """Return Q by rows for von Mises or Hill 1948. Raises OneStepError for other yield functions."""
    chosen = material.yield_function
    if chosen is None:
        return STRAIN_METRIC
    if chosen.law != "hill1948":
        raise OneStepError(
            f"{chosen.law} has no closed form between strain and stress: take von_mises or hill1948 (its r-values)"
        )
    f, g, h, _, _, n = chosen.parameters
    return turn_metric(strain_metric((f, g, h, n)), rolling_direction)


def make_law(material: Material, metric: list[float]) -> _core.DeformationLaw:
    """Return the compiled law."""
    hardening = material.hardening
    assert hardening is not None, "a sheet material hardens"
    return _core.DeformationLaw(
        material.young, metric, _core.HardeningLaw[hardening.law], [float(p) for p in hardening.parameters]
    )
