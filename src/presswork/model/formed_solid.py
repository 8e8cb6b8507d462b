# SPDX-License-Identifier: Apache-2.0
"""A formed solid, in the plane or in space: what files of other programs hold of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from presswork.model.arrays import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class FormedSolid:
    """Cells with their mean stress and plastic strain."""

    points: FloatArray
    """(n_points, 2), radius and height of an axisymmetric body; in space (n_points, 3) [mm]."""
    blocks: tuple[IntArray, ...]
    """Connectivities, node order as in CellBlock, one block after the other."""
    frame: Literal["axisymmetric", "plane_strain", "solid"]
    """Frame, as `analysis` of a case."""
    stress: FloatArray
    """xx, yy, zz, xy, yz, zx of all cells (n, 6) [MPa]; of an axisymmetric body rr, zz, hoop, rz."""
    plastic_strain: FloatArray
    """Equivalent plastic strain (n,)."""
