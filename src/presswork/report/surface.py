# SPDX-License-Identifier: Apache-2.0
"""What a page draws of a mesh: triangles, the lines between cells, and the boundary of a section."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from presswork.model import FloatArray, find_cell, take_corners
from presswork.post import find_skin
from presswork.results import ResultMesh
from presswork.view.cells import triangulate

Indices = NDArray[np.int64]


@dataclass(frozen=True)
class Surface:
    """The outer surface of a solid in space, a sheet, or a section; nodes and faces are numbered anew."""

    nodes: Indices
    """Node of the mesh of each node of the surface (n,); with the inside, its nodes follow."""
    cells: Indices
    """Cell of the mesh of each face (n_faces,); with the inside, the cells without a face follow."""
    triangles: Indices
    """Nodes of the surface (n_triangles, 3)."""
    faces: Indices
    """Face of each triangle (n_triangles,)."""
    lines: Indices
    """Ends of the lines between faces, each once (n_lines, 2)."""
    boundary: Indices
    """Ends of the lines around a section or a sheet (n, 2), mid-side nodes between; the body on the left."""
    hexahedra: Indices
    """Nodes of the cells of a solid in space (n_cells, 8), as numbered here; of a tetrahedron its corners, 0 1 2 2 3 3
    3 3. None without the inside."""
    owners: Indices
    """The face or cell in `cells` that is each hexahedron, or one of its faces (n_cells,)."""
    welds: Indices
    """Ends of the lines along welds of a welded blank (n, 2)."""

    def take_points(self, values: FloatArray) -> FloatArray:
        """Return the values of the surface's nodes out of those of all nodes."""
        return np.asarray(values[self.nodes], dtype=np.float64)

    def take_cells(self, values: FloatArray) -> FloatArray:
        """Return the values of the faces out of those of all cells."""
        return np.asarray(values[self.cells], dtype=np.float64)


def find_surface(mesh: ResultMesh, *, has_inside: bool = False, welds: NDArray[np.integer] | None = None) -> Surface:
    """Return what is seen of a mesh.

    has_inside: of a solid in space also what a cut would lay open. welds: nodes along welds (n, 2), if there are any.
    """
    skin, owner = find_skin(mesh)
    parts = [triangulate(replace(skin, blocks=(block,))) for block in skin.blocks]
    counts = [len(block.connectivity) for block in skin.blocks]
    triangles_a_face = [len(part) // max(count, 1) for part, count in zip(parts, counts, strict=True)]
    faces = np.repeat(np.arange(sum(counts)), np.repeat(triangles_a_face, counts))
    triangles = np.concatenate(parts)
    is_seen = np.zeros(len(mesh.points), dtype=bool)
    is_seen[triangles] = True
    nodes = np.flatnonzero(is_seen)
    cells = np.arange(sum(counts)) if owner is None else owner.astype(np.int64)
    hexahedra, owners = np.zeros((0, 8), dtype=np.int64), np.zeros(0, dtype=np.int64)
    if has_inside and owner is not None:
        hexahedra = np.concatenate([_as_hexahedra(block.connectivity) for block in mesh.blocks]).astype(np.int64)
        is_inside = np.zeros(len(mesh.points), dtype=bool)
        is_inside[hexahedra] = True
        nodes = np.concatenate([nodes, np.flatnonzero(is_inside & ~is_seen)])
        has_face = np.zeros(len(hexahedra), dtype=bool)
        has_face[cells] = True
        cells = np.concatenate([cells, np.flatnonzero(~has_face)])
        owners = np.zeros(len(hexahedra), dtype=np.int64)
        owners[cells[::-1]] = np.arange(len(cells))[::-1]
    renumbered = np.zeros(len(mesh.points), dtype=np.int64)
    renumbered[nodes] = np.arange(len(nodes))
    boundary = np.concatenate([mesh.boundary_edges[:, ends] for ends in find_cell(1, mesh.boundary_edges).pieces])
    return Surface(
        nodes=nodes,
        cells=cells,
        triangles=renumbered[triangles].reshape(-1, 3),
        faces=faces,
        lines=_find_lines([renumbered[block.connectivity] for block in skin.blocks], len(nodes)),
        boundary=renumbered[boundary].reshape(-1, 2),
        hexahedra=renumbered[hexahedra],
        owners=owners,
        welds=renumbered[np.zeros((0, 2), dtype=np.int64) if welds is None else welds].reshape(-1, 2),
    )


def _as_hexahedra(cells: Indices) -> Indices:
    """Return tetrahedra as hexahedra whose corners coincide; hexahedra as they are."""
    return cells[:, [0, 1, 2, 2, 3, 3, 3, 3]] if find_cell(3, cells).is_simplex else take_corners(cells, 3)


def _find_lines(blocks: list[Indices], n_nodes: int) -> Indices:
    """Return the sides of all faces, those of two faces once; a side with a node in the middle as two lines."""
    keys = []
    for cells in blocks:
        loop = cells[:, find_cell(2, cells).ring]
        start, end = loop.ravel(), np.roll(loop, -1, axis=1).ravel()
        keys.append(np.minimum(start, end) * n_nodes + np.maximum(start, end))
    once = np.unique(np.concatenate(keys))
    return np.column_stack(np.divmod(once, n_nodes))
