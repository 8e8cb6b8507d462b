# SPDX-License-Identifier: Apache-2.0
"""The table of cells, as the compiled core has it, with their names in files: there is no other list of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from presswork import _core
from presswork.model.arrays import FloatArray, IndexArray

Integer = TypeVar("Integer", bound=np.integer[Any])


@dataclass(frozen=True)
class NamesInFiles:
    """What files call a kind of cell."""

    vtk: int
    """VTK's number of it."""
    meshio: str
    abaqus: str
    """Pattern of the types of elements in decks of Abaqus."""
    ideas: tuple[int, ...] = ()
    """Descriptors of elements in universal files of I-DEAS."""


@dataclass(frozen=True, eq=False)
class Cell:
    """A kind of cell: corners first, then the middles of the edges, if they have such nodes, then inner nodes.

    No two kinds have both dimension and number of nodes in common.
    """

    name: str
    plural: str
    """What messages call cells of this shape: triangles, hexahedra."""
    dimension: int
    """1: sides of cells in the plane; 2: cells in the plane and of sheets, faces of solids; 3: solids in space."""
    corners: int
    places: FloatArray
    """Natural coordinates of the nodes (n_nodes, dimension)."""
    edges: IndexArray
    """First end, last end[, middle] of each (n_edges, 2 | 3); in the plane the cell lies on their left."""
    faces: IndexArray
    """Nodes of each face of a solid (n_faces, k), counter-clockwise seen from outside; else none."""
    simplices: IndexArray
    """Corners of simplices that fill the cell (n, dimension + 1)."""
    pieces: IndexArray
    """Lines or triangles between all nodes of a line or plane cell (n, dimension + 1); of a solid none."""
    spans: IndexArray
    """Two pairs of corners of a plane cell (2, 2): the cross product of their differences is twice its area."""
    reversed: IndexArray
    """The nodes of the cell turned inside out (n_nodes,)."""
    mass_shares: FloatArray
    """Shares of the nodes in the mass of a cell (n_nodes,); none where they are int N dV."""
    rules: Mapping[int, _core.Rule]
    """Quadrature rules by their number of points."""
    files: NamesInFiles

    @property
    def nodes(self) -> int:
        """Return the number of nodes."""
        return len(self.reversed)

    @property
    def is_quadratic(self) -> bool:
        """Return whether edges have a node in their middle."""
        return bool(self.edges.shape[1] == 3)

    @property
    def is_simplex(self) -> bool:
        """Return whether it is a line, a triangle or a tetrahedron."""
        return self.corners == self.dimension + 1

    @cached_property
    def ring(self) -> IndexArray:
        """Return the nodes along a line, or round a plane cell, in the order in which they follow each other."""
        nodes = [node for first, _, *middle in self.edges.tolist() for node in (first, *middle)]
        return np.array(nodes if self.dimension > 1 else [*nodes, 1], dtype=np.intp)

    @cached_property
    def inner(self) -> IndexArray:
        """Return the nodes that lie on no edge."""
        return np.setdiff1d(np.arange(self.nodes), self.edges)


_FLAT = "(?:CAX|CGAX|CPEG?|CPS|M3D|R3D|STRI|S)"
_LINES = (11, 21, 22, 23, 24)
# of I-DEAS: plane stress, plane strain, plate, membrane, axisymmetric solid, thin shell
_NAMES_IN_FILES = {
    "line2": NamesInFiles(3, "line", "T[23]D2|B[23][13]|[MS]AX1|RAX2", _LINES),
    "line3": NamesInFiles(21, "line3", "T[23]D3|B[23]2|[MS]AX2", _LINES),
    "tri3": NamesInFiles(5, "triangle", f"{_FLAT}3", (41, 51, 61, 71, 81, 91)),
    "tri6": NamesInFiles(22, "triangle6", f"{_FLAT}6", (42, 52, 62, 72, 82, 92)),
    "quad4": NamesInFiles(9, "quad", f"{_FLAT}4", (44, 54, 64, 74, 84, 94)),
    "quad8": NamesInFiles(23, "quad8", f"{_FLAT}8", (45, 55, 65, 75, 85, 95)),
    "quad9": NamesInFiles(28, "quad9", f"{_FLAT}9"),
    "hex8": NamesInFiles(12, "hexahedron", "C3D8[RIHT]*$", (115,)),
    "tet4": NamesInFiles(10, "tetra", "C3D4[HT]*$", (111,)),
    "tet10": NamesInFiles(24, "tetra10", "C3D10[MHTS]*$", (118,)),
}


def _read_cell(row: _core.Cell) -> Cell:
    edges, faces, simplices, pieces, spans, reversed_nodes = (
        np.array(rows, dtype=np.intp)
        for rows in (row.edges, row.faces, row.simplices, row.pieces, row.spans, row.reversed)
    )
    return Cell(
        name=row.name,
        plural=row.plural,
        dimension=row.dimension,
        corners=row.corners,
        places=row.places,
        edges=edges,
        faces=faces,
        simplices=simplices,
        pieces=pieces,
        spans=spans,
        reversed=reversed_nodes,
        mass_shares=np.array(row.mass_shares),
        rules={rule.points: rule for rule in row.rules},
        files=_NAMES_IN_FILES[row.name],
    )


CELLS: dict[str, Cell] = {row.name: _read_cell(row) for row in _core.cells()}
"""Every kind of cell by its name."""


def find_cell(dimension: int, connectivity: NDArray[np.integer[Any]]) -> Cell:
    """Return the kind of cells of a dimension with this connectivity (n_cells, n_nodes); of edges it is 1, of faces 2.

    Raises KeyError where there is none.
    """
    nodes = connectivity.shape[1]
    for cell in CELLS.values():
        if cell.dimension == dimension and cell.nodes == nodes:
            return cell
    raise KeyError(f"no cell of dimension {dimension} has {nodes} nodes")


def take_corners(connectivity: NDArray[Integer], dimension: int = 2) -> NDArray[Integer]:
    """Return the corners of cells (n_cells, n_corners)."""
    return connectivity[:, : find_cell(dimension, connectivity).corners]
