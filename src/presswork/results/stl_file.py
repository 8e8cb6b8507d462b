# SPDX-License-Identifier: Apache-2.0
"""The face of a tool as a binary STL file."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from presswork.model import ToolKind, Triangulation
from presswork.results.whole_file import replace_whole


def write_stl(path: Path, kind: ToolKind, tool: Triangulation) -> None:
    """Write the face of a tool as a binary STL file [mm]. Raises OutputError."""
    corners = tool.points[tool.triangles]
    rows = np.zeros(len(corners), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    rows["normal"] = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    rows["corners"] = corners
    head = f"presswork {kind}, mm".encode().ljust(80)
    content = head + np.uint32(len(rows)).tobytes() + rows.tobytes()
    with replace_whole(path, needed_bytes=len(content)) as temporary:
        temporary.write_bytes(content)
