# SPDX-License-Identifier: Apache-2.0
"""Nodes of bad cells move, one after another, to where the worst cell round each is best."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from presswork.model import BoolArray, FloatArray, IndexArray
from presswork.remesh.space.tetrahedra import measure_quality, rate_tetrahedra

_FIRST_STEP, _GAIN = 0.4, 1e-3
"""First step of the search, over the mean edge round the node; least gain of quality that a step must bring."""

Tries = Callable[[FloatArray, float], FloatArray]
"""Gives the places (m, 3) to be tried a step [mm] away from a place (3,)."""


def move_nodes_of_bad_cells(
    points: FloatArray,
    cells: IndexArray,
    moves: BoolArray,
    wanted: float,
    steps: int,
    find_tries: Callable[[int, FloatArray, float], Tries | None],
) -> bool:
    """Visit the nodes that may move (n,) of cells below the wanted quality; return whether any of points has moved.

    steps: of the search for each node. find_tries: of a node, its place, the mean edge round it [mm]; None: it stays.
    """
    order = np.argsort(cells.ravel(), kind="stable")
    first = np.searchsorted(cells.ravel()[order], np.arange(len(points) + 1))
    nodes = np.unique(cells[measure_quality(points, cells) < wanted])
    moved = False
    for node in nodes[moves[nodes]].tolist():
        around = cells[order[first[node] : first[node + 1]] // 4]
        place = _search(points, around, node, steps, find_tries)
        moved |= bool((place != points[node]).any())
        points[node] = place
    return moved


def _search(
    points: FloatArray,
    around: IndexArray,
    node: int,
    steps: int,
    find_tries: Callable[[int, FloatArray, float], Tries | None],
) -> FloatArray:
    """Return where the worst of the cells (k, 4) round a node is best."""
    own = around == node
    corners = points[around]
    place: FloatArray = points[node]
    edge = float(np.linalg.norm(corners[~own] - place, axis=1).mean())
    tries = find_tries(node, place, edge)
    if tries is None:
        return place

    def measure(places: FloatArray) -> FloatArray:
        """Return the worst quality with the node at each of the places (m, 3)."""
        tried = np.where(own[None, :, :, None], places[:, None, None], corners[None])
        return np.asarray(rate_tetrahedra(tried.reshape(-1, 4, 3)).reshape(len(places), -1).min(axis=1))

    step, best = _FIRST_STEP * edge, float(measure(place[None])[0])
    for _ in range(steps):
        places = tries(place, step)
        found = measure(places)
        top = int(np.argmax(found))
        if found[top] > best + _GAIN:
            place, best = places[top], float(found[top])
        else:
            step *= 0.5
    return place
