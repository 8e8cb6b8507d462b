# SPDX-License-Identifier: Apache-2.0
"""A mesh as a file holds it, before anything is checked."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from presswork.model import FloatArray, IntArray


@dataclass
class RawMesh:
    """Points, cells by kind and groups, with node indices from 0; node order as in the Model."""

    points: FloatArray
    """Shape (n_points, 2 | 3), in the file's unit."""
    cells: dict[str, list[IntArray]] = field(default_factory=dict)
    """Connectivity by kind: tri3, tri6, quad4, quad8, quad9."""
    other_kinds: set[str] = field(default_factory=set)
    """Names of kinds in the file that are no 2D cells, lines or points."""
    volumes: dict[str, list[IntArray]] = field(default_factory=dict)
    """Connectivity of hexahedra of 8 nodes and tetrahedra of 4 and 10 by kind: hex8, tet4, tet10; their names are among
    other_kinds, too."""
    node_sets: dict[str, list[IntArray]] = field(default_factory=dict)
    """Node indices by name, from groups of nodes, points and cells."""
    line_sets: dict[str, list[IntArray]] = field(default_factory=dict)
    """Line cells by name, each of shape (n_lines, 2 | 3), nodes in any order."""

    def add_cells(self, kind: str, connectivity: IntArray) -> None:
        """Add 2D cells."""
        if len(connectivity):
            self.cells.setdefault(kind, []).append(connectivity.astype(np.int32))

    def add_volumes(self, kind: str, connectivity: IntArray) -> None:
        """Add cells that fill space."""
        if len(connectivity):
            self.volumes.setdefault(kind, []).append(connectivity.astype(np.int32))

    def add_to_set(self, name: str, kind: str, connectivity: IntArray) -> None:
        """Add cells of any kind, points included, to a named set."""
        if len(connectivity) == 0:
            return
        sets = self.line_sets if kind.startswith("line") else self.node_sets
        entry = connectivity if kind.startswith("line") else connectivity.ravel()
        sets.setdefault(name, []).append(entry.astype(np.int32))
