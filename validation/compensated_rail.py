# SPDX-License-Identifier: Apache-2.0
"""An S-rail of DP780, drawn under a holder and trimmed, whose dies are corrected for springback.

    python -m validation.compensated_rail OUT [LOOPS]

A hat section 16 mm deep, walls of 75 degrees, radii of 5 mm, along two arcs of 25 degrees with a radius of 120 mm
about opposite centres, with straight ends of 30 mm; sheet of 1 mm, holder of 60 kN. The rail twists when it is let go.
A few minutes a loop.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import tomli_w

from presswork.mesh.files.stl_file import pack_stl
from presswork.model import FloatArray, Triangulation
from presswork.study import Compensation, compensate_springback
from tests.problems.compensation import channel_face

RADIUS, ANGLE, END = 120.0, np.radians(25.0), 30.0
"""Of the arcs [mm, rad], and the length of the straight ends [mm]."""
_REACH, _SHOULDER, _FLANGE, _TRIM = 42.0, 19.5, 23.0, 28.0
"""How far from the middle line the tools go, where the punch ends and the holder begins, and the cut [mm]."""


def middle_line(beyond: float = 0.0, step: float = 2.0) -> tuple[FloatArray, FloatArray]:
    """Return points (n, 2) of the middle line and the normals there, the ends longer by so much [mm]."""
    half = END + RADIUS * ANGLE + beyond
    s = np.linspace(-half, half, 2 * int(np.ceil(half / step)) + 1)
    angle = np.where(np.abs(s) < RADIUS * ANGLE, np.abs(s) / RADIUS - ANGLE, 0.0)
    way = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points = np.zeros((len(s), 2))
    points[1:] = np.cumsum(0.5 * (way[1:] + way[:-1]) * np.diff(s)[:, None], axis=0)
    return points - points[len(s) // 2], np.stack([-way[:, 1], way[:, 0]], axis=1)


def rail_face(up: float, across: tuple[float, float] = (0.0, _REACH)) -> Triangulation:
    """Return a face of the rail's tools, by so much over the middle of the sheet and so far from the middle line."""
    section = channel_face(up, reach=_REACH)
    line = section.points[section.points[:, 1] < 0.0][:, [0, 2]]
    line = line[(np.abs(line[:, 0]) >= across[0] - 1e-9) & (np.abs(line[:, 0]) <= across[1] + 1e-9)]
    at, normal = middle_line(beyond=12.0)
    plan = at[:, None] + line[None, :, :1] * normal[:, None]
    points = np.concatenate([plan, np.broadcast_to(line[None, :, 1:], (*plan.shape[:2], 1))], axis=2).reshape(-1, 3)
    n = len(line)
    whole = np.flatnonzero(np.diff(line[:, 0]) < 2.0 * _FLANGE - 1.0)  # a holder has two halves
    a = (np.arange(len(at) - 1)[:, None] * n + whole).ravel()
    cells = np.concatenate([np.stack([a, a + 1, a + 1 + n], axis=1), np.stack([a, a + 1 + n, a + n], axis=1)])
    return Triangulation(points, (cells[:, ::-1] if up < 0 else cells).astype(np.int32), is_closed=False)


def outline(half_width: float, beyond: float = 0.0) -> FloatArray:
    """Return the corners (n, 2) of a strip along the middle line."""
    at, normal = middle_line(beyond)
    return np.concatenate([at + half_width * normal, (at - half_width * normal)[::-1]])


def write_rail(folder: Path) -> Path:
    """Write the case and its tools; return its path."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "die.stl").write_bytes(pack_stl("die", rail_face(-0.5)))
    (folder / "punch.stl").write_bytes(pack_stl("punch", rail_face(0.53, (0.0, _SHOULDER))))
    (folder / "holder.stl").write_bytes(pack_stl("holder", rail_face(0.5, (_FLANGE, _REACH))))
    np.savetxt(folder / "blank.txt", outline(_REACH - 4.0, 4.0), fmt="%.6f")
    case = {
        "title": "S-rail", "analysis": "stamping",
        "blank": {"shape": "outline", "path": "blank.txt", "thickness": 1, "element_size": 2.5, "points": 7,
                  "material": "dp780"},
        "tools": {kind: {"kind": kind, "shape": "file", "path": f"{kind}.stl"} for kind in ("punch", "die", "holder")},
        "stages": [{"name": "form", "velocity": "3 m/s",
                    "tools": {"punch": {"stroke": 16.0}, "holder": {"force": 60e3}}}],
        "trim": {"edge": {"shape": "polygon", "points": outline(_TRIM).tolist()}},
        "springback": {},
        "output": {"rows": 10, "steps": 2},
    }  # fmt: skip
    path = folder / "rail.toml"
    path.write_text(tomli_w.dumps(case))
    return path


def compensate_rail(folder: Path, *, most: int = 3, tolerance: float = 0.05) -> Compensation:
    """Correct the tools of the rail."""
    case = write_rail(folder)
    return compensate_springback(case, folder / "out", tolerance=tolerance, most=most, threads=1, overwrite=True)


if __name__ == "__main__":
    found = compensate_rail(Path(sys.argv[1]), most=int(sys.argv[2]) if len(sys.argv) > 2 else 3)
    print(found.status, found.reason)
    print((found.folder / "table.csv").read_text())
