# SPDX-License-Identifier: Apache-2.0
"""Where the inner nodes of a new mesh come to lie once its skin has moved to its place."""

from __future__ import annotations

import numpy as np

from presswork.model import BoolArray, FloatArray, IndexArray
from presswork.remesh.space.bad_cells import move_nodes_of_bad_cells
from presswork.remesh.space.tetrahedra import list_edges

_SWEEPS = 40
"""Number of sweeps in which moves of the skin spread into the body."""
_ROUNDS, _STEPS = 6, 10
"""Number of rounds in which nodes of bad cells are visited, and of steps of the search for a better place of each."""
_DIRECTIONS = np.array([d for d in np.ndindex(3, 3, 3) if d != (1, 1, 1)], dtype=float) - 1.0
_DIRECTIONS /= np.linalg.norm(_DIRECTIONS, axis=1)[:, None]


def spread_moves(points: FloatArray, cells: IndexArray, skin: IndexArray, placed: FloatArray) -> FloatArray:
    """Return all nodes (n, 3), those of the skin as placed, others moved with the nodes round them.

    An inner node takes the mean of its neighbours' moves, weighted by the inverse square of their distance.
    """
    edges = list_edges(cells)
    weight = 1.0 / np.maximum(((points[edges[:, 1]] - points[edges[:, 0]]) ** 2).sum(axis=1), 1e-300)
    total = np.bincount(edges.ravel(), np.repeat(weight, 2), len(points))
    moves: FloatArray = np.zeros_like(points)
    moves[skin] = placed[skin] - points[skin]
    inner: BoolArray = np.ones(len(points), dtype=bool)
    inner[skin] = False
    for _ in range(_SWEEPS):
        for axis in range(3):
            own = moves[:, axis]
            given = np.bincount(edges[:, 0], weight * own[edges[:, 1]], len(points))
            given += np.bincount(edges[:, 1], weight * own[edges[:, 0]], len(points))
            moves[inner, axis] = given[inner] / total[inner]
    result = points + moves
    result[skin] = placed[skin]
    return result


def improve_cells(points: FloatArray, cells: IndexArray, skin: IndexArray, wanted: float) -> FloatArray:
    """Return nodes (n, 3) of which inner ones have moved to where the worst cell round them is best.

    Only nodes of cells whose quality is below the wanted one move: a tool that cuts off the skin above an inner node
    leaves it outside the body, and moves that spread evenly do not bring it back.
    """
    points = points.copy()
    inner: BoolArray = np.ones(len(points), dtype=bool)
    inner[skin] = False
    for _ in range(_ROUNDS):
        if not move_nodes_of_bad_cells(points, cells, inner, wanted, _STEPS, lambda *_: _try_around):
            break
    return points


def _try_around(place: FloatArray, step: float) -> FloatArray:
    """Return the places a step away along 26 directions (26, 3)."""
    return place + step * _DIRECTIONS
