# SPDX-License-Identifier: Apache-2.0
"""A sheet with a past: what a case begins with in place of a flat blank."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

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
    """Heights of the layers, from -1 to 1 (k,)."""
    stress: FloatArray
    """xx, yy, zz, xy, yz, zx in space (n, k, 6) [MPa]."""
    plastic_strain: FloatArray
    """Equivalent plastic strain (n, k)."""
    strain: FloatArray | None = None
    """Logarithmic strain of the middle surface, components as those of the stress (n, 6); None: not known."""
    node_labels: IntArray | None = None
    """Numbers of the points in files (n_points,); None: from 1."""
    cell_labels: IntArray | None = None
    """Numbers of the shells in files (n,); None: from 1."""

    @property
    def nodes_in_files(self) -> IntArray:
        """Numbers of the points in files (n_points,)."""
        return np.arange(1, len(self.points) + 1, dtype=np.int32) if self.node_labels is None else self.node_labels

    @property
    def shells_in_files(self) -> IntArray:
        """Numbers of the shells in files (n,)."""
        return np.arange(1, len(self.cells) + 1, dtype=np.int32) if self.cell_labels is None else self.cell_labels
