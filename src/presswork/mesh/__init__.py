# SPDX-License-Identifier: Apache-2.0
"""Meshes of the workpiece: structured generators and readers of mesh files."""

from presswork.mesh.checks import MeshError
from presswork.mesh.readers import read_mesh
from presswork.mesh.structured import cell_kind, fitting_patterns, grade_line, mesh_rectangle

__all__ = ["MeshError", "cell_kind", "fitting_patterns", "grade_line", "mesh_rectangle", "read_mesh"]
