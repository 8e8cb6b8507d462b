# SPDX-License-Identifier: Apache-2.0
"""Where cells of unlike zones of a welded blank meet."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from presswork.mesh.topology import edge_keys, list_cell_edges
from presswork.model import FloatArray, IntArray


def find_weld_edges(kinds: Sequence[IntArray], zones: Sequence[int], zone: int) -> IntArray:
    """Return the edges between cells of a zone and of others (n, 2), the zone on their left.

    kinds: nodes of the cells of each block (n_cells, 3 | 4), counter-clockwise; zones: of each block.
    """
    own = [list_cell_edges(cells) for cells, number in zip(kinds, zones, strict=True) if number == zone]
    rest = [list_cell_edges(cells) for cells, number in zip(kinds, zones, strict=True) if number != zone]
    if not own or not rest:
        return np.zeros((0, 2), dtype=np.int32)
    edges = np.concatenate(own)
    return np.asarray(edges[np.isin(edge_keys(edges), edge_keys(np.concatenate(rest)))])


def find_weld_normals(points: FloatArray, edges: IntArray) -> tuple[IntArray, FloatArray]:
    """Return the nodes of a weld line, and the unit normal in the plan at each, into the zone on the left (n, 2).

    points (n_points, 2 | 3); edges: as of find_weld_edges.
    """
    nodes, place = np.unique(edges, return_inverse=True)
    along = points[edges[:, 1], :2] - points[edges[:, 0], :2]
    normal = np.zeros((len(nodes), 2))
    for end in place.reshape(edges.shape).T:
        np.add.at(normal, end, np.column_stack([-along[:, 1], along[:, 0]]))
    size = np.linalg.norm(normal, axis=1, keepdims=True)
    return nodes, np.divide(normal, size, out=np.zeros_like(normal), where=size > 0)
