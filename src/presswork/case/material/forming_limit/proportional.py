# SPDX-License-Identifier: Apache-2.0
"""Rigid-plastic proportional straining: the stress whose normal has given principal strain rates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork import _core
from presswork.model import FloatArray

_STIFF = 300.0
"""Young's modulus over the flow stress of the auxiliary law: what is left is mended by Newton."""


@dataclass(frozen=True)
class ProportionalPath:
    """Stress and strain rate of proportional straining, m paths; axes 1 (major), 2 (minor), 12."""

    angle: float
    """Angle of axis 1 from the rolling direction [rad]."""
    stress: FloatArray
    """Stress over the flow stress, shape (m, 3)."""
    rate: FloatArray
    """Principal strains per unit of equivalent plastic strain, shape (m, 2)."""


def turn_stress(stress: FloatArray, angle: FloatArray | float) -> FloatArray:
    """Return the components (..., 3: xx, yy, xy) of a plane stress in axes turned by an angle [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    xx, yy, xy = stress[..., 0], stress[..., 1], stress[..., 2]
    turned = (
        c * c * xx + s * s * yy + 2 * s * c * xy,
        s * s * xx + c * c * yy - 2 * s * c * xy,
        s * c * (yy - xx) + (c * c - s * s) * xy,
    )
    return np.asarray(np.stack(np.broadcast_arrays(*turned), axis=-1))


def find_stress(function: _core.YieldFunction, ratios: FloatArray, angle: float = 0.0) -> ProportionalPath:
    """Find the stresses on the yield surface whose plastic strain is minor = ratio * major, without shear.

    ratios: shape (m,), above -1. angle: of the major strain from the rolling direction [degrees].
    """
    ratios = np.asarray(ratios, dtype=float)
    turn = np.radians(angle)
    c, s = np.cos(turn), np.sin(turn)
    direction = np.stack(  # engineering shear, material axes
        [c * c + s * s * ratios, s * s + c * c * ratios, 2 * s * c * (1 - ratios)], axis=1
    )
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    law = _core.SheetLaw(_STIFF, 0.3, function, _core.HardeningLaw.linear, [1.0, 0.0])
    m = len(ratios)
    stress, _, _, _, failed = law.update(direction, np.zeros((m, 3)), np.zeros((m, 1)), tangent=False)
    assert not failed.any()
    size = np.ones(m)
    for iteration in range(20):
        value, normal, hessian = function.evaluate(stress)
        if iteration == 0:
            size = (normal * direction).sum(axis=1)
        residual = np.concatenate([normal - size[:, None] * direction, (value - 1.0)[:, None]], axis=1)
        if np.abs(residual).max() < 1e-13:
            break
        matrix = np.zeros((m, 4, 4))
        matrix[:, :3, :3] = hessian
        matrix[:, :3, 3] = -direction
        matrix[:, 3, :3] = normal
        step = np.linalg.solve(matrix, -residual[..., None])[..., 0]
        stress, size = stress + step[:, :3], size + step[:, 3]
    normal = function.evaluate(stress)[1]
    major = c * c * normal[:, 0] + s * s * normal[:, 1] + s * c * normal[:, 2]
    return ProportionalPath(float(turn), turn_stress(stress, turn), np.stack([major, ratios * major], axis=1))
