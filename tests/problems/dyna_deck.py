# SPDX-License-Identifier: Apache-2.0
"""A deck of LS-DYNA: a quarter of a round cup, or a part of it, with tools as meshes of revolution."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from presswork.model import FloatArray, IndexArray

PUNCH, DIE, OPENING, NOSE, SHOULDER, BLANK, THICKNESS = 25.0, 40.0, 26.2, 6.0, 5.0, 45.0, 1.0
"""Radii of punch, holder and die faces, opening, punch's nose, die's shoulder, blank; thickness [mm]."""
STROKE, HOLDING = 12.0, 20e3
"""Of the punch [mm]; force on the whole holder [N]."""


@dataclass
class Grid:
    """Nodes and shells of a part."""

    points: FloatArray
    cells: IndexArray


def grid_of(points: FloatArray, n: int, m: int) -> Grid:
    """Return the shells between n x m points, one row after the other."""
    number = np.arange(n * m).reshape(n, m)
    cells = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1)
    return Grid(points, cells.reshape(-1, 4))


def turn_profile(profile: FloatArray, cells_around: int) -> Grid:
    """Return the surface of a profile (n, 2) of r, z over a quarter turn."""
    angle = np.linspace(0.0, 0.5 * np.pi, cells_around + 1)
    r, z = profile.T
    points = np.stack(
        [np.outer(r, np.cos(angle)), np.outer(r, np.sin(angle)), np.outer(z, np.ones_like(angle))], axis=-1
    )
    return grid_of(points.reshape(-1, 3), len(profile), len(angle))


def arc(centre: Sequence[float], radius: float, begin: float, end: float, n: int = 13) -> FloatArray:
    """Return points (n, 2) of an arc between two angles [degree]."""
    angle = np.radians(np.linspace(begin, end, n))
    return np.asarray(centre) + radius * np.column_stack([np.cos(angle), np.sin(angle)])


def make_grids(n: int = 12) -> dict[str, Grid]:
    """Return blank, punch, holder and die where they just touch the blank."""
    half = 0.5 * THICKNESS
    u, v = (each.ravel() for each in np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1), indexing="ij"))
    plan = BLANK * np.column_stack([u * np.sqrt(1 - 0.5 * v * v), v * np.sqrt(1 - 0.5 * u * u)])
    blank = grid_of(np.column_stack([plan, np.zeros(len(plan))]), n + 1, n + 1)
    nose = arc((PUNCH - NOSE, half + NOSE), NOSE, -90.0, 0.0)
    punch = turn_profile(np.vstack([[[0.0, half]], nose, [[PUNCH, half + 30.0]]]), 24)
    shoulder = arc((OPENING + SHOULDER, -half - SHOULDER), SHOULDER, 180.0, 90.0)
    die = turn_profile(np.vstack([[[OPENING, -half - 40.0]], shoulder, [[DIE + 15, -half]]]), 24)
    holder = turn_profile(np.array([[OPENING, half + 20.0], [OPENING, half], [DIE + 15.0, half]]), 24)
    return {"blank": blank, "punch": punch, "holder": holder, "die": die}


def row(*values: object, width: int = 10) -> str:
    """Return a row of fields."""
    texts = (value if isinstance(value, str) else f"{value:.{width - 5}g}" for value in values)
    return "".join(text.rjust(width) for text in texts)


MATERIAL = """*MAT_3-PARAMETER_BARLAT
$#     mid        ro         e        pr        hr        p1        p2      iter
         17.85000E-9  207000.0       0.3         2     565.0      0.26         0
$#       m       r00       r45       r90      lcid        e0       spi        p3
         6      1.79      1.51      2.27         0   0.00712       0.0       0.0
       2.0
{rolling}


"""
TAIL = """*DEFINE_CURVE_TITLE
speed of the punch
         3         0       1.0       1.0
                 0.0                 0.0
               1.0-4                 0.0
              1.2E-3{speed:>20}
              6.2E-3{speed:>20}
              7.3E-3                 0.0
*DEFINE_CURVE
         4
0.0,0.0
1.0E-4,{force}
1.0,{force}
*BOUNDARY_PRESCRIBED_MOTION_RIGID
         2         {axis}         0         3      {sense:4.1f}
*LOAD_RIGID_BODY
         3         {axis}         4      {sense:4.1f}
*CONTROL_TERMINATION
    7.3E-3
*DATABASE_BINARY_D3PLOT
     1e-3
*END
"""


def write_deck(turn: FloatArray | None = None, material: str = MATERIAL, tail: str = TAIL) -> str:
    """Return the deck; turn: a rotation by quarter turns that the whole press is given (3, 3)."""
    turn = np.eye(3) if turn is None else turn
    axes = np.abs(turn).argmax(axis=0)
    rolling = row(0.0, 0.0, 0.0, *turn[:, 0])
    lines = ["*KEYWORD", "*TITLE", "a round cup", material.format(rolling=rolling).rstrip("\n")]
    rigid = row(0.0, 7.85e-9, 2.07e5, 0.3)
    for number in (2, 3, 4):
        lines += ["*MAT_RIGID", row(number) + rigid[10:], row(1, 4, 7), row(0.0, 0.0, 0.0)]
    lines += ["*SECTION_SHELL", row(1, 2, 0.833, 5, 1), row(*[THICKNESS] * 4)]
    lines += ["*SECTION_SHELL", row(2, 2, 0.833, 2, 1), row(*[1.0] * 4)]
    first, edges = 1, {}
    for number, (name, grid) in enumerate(make_grids().items(), start=1):
        points = grid.points @ turn.T
        lines += ["*PART", name, row(number, min(number, 2), number)]
        lines += ["*NODE", *(f"{first + i:8d}" + "".join(f"{x:16.8E}" for x in p) for i, p in enumerate(points))]
        cells = first + grid.cells
        lines += ["*ELEMENT_SHELL"]
        lines += [f"{first + i:8d}{number:8d}" + "".join(f"{n:8d}" for n in cell) for i, cell in enumerate(cells)]
        if name == "blank":
            edges = {axis: first + np.flatnonzero(np.abs(grid.points[:, axis]) < 1e-9) for axis in (0, 1)}
        first += len(points)
    held = {0: (1, 0, 0, 0, 1, 1), 1: (0, 1, 0, 1, 0, 1)}
    of_axis = {axis: [held[axis][list(axes).index(i % 3) + 3 * (i > 2)] for i in range(6)] for axis in held}
    for axis, nodes in edges.items():
        lines += ["*SET_NODE_LIST", row(axis + 1)]
        lines += [row(*nodes[i : i + 8]) for i in range(0, len(nodes), 8)]
        lines += ["*BOUNDARY_SPC_SET", row(axis + 1, 0, *of_axis[axis])]
    for tool in (2, 3, 4):
        lines += ["*CONTACT_FORMING_ONE_WAY_SURFACE_TO_SURFACE_ID", row(tool) + "blank with a tool"]
        lines += [row(1, tool, 3, 3), row(0.1), row(1.0, 1.0)]
    speed = STROKE / 6.1e-3
    drive = {"axis": int(axes[2]) + 1, "sense": -turn[axes[2], 2]}
    return "\n".join(lines) + "\n" + tail.format(speed=f"{speed:.9g}", force=f"{HOLDING / 4:g}", **drive)
