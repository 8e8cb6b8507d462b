# SPDX-License-Identifier: Apache-2.0
"""Outer surface of a body in space."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from presswork.mesh.faces import find_boundary_faces
from presswork.results import ResultMesh
from presswork.results.reader import ResultBlock
from presswork.results.vtkhdf import VTK_TYPES

_SOLIDS = [VTK_TYPES[cell] for cell in ("hex8", "tet4", "tet10")]


def find_skin(mesh: ResultMesh) -> tuple[ResultMesh, NDArray[np.int32] | None]:
    """Return what is seen of a mesh in space, and the cell that each of its faces belongs to.

    Of a solid it is the boundary faces, quadrilaterals or triangles of 3 or 6 nodes; a sheet is seen itself, and comes
    without numbers.
    """
    if not any(block.vtk_type in _SOLIDS for block in mesh.blocks):
        return mesh, None
    faces, owner = find_boundary_faces([block.connectivity.astype(np.int32) for block in mesh.blocks])
    kind = {3: "tri3", 4: "quad4", 6: "tri6"}[faces.shape[1]]
    return replace(mesh, blocks=(ResultBlock(kind, VTK_TYPES[kind], faces.astype(np.int64)),)), owner
