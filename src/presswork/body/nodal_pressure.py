# SPDX-License-Identifier: Apache-2.0
"""Pressures as freedoms of nodes: what makes them lengths, and the moduli that their equations need."""

from __future__ import annotations

import numpy as np

from presswork.model import Material, Model


def find_scale(model: Model) -> float:
    """Return the pressure that counts as a length [MPa/mm]: entries of the matrix become of one size with it.

    It is Young's modulus over the size of a cell.
    """
    points = model.mesh.points
    cells = sum(len(block.connectivity) for block in model.mesh.blocks)
    size = (np.ptp(points, axis=0).prod() / cells) ** (1.0 / points.shape[1])
    return float(max(material.young for material in model.materials) / size)


def describe_freedom(material: Material, scale: float) -> tuple[float, float, float]:
    """Return bulk modulus and shear modulus [MPa], and the scale [MPa/mm], as the kernel takes them."""
    young, poisson = material.young, material.poisson
    return young / (3.0 * (1.0 - 2.0 * poisson)), young / (2.0 * (1.0 + poisson)), scale
