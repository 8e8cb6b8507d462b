# SPDX-License-Identifier: Apache-2.0
"""A sheet with a past: what a case begins with in place of a flat blank."""

from __future__ import annotations

from dataclasses import dataclass

from presswork.model.arrays import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class FormedSheet:
    """A formed sheet of n 3- and 4-node shells, with the stress of k layers from bottom to top."""

    points: FloatArray
    """(n_points, 3) [mm]."""
    cells: IntArray
    """(n, 4); a triangle has its last node twice."""
    thickness: FloatArray
    """(n,) [mm]."""
    axis: FloatArray
    """x of the law in space, unit vectors (n, 3)."""
    heights: FloatArray
    """Of the layers, from -1 to 1 (k,)."""
    stress: FloatArray
    """xx, yy, zz, xy, yz, zx in space (n, k, 6) [MPa]."""
    plastic_strain: FloatArray
    """Equivalent plastic strain (n, k)."""
    strain: FloatArray | None = None
    """Logarithmic strain of the middle surface, components as those of the stress (n, 6); None: not known."""
