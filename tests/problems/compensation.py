# SPDX-License-Identifier: Apache-2.0
"""A strip pressed round a cylinder, and where it springs to in closed form; and a channel."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from presswork.mesh.files.stl_file import pack_stl
from presswork.model import FloatArray, Triangulation
from presswork.post.released_part import ReleasedPart

THICKNESS, YIELD, YOUNG = 1.0, 300.0, 210e3
ELASTIC = 2.0 * YIELD / (YOUNG * THICKNESS)
"""Curvature at first yield [1/mm]."""
WANTED, DIE = 50.0, 41.2101
"""Radius of the part, and of the die that it springs from [mm]."""


def spring(curvature: FloatArray) -> FloatArray:
    """Return the curvature after springback; elastic, perfectly plastic: Hill (1950), The Mathematical Theory of
    Plasticity, IV.5.
    """
    return curvature - 1.5 * ELASTIC + 0.5 * ELASTIC**3 / curvature**2


def arc(radius: float, length: float = 40.0, cells: int = 80) -> tuple[FloatArray, np.ndarray]:
    """Return nodes (n, 3) and triangles of a strip of three rows along half an arc from x = 0."""
    s = np.linspace(0.0, length, cells + 1) / radius
    line = np.stack([radius * np.sin(s), radius * (1.0 - np.cos(s))], axis=1)
    y = np.array([-1.0, 0.0, 1.0])
    points = np.array([[x, each, z] for x, z in line for each in y])
    k = np.arange(cells)[:, None] * 3 + np.arange(2)
    a, b, c, d = (part.ravel() for part in (k, k + 3, k + 4, k + 1))
    return points, np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]).astype(np.int32)


def release(formed: FloatArray, triangles: np.ndarray) -> ReleasedPart:
    """Return a strip of `arc` after springback, each station with the curvature of its own."""
    line = formed[1::3][:, [0, 2]]
    step = np.diff(line, axis=0)
    length, angle = np.linalg.norm(step, axis=1), np.arctan2(step[:, 1], step[:, 0])
    middle = 0.5 * (length[1:] + length[:-1])
    turn = spring(np.diff(angle) / middle) * middle
    first = 0.5 * spring(2.0 * angle[:1] / length[0]) * length[0]  # from the plane of symmetry
    angle = np.cumsum(np.concatenate([first, turn]))
    way = length[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    free = np.concatenate([np.zeros((1, 2)), np.cumsum(way, axis=0)])
    points = formed.copy()
    points[:, [0, 2]] = np.repeat(free, 3, axis=0)
    return ReleasedPart(formed, points, triangles)


def fit_radius(points: FloatArray) -> float:
    """Return the radius of the circle through points by x and z."""
    x, _, z = points.T
    (a, b, c), *_ = np.linalg.lstsq(np.column_stack([x, z, np.ones_like(x)]), x**2 + z**2, rcond=None)
    return float(np.sqrt(c + 0.25 * (a**2 + b**2)))


def channel_face(up: float, *, walls: float = 75.0, depth: float = 16.0, reach: float = 45.0) -> Triangulation:
    """Return a face of a hat channel's tools parallel to its middle.

    up: by so much over the middle of the sheet [mm]. The middle has radii of 5 mm, a bottom 30 mm wide between its
    corners, and flanges from z = 0 as far as `reach`.
    """
    run = depth / np.tan(np.radians(walls))
    corners = np.array([[0.0, -depth], [15.0, -depth], [15.0 + run, 0.0], [reach, 0.0]])
    line = [np.array([[0.0, up - depth]])]
    for k, offset in ((1, -up), (2, up)):
        before, corner, after = corners[k - 1 : k + 2]
        one, other = (e / np.linalg.norm(e) for e in (before - corner, after - corner))
        half = 0.5 * np.arccos(one @ other)
        centre = corner + (one + other) / np.linalg.norm(one + other) * 5.0 / np.sin(half)
        ends = [corner + e * 5.0 / np.tan(half) - centre for e in (one, other)]
        angle = [np.arctan2(e[1], e[0]) for e in ends]
        turn = (angle[1] - angle[0] + np.pi) % (2 * np.pi) - np.pi
        sweep = angle[0] + turn * np.linspace(0.0, 1.0, 13)
        line.append(centre + (5.0 + offset) * np.stack([np.cos(sweep), np.sin(sweep)], axis=1))
    line.append(np.array([[reach, up]]))
    right = np.concatenate(line)
    whole = np.concatenate([right[:0:-1] * (-1.0, 1.0), right])
    n = len(whole)
    points = np.concatenate([np.insert(whole, 1, y, axis=1) for y in (-6.0, 6.0)])
    i = np.arange(n - 1)
    cells = np.concatenate([np.stack([i, i + 1, i + 1 + n], axis=1), np.stack([i, i + 1 + n, i + n], axis=1)])
    return Triangulation(points, (cells if up < 0 else cells[:, ::-1]).astype(np.int32), is_closed=False)


def write_channel(folder: Path, **changes: Any) -> Path:
    """Write the case of a slice of a channel crash-formed between punch and die of facets; return its path."""
    (folder / "die.stl").write_bytes(pack_stl("die", channel_face(-0.5)))
    (folder / "punch.stl").write_bytes(pack_stl("punch", channel_face(0.6)))
    case = {
        "title": "hat channel", "analysis": "stamping",
        "blank": {"shape": "rectangle", "size": [76, 4], "thickness": 1, "element_size": [1.5, 4], "points": 5,
                  "material": "dp780", "symmetry": ["x"]},
        "tools": {kind: {"kind": kind, "shape": "file", "path": f"{kind}.stl"} for kind in ("punch", "die")},
        "boundary": {"slice": {"set": "all", "fix": ["y", "rx", "rz"]}},
        "stages": [{"name": "form", "velocity": "12 m/s", "tools": {"punch": {"stroke": 15.9}}}],
        "springback": {},
        "output": {"rows": 4, "steps": 1},
        **changes,
    }  # fmt: skip
    path = folder / "channel.toml"
    path.write_text(tomli_w.dumps(case))
    return path
