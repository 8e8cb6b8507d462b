# SPDX-License-Identifier: Apache-2.0
from .checks import MeshError
from .files.readers import read_mesh
from .make.structured import fitting_patterns, grade_line, mesh_rectangle

__all__ = ["MeshError", "fitting_patterns", "grade_line", "mesh_rectangle", "read_mesh"]
