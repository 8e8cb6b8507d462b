# SPDX-License-Identifier: Apache-2.0
"""A mesh as a file holds it, before anything is checked."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from presswork.model import Cell, FloatArray, IntArray


@dataclass
class RawMesh:
    """Points, cells by kind and groups, with node indices from 0; node order as in the Model."""

    points: FloatArray
    """Shape (n_points, 2 | 3), in the file's unit."""
    cells: dict[str, list[IntArray]] = field(default_factory=dict)
    """Connectivity of triangles and quadrilaterals by kind: tri3, tri6, quad4, quad8, quad9."""
    other_kinds: set[str] = field(default_factory=set)
    """Names of kinds in the file that are no 2D cells, lines or points; of volumes as meshio has them."""
    volumes: dict[str, list[IntArray]] = field(default_factory=dict)
    """Connectivity of cells that fill space by kind: hex8, tet4, tet10; their names are among other_kinds, too."""
    node_sets: dict[str, list[IntArray]] = field(default_factory=dict)
    """Node indices by name, from groups of nodes, points and cells."""
    line_sets: dict[str, list[IntArray]] = field(default_factory=dict)
    """Line cells by name, each of shape (n_lines, 2 | 3), nodes in any order."""

    def add_cells(self, cell: Cell, connectivity: IntArray) -> None:
        """Add 2D cells, or cells that fill space; lines by themselves are no part of a mesh."""
        if cell.dimension == 3:
            self.other_kinds.add(cell.files.meshio)
        if len(connectivity) and cell.dimension > 1:
            cells = self.cells if cell.dimension == 2 else self.volumes
            cells.setdefault(cell.name, []).append(connectivity.astype(np.int32))

    def add_to_set(self, name: str, kind: str, connectivity: IntArray) -> None:
        """Add cells of any kind, points included, to a named set."""
        if len(connectivity) == 0:
            return
        sets = self.line_sets if kind.startswith("line") else self.node_sets
        entry = connectivity if kind.startswith("line") else connectivity.ravel()
        sets.setdefault(name, []).append(entry.astype(np.int32))
