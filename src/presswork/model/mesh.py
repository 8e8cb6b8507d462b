# SPDX-License-Identifier: Apache-2.0
"""Meshes: points, blocks of cells of one element formulation, named sets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from presswork.model.arrays import FloatArray, IntArray
from presswork.model.cells import find_cell
from presswork.model.elements import ElementName

ThicknessRule = Literal["gauss", "lobatto", "simpson"]


@dataclass(frozen=True)
class Section:
    """A sheet through its thickness."""

    thickness: float
    """[mm]"""
    points: int = 5
    """Integration points through the thickness, 2 to 51."""
    rule: ThicknessRule = "gauss"
    """gauss: the most accurate; lobatto, simpson: with points on both faces."""


@dataclass(frozen=True)
class CellBlock:
    """Cells of one kind and one element formulation."""

    element: ElementName
    connectivity: IntArray
    """Node indices, shape (n_cells, n_nodes), counter-clockwise: corners first, then mid-sides, then the centre; of a
    hexahedron the lower face, then the upper one, each counter-clockwise seen from above; of a tetrahedron the face
    that is counter-clockwise seen from the last corner, then that."""
    material: int
    """Index into Model.materials."""
    section: Section | None = None
    """Section of shells; None for solids."""
    zone: int = 0
    """Zone of a welded blank, as an index into Model.zones; 0 of any other mesh."""
    rolling: tuple[float, float, float] | None = None
    """Shells: Model.rolling_direction of these alone; None: that."""
    own_thickness: FloatArray | None = None
    """Thickness of each undeformed shell (n_cells,) [mm], of a rolled blank; None: that of the section."""

    @property
    def thickness(self) -> FloatArray:
        """Thickness of each undeformed shell (n_cells,) [mm]."""
        assert self.section is not None
        if self.own_thickness is not None:
            return self.own_thickness
        return np.full(len(self.connectivity), self.section.thickness)

    def take(self, cells: IntArray, connectivity: IntArray, element: ElementName | None = None) -> CellBlock:
        """Return a block of new cells that come from cells of this one (n,), with all that these are made of."""
        own = None if self.own_thickness is None else self.own_thickness[cells]
        return replace(self, element=element or self.element, connectivity=connectivity, own_thickness=own)


@dataclass(frozen=True)
class Mesh:
    """Points, cell blocks and named sets."""

    points: FloatArray
    """Coordinates [mm], shape (n_points, 2); of shells and of solids in space (n_points, 3)."""
    blocks: tuple[CellBlock, ...]
    node_sets: Mapping[str, IntArray]
    """Node indices by name, each sorted and unique."""
    edge_sets: Mapping[str, IntArray]
    """Boundary edges by name, shape (n_edges, 2 | 3): first end, last end[, mid-side], the body on the left."""
    boundary_edges: IntArray
    """Every boundary edge of the mesh, in the same form; of a solid in space none."""
    normals: FloatArray | None = None
    """Unit normals at the nodes of a shell whose exact surface is known (n_points, 3); None: means of the cells'
    normals are used."""
    face_sets: Mapping[str, IntArray] = field(default_factory=dict)
    """Boundary faces of a solid in space by name, shape (n_faces, 4), of tetrahedra (n_faces, 3),
    counter-clockwise seen from outside."""
    boundary_faces: IntArray = field(default_factory=lambda: np.zeros((0, 4), dtype=np.int32))
    """Every boundary face of the mesh, in the same form."""

    @property
    def corners(self) -> IntArray:
        """Corners of a sheet's cells (n, 4), block after block, a triangle with its last node twice."""
        return np.concatenate(
            [b.connectivity[:, [0, 1, 2, find_cell(2, b.connectivity).corners - 1]] for b in self.blocks]
        )
