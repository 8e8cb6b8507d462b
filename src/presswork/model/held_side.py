# SPDX-License-Identifier: Apache-2.0
"""Outermost flat sides of a body that supports hold along their normals: its symmetry planes, mostly."""

from __future__ import annotations

import numpy as np

from presswork.model.model import Model


def find_held_side(model: Model, axis: int) -> float | None:
    """Return the place of an outermost flat side that supports hold along an axis [mm]; None where there is none."""
    points = model.mesh.points
    low, high = points[:, axis].min(), points[:, axis].max()
    for support in model.lasting_supports:
        held = points[model.mesh.node_sets[support.node_set], axis]
        is_flat = len(held) > 1 and np.ptp(held) < 1e-9 * (high - low)
        if support.fix[axis] and is_flat and (held[0] == low or held[0] == high):
            return float(held[0])
    return None
