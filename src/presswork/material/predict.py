# SPDX-License-Identifier: Apache-2.0
"""What a yield function predicts: tension by direction, biaxial, plane strain and shear points, the yield locus."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork import _core
from presswork.case.material.yld2000_fit import r_value, tension
from presswork.model import FloatArray


@dataclass(frozen=True)
class Directional:
    """Tension at angles to the rolling direction; shapes (n,)."""

    angle: FloatArray
    """Degrees from the rolling direction."""
    stress: FloatArray
    """Yield stress over the flow stress."""
    r: FloatArray
    """Width strain over thickness strain."""


def predict_tension(function: _core.YieldFunction, angle: FloatArray) -> Directional:
    """Predict yield stress and r-value in tension at angles [degrees] from the rolling direction."""
    radians = np.radians(angle)
    return Directional(np.asarray(angle), 1.0 / function.evaluate(tension(radians))[0], r_value(function, radians))


def predict_biaxial(function: _core.YieldFunction) -> tuple[float, float]:
    """Return the balanced biaxial yield stress over the flow stress, and r_b = strain across over strain along."""
    value, gradient, _ = function.evaluate(np.array([[1.0, 1.0, 0.0]]))
    return float(1.0 / value[0]), float(gradient[0, 1] / gradient[0, 0])


def predict_shear(function: _core.YieldFunction) -> float:
    """Return the yield stress in shear along the rolling direction over the flow stress."""
    return float(1.0 / function.evaluate(np.array([[0.0, 0.0, 1.0]]))[0][0])


def predict_plane_strain(function: _core.YieldFunction, across: int) -> tuple[float, float]:
    """Return the stress along the stretch over the flow stress, and the stress ratio, where one strain rate is zero.

    across: the component held, 1 (stretched along the rolling direction) or 0 (across it). Ratio: held over stretched.
    """

    from scipy.optimize import brentq  # slow to import

    def stress_at(ratio: float) -> FloatArray:
        return np.array([[ratio, 1.0, 0.0] if across == 0 else [1.0, ratio, 0.0]])

    ratio = float(brentq(lambda x: float(function.evaluate(stress_at(x))[1][0, across]), -1.0, 3.0, xtol=1e-14))
    return float(1.0 / function.evaluate(stress_at(ratio))[0][0]), ratio


def trace_locus(function: _core.YieldFunction, shear: float = 0.0, n: int = 361) -> FloatArray:
    """Return points (n, 2) of the yield locus in (xx, yy) over the flow stress, at a shear stress over the flow stress.

    Raises ValueError if the shear alone is beyond yield.
    """
    turn = np.linspace(0.0, 2 * np.pi, n)
    along = np.stack([np.cos(turn), np.sin(turn), np.zeros(n)], axis=1)
    offset = np.array([0.0, 0.0, shear])
    low, high = np.zeros(n), np.full(n, 10.0)
    if function.evaluate(offset[None])[0][0] >= 1.0:
        raise ValueError(f"a shear stress of {shear:g} of the flow stress is beyond yield")
    while (function.evaluate(high[:, None] * along + offset)[0] < 1.0).any():
        high *= 2.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        inside = function.evaluate(middle[:, None] * along + offset)[0] < 1.0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return np.asarray((high[:, None] * along)[:, :2])
