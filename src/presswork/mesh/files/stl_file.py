# SPDX-License-Identifier: Apache-2.0
"""The face of a tool as binary STL, whose header marks its open rims as intended."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from presswork.mesh.triangles import find_rims, merge_points
from presswork.model import Triangulation

MERGED = 1e-6
"""Part of a surface's size within which points of a file are one."""
_HEADER = re.compile(r"presswork .*, open edges: (\d+) *")


def pack_stl(name: str, face: Triangulation) -> bytes:
    """Return the face of a tool as a binary STL file [mm]; name: what the header calls it."""
    corners = face.points[face.triangles]
    rows = np.zeros(len(corners), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    rows["normal"] = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    rows["corners"] = corners
    points = corners.reshape(-1, 3).astype(np.float32).astype(np.float64)  # what a reader finds
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    points, triangles = merge_points(points, np.arange(len(points), dtype=np.int32).reshape(-1, 3), MERGED * size)
    rims = find_rims(points, triangles[(triangles != np.roll(triangles, 1, axis=1)).all(axis=1)])
    head = f"presswork {name}, mm, open edges: {sum(len(rim) for rim in rims)}"
    return head.encode("ascii", "replace").ljust(80)[:80] + np.uint32(len(rows)).tobytes() + rows.tobytes()


def count_own_edges(path: Path) -> int | None:
    """Return how many open edges a file has by its header, where this program wrote it; None otherwise."""
    if path.suffix.lower() != ".stl":
        return None
    with path.open("rb") as file:
        found = _HEADER.fullmatch(file.read(80).decode("latin-1"))
    return int(found[1]) if found else None
