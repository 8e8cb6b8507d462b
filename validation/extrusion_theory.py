# SPDX-License-Identifier: Apache-2.0
"""Pressure of forward extrusion over the flow stress of a rigid, perfectly plastic metal: slab method and upper bound.

m is the friction factor (tau = m sigma0 / sqrt(3)), mu Coulomb's coefficient; the container is frictionless.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.integrate import quad

SQRT3 = np.sqrt(3.0)


def slab_shear(radius: Callable[[float], float], top: float, bottom: float, m: float) -> float:
    """Return p/sigma0 of the slab method with constant shear for a die of any profile.

    Equilibrium of a slab, d(s A) + (p + m k cot(alpha)) dA = 0, with s + p = sigma0 gives 2 ln(R0/Rf) and, for
    friction, (2 m / sqrt(3)) times the integral of dy/R over the die, land included. `radius` [mm] is a function of
    y [mm]; the metal enters at `top`. Neglects redundant work, so that it lies below the exact answer.
    """
    friction, _ = quad(lambda y: 1.0 / radius(y), bottom, top, limit=400)
    return float(2.0 * np.log(radius(top) / radius(bottom)) + 2.0 * m / SQRT3 * friction)


def slab_coulomb(entry: float, exit_: float, angle: float, mu: float) -> float:
    """Return p/sigma0 of the slab method with Coulomb friction in a cone: ((1+B)/B)[(A0/Af)^B - 1], B = mu cot alpha.

    `entry`, `exit_`: radii [mm]; `angle`: half the cone's angle [rad].
    """
    B, log_ratio = mu / np.tan(angle), 2.0 * np.log(entry / exit_)
    return float(log_ratio if B == 0 else (1 + B) / B * (np.exp(B * log_ratio) - 1))


def homogeneous_work_factor(angle: float) -> float:
    """Return Avitzur's f(alpha) of the power in the cone, by quadrature of its definition."""
    value, _ = quad(lambda t: np.sin(t) * np.sqrt(1.0 - 11.0 / 12.0 * np.sin(t) ** 2), 0.0, angle)
    return float(2.0 * value / np.sin(angle) ** 2)


def avitzur(entry: float, exit_: float, angle: float, m: float, land: float = 0.0) -> float:
    """Return p/sigma0 of Avitzur's upper bound for a cone with sharp corners (Avitzur 1968, Metal Forming, ch. 8).

    `entry`, `exit_`: radii [mm]; `angle`: half the cone's angle [rad]; `land`: length of the bearing [mm].
    """
    log_ratio, cot = np.log(entry / exit_), 1.0 / np.tan(angle)
    turning = angle / np.sin(angle) ** 2 - cot
    return float(
        2.0 * homogeneous_work_factor(angle) * log_ratio
        + 2.0 / SQRT3 * (turning + m * cot * log_ratio + m * land / exit_)
    )
