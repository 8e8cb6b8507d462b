# SPDX-License-Identifier: Apache-2.0
"""Nodes of a new skin that slide along the tool on which they lie, until the cells round them are good.

Where the skin has folded flat onto a tool, as at a small lap, all corners of the cells there lie on the tool, and no
move of inner nodes opens them.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from presswork.model import BoolArray, FloatArray, IndexArray
from presswork.remesh.space.inside import improve_cells
from presswork.remesh.space.tetrahedra import measure_quality, rate_tetrahedra
from presswork.remesh.space.tools import PlacedTool, put_on_tools

_ROUNDS, _STEPS = 6, 6
"""In which nodes of bad cells are visited, and steps of the search for a better place of each."""
_FIRST_STEP, _GAIN = 0.4, 1e-3
"""First step of that search, over the mean edge round the node; least gain of quality that a step must bring."""
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
    order = np.argsort(cells.ravel(), kind="stable")
    first = np.searchsorted(cells.ravel()[order], np.arange(len(points) + 1))
    for _ in range(_ROUNDS):
        quality = measure_quality(points, cells)
        nodes = np.unique(cells[quality < least])
        moved = False
        for node in nodes[slides[nodes]].tolist():
            around = cells[order[first[node] : first[node + 1]] // 4]
            tool = tools[int(np.argmax(on_tool[:, node]))]
            place = _search(points, around, node, tool)
            moved |= bool((place != points[node]).any())
            points[node] = place
        points = improve_cells(points, cells, skin, least)
        if not moved or measure_quality(points, cells).min() >= least:
            break
    return points


def _search(points: FloatArray, around: IndexArray, node: int, tool: PlacedTool) -> FloatArray:
    """Return where on its tool a node makes the worst of the cells (k, 4) round it best."""
    own = around == node
    corners = points[around]
    place: FloatArray = points[node]
    edge = float(np.linalg.norm(corners[~own] - place, axis=1).mean())
    _, normal = tool.touch(place[None], edge)
    if not np.isfinite(normal).all() or not normal.any():
        return place
    axis = np.eye(3)[np.argmin(np.abs(normal[0]))]
    u = np.cross(normal[0], axis)
    u /= np.linalg.norm(u)
    along = np.cos(_ANGLES)[:, None] * u + np.sin(_ANGLES)[:, None] * np.cross(normal[0], u)

    def measure(places: FloatArray) -> FloatArray:
        """Return the worst quality with the node at each of the places (m, 3)."""
        tried = np.where(own[None, :, :, None], places[:, None, None], corners[None])
        return np.asarray(rate_tetrahedra(tried.reshape(-1, 4, 3)).reshape(len(places), -1).min(axis=1))

    step, best = _FIRST_STEP * edge, float(measure(place[None])[0])
    free = np.zeros((len(along), 3), dtype=bool)
    all_on = np.ones((1, len(along)), dtype=bool)
    for _ in range(_STEPS):
        places = put_on_tools(place + step * along, [tool], all_on, free, edge)
        found = measure(places)
        top = int(np.argmax(found))
        if found[top] > best + _GAIN:
            place, best = places[top], float(found[top])
        else:
            step *= 0.5
    return place
