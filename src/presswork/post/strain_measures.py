# SPDX-License-Identifier: Apache-2.0
"""Strain measures and rotation of a deformation gradient, in three dimensions (Cheng 1995, chapter 2, section 4).

F_iJ = dx_i/dX_J, so that F = R U = V R. The thesis writes the transpose of F, with the same U, V and strains, and with
R and the spin transposed. The kernels have their own two-dimensional form of this; tests compare the two.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from presswork.model import FloatArray


@dataclass(frozen=True)
class StrainMeasures:
    """What the thesis's tables 1 and 2 compare, and the logarithmic strain; each of shape (..., 3, 3)."""

    small: FloatArray
    """(F + F^T)/2 - 1: changes with a rotation."""
    green_lagrange: FloatArray
    """(F^T F - 1)/2."""
    stretch: FloatArray
    """U - 1."""
    left_stretch: FloatArray
    """V - 1: U - 1 seen in the turned frame."""
    log: FloatArray
    """ln U."""
    rotation: FloatArray
    """R of the polar decomposition."""
    spin: FloatArray
    """(F - F^T)/2, which added to 1 approximates R while rotations are small."""


def measure_strains(F: FloatArray) -> StrainMeasures:
    """Return the strain measures and the rotation of deformation gradients.

    F: shape (..., 3, 3). Raises ValueError where the determinant is not positive.
    """
    F = np.asarray(F, dtype=float)
    if F.shape[-2:] != (3, 3):
        raise ValueError(f"F must have shape (..., 3, 3), not {F.shape}")
    if not (np.linalg.det(F) > 0).all():
        raise ValueError("a deformation gradient must have a positive determinant")
    flat = F.reshape(-1, 3, 3)
    parts = [scipy.linalg.polar(f, side="right") for f in flat]
    rotation = np.array([r for r, _ in parts]).reshape(F.shape)
    stretch = np.array([u for _, u in parts]).reshape(F.shape)
    values, axes = np.linalg.eigh(stretch)
    one, transposed = np.eye(3), np.swapaxes(F, -1, -2)
    return StrainMeasures(
        small=0.5 * (F + transposed) - one,
        green_lagrange=0.5 * (transposed @ F - one),
        stretch=stretch - one,
        left_stretch=rotation @ stretch @ np.swapaxes(rotation, -1, -2) - one,
        log=(axes * np.log(values)[..., None, :]) @ np.swapaxes(axes, -1, -2),
        rotation=rotation,
        spin=0.5 * (F - transposed),
    )
