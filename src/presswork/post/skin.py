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


def find_skin(mesh: ResultMesh) -> tuple[ResultMesh, NDArray[np.int32] | None]:
    """Return what is seen of a mesh in space, and the cell that each of its faces belongs to.

    Of a solid it is the boundary faces, quadrilaterals or triangles; a sheet is seen itself, and comes without numbers.
    """
    if not any(block.vtk_type in (VTK_TYPES["hex8"], VTK_TYPES["tet4"]) for block in mesh.blocks):
        return mesh, None
    faces, owner = find_boundary_faces([block.connectivity.astype(np.int32) for block in mesh.blocks])
    kind = "quad4" if faces.shape[1] == 4 else "tri3"
    return replace(mesh, blocks=(ResultBlock(kind, VTK_TYPES[kind], faces.astype(np.int64)),)), owner
