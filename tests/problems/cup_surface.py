# SPDX-License-Identifier: Apache-2.0
"""A round cup and its tools as STL, as a CAD program writes them: punch of 50 mm, die opening of 54 mm."""

from __future__ import annotations

from math import cos, pi, sin
from pathlib import Path

import numpy as np

from presswork.mesh.files.stl_file import pack_stl
from presswork.model import FloatArray, Triangulation

AROUND = 48


def revolve(profile: list[tuple[float, float]]) -> FloatArray:
    """Return triangles (n, 3, 3) of a profile (radius, height) turned about z [mm]."""
    angles = np.linspace(0.0, 2.0 * pi, AROUND + 1)
    rings = np.array([[[r * np.cos(a), r * np.sin(a), z] for a in angles] for r, z in profile])
    lower, upper = rings[:-1], rings[1:]
    quads = [lower[:, :-1], upper[:, :-1], upper[:, 1:], lower[:, 1:]]
    triangles = np.concatenate([np.stack([quads[i] for i in corners], axis=2) for corners in ((0, 1, 2), (0, 2, 3))])
    triangles = triangles.reshape(-1, 3, 3)
    areas = np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1)
    return np.asarray(triangles[areas > 1e-9])


def draw_round(centre: tuple[float, float], radius: float, first: float, last: float) -> list[tuple[float, float]]:
    """Return points of an arc from one angle to another [degree]."""
    angles = np.linspace(first, last, 7) * pi / 180.0
    return [(centre[0] + radius * cos(a), centre[1] + radius * sin(a)) for a in angles]


def write_stl(path: Path, triangles: FloatArray) -> None:
    """Write triangles (n, 3, 3) [mm] as a binary STL file."""
    points = np.ascontiguousarray(triangles.reshape(-1, 3))
    surface = Triangulation(points, np.arange(len(points), dtype=np.int32).reshape(-1, 3), is_closed=False)
    path.write_bytes(pack_stl(path.stem, surface))


def write_cup_tools(folder: Path) -> None:
    """Write punch.stl, die.stl, holder.stl and the mid-surface part.stl into a folder."""
    surfaces = {
        "punch": [(0.0, 0.0), *draw_round((20.0, 5.0), 5.0, -90.0, 0.0), (25.0, 40.0)],
        "die": [(70.0, 0.0), *draw_round((33.0, -6.0), 6.0, 90.0, 180.0), (27.0, -40.0)],
        "holder": [(27.0, 0.0), (70.0, 0.0)],
        "part": [
            (0.0, -20.0),
            *draw_round((20.0, -15.0), 5.0, -90.0, 0.0),
            *draw_round((31.0, -6.0), 6.0, 180.0, 90.0),
            (40.0, 0.0),
        ],
    }
    for name, profile in surfaces.items():
        write_stl(folder / f"{name}.stl", revolve(profile))
