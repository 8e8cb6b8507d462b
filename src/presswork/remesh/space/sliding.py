# SPDX-License-Identifier: Apache-2.0
"""Nodes of a new skin that slide along the tool on which they lie, until the cells round them are good.

Where the skin has folded flat onto a tool, as at a small lap, all corners of the cells there lie on the tool, and no
move of inner nodes opens them.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from presswork.model import BoolArray, FloatArray, IndexArray
from presswork.remesh.space.bad_cells import Tries, move_nodes_of_bad_cells
from presswork.remesh.space.inside import improve_cells
from presswork.remesh.space.tetrahedra import measure_quality
from presswork.remesh.space.tools import PlacedTool, put_on_tools

_ROUNDS, _STEPS = 6, 6
"""Number of rounds in which nodes of bad cells are visited, and of steps of the search for a better place of each."""
_ANGLES = np.arange(12) * (2.0 * np.pi / 12)


def slide_on_tools(
    points: FloatArray,
    cells: IndexArray,
    skin: IndexArray,
    on_tool: BoolArray,
    held: BoolArray,
    tools: Sequence[PlacedTool],
    least: float,
) -> FloatArray:
    """Return nodes (n, 3) of which those of bad cells have moved, inner ones anywhere and others along their tool.

    on_tool (n_tools, n): nodes on more than one tool, or that planes hold (n, 3), stay. Ends where the worst cell has
    the least quality.
    """
    points = points.copy()
    slides = (on_tool.sum(axis=0) == 1) & ~held.any(axis=1)

    def find_tries(node: int, place: FloatArray, edge: float) -> Tries | None:
        return _find_tries_along(tools[int(np.argmax(on_tool[:, node]))], place, edge)

    for _ in range(_ROUNDS):
        moved = move_nodes_of_bad_cells(points, cells, slides, least, _STEPS, find_tries)
        points = improve_cells(points, cells, skin, least)
        if not moved or measure_quality(points, cells).min() >= least:
            break
    return points


def _find_tries_along(tool: PlacedTool, place: FloatArray, edge: float) -> Tries | None:
    """Return what is tried for a node on a tool; None where the tool has no normal there."""
    _, normal = tool.touch(place[None], edge)
    if not np.isfinite(normal).all() or not normal.any():
        return None
    axis = np.eye(3)[np.argmin(np.abs(normal[0]))]
    u = np.cross(normal[0], axis)
    u /= np.linalg.norm(u)
    along = np.cos(_ANGLES)[:, None] * u + np.sin(_ANGLES)[:, None] * np.cross(normal[0], u)
    free = np.zeros((len(along), 3), dtype=bool)
    all_on = np.ones((1, len(along)), dtype=bool)
    return lambda place, step: put_on_tools(place + step * along, [tool], all_on, free, edge)
