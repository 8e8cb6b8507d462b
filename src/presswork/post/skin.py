# SPDX-License-Identifier: Apache-2.0
"""Outer surface of a body in space."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from presswork.mesh.faces import find_boundary_faces
from presswork.model import CELLS, find_cell
from presswork.results import ResultMesh
from presswork.results.reader import ResultBlock


def find_skin(mesh: ResultMesh) -> tuple[ResultMesh, NDArray[np.int32] | None]:
    """Return the visible faces of a mesh in space, and the cell that each of them belongs to.

    For a solid they are the boundary faces, quadrilaterals or triangles of 3 or 6 nodes; a sheet is seen itself, and
    comes without numbers.
    """
    solids = [cell.files.vtk for cell in CELLS.values() if cell.dimension == 3]
    if not any(block.vtk_type in solids for block in mesh.blocks):
        return mesh, None
    faces, owner = find_boundary_faces([block.connectivity.astype(np.int32) for block in mesh.blocks])
    cell = find_cell(2, faces)
    return replace(mesh, blocks=(ResultBlock(cell.name, cell.files.vtk, faces.astype(np.int64)),)), owner
