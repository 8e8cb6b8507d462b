# SPDX-License-Identifier: Apache-2.0
"""Formed sheets of any shape, drawn at random by a seed: what writers and maps are tried on."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from presswork.mesh.files.dynain import first_sides
from presswork.mesh.files.formed.layers import MATRIX
from presswork.mesh.files.formed.writers import find_format
from presswork.mesh.thickness_rule import thickness_rule
from presswork.model import FormedSheet, Section
from presswork.process.line.formed_sheet import TO


def random_sheet(seed: int, rule: str = "gauss", points: int = 5, cells: tuple[int, int] = (4, 3)) -> FormedSheet:
    """Return a bowed and twisted patch of quadrilaterals, the last row cut into triangles; nothing of it is even."""
    rng = np.random.default_rng(seed)
    nx, ny = cells
    x, y = (v.ravel() for v in np.meshgrid(np.linspace(0, 40, nx + 1), np.linspace(0, 25, ny + 1)))
    moved = 0.8 * rng.uniform(-1, 1, (2, len(x)))
    nodes = np.column_stack([x + moved[0], y + moved[1], 0.02 * x**2 - 0.015 * x * y + rng.uniform(-0.3, 0.3, len(x))])
    nodes = nodes @ np.linalg.qr(rng.normal(size=(3, 3)))[0]
    first = (np.arange(ny)[:, None] * (nx + 1) + np.arange(nx)).ravel()
    quads = np.column_stack([first, first + 1, first + nx + 2, first + nx + 1])
    cut = quads[-nx:]
    triangles = np.concatenate([cut[:, [0, 1, 2, 2]], cut[:, [0, 2, 3, 3]]])
    own = np.concatenate([quads[:-nx], triangles]).astype(np.int32)
    heights = thickness_rule(Section(1.0, points, rule))[0]  # type: ignore[arg-type]
    side, normal = first_sides(nodes, own)
    turn = rng.uniform(-np.pi, np.pi, len(own))[:, None]
    axis = np.cos(turn) * side + np.sin(turn) * np.cross(normal, side)
    across = np.cross(normal, axis)
    xx, yy, xy = rng.uniform(-300, 300, (3, len(own), points, 1, 1))
    pairs = ((xx, axis, axis), (yy, across, across), (xy, axis, across), (xy, across, axis))
    tensor = np.asarray(sum(s * (a[:, None, :, None] * b[:, None, None, :]) for s, a, b in pairs))
    plastic = rng.uniform(0, 0.4, (len(own), points))
    return FormedSheet(nodes, own, rng.uniform(0.6, 1.4, len(own)), axis, heights, tensor[:, :, TO[0], TO[1]], plastic)


def as_matrix(stress: np.ndarray) -> np.ndarray:
    """Return stresses xx, yy, zz, xy, yz, zx (..., 6) as matrices (..., 3, 3)."""
    return stress[..., MATRIX]


def text_of(path: Path, sheet: FormedSheet) -> str:
    """Return what a file of this name holds of a sheet, in a format of text."""
    return find_format(path).write(sheet, "a part", "middle").decode("ascii")
