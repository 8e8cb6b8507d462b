# SPDX-License-Identifier: Apache-2.0
"""Edges, sets and connected parts of a mesh, from the cells' connectivity alone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy
from numpy.typing import NDArray

from presswork.model import BoolArray, FloatArray, IntArray, find_cell


def list_cell_edges(connectivity: IntArray) -> IntArray:
    """Return the edges of every plane cell (n_cells * n_corners, 2 | 3): first, last[, mid]; the cell on the left."""
    edges = find_cell(2, connectivity).edges
    return connectivity[:, edges].reshape(-1, edges.shape[1])


def halve_edges(edges: IntArray) -> IntArray:
    """Return edges with a node in their middle (n, 3) as two each, in their order; others as they are."""
    return np.ascontiguousarray(edges[:, find_cell(1, edges).pieces].reshape(-1, 2))


def edge_keys(edges: IntArray) -> NDArray[np.int64]:
    """Return one 64-bit number per edge that does not depend on its direction, shape (n_edges,)."""
    ends = np.sort(edges[:, :2].astype(np.int64), axis=1)
    return np.asarray((ends[:, 0] << 32) | ends[:, 1], dtype=np.int64)


def find_boundary_edges(connectivities: Sequence[IntArray]) -> IntArray:
    """Return the edges that one cell only has, the body on the left, in the order of the cells."""
    edges = np.concatenate([list_cell_edges(connectivity) for connectivity in connectivities])
    _, index, count = np.unique(edge_keys(edges), return_index=True, return_counts=True)
    boundary: IntArray = edges[np.sort(index[count == 1])].astype(np.int32)
    return boundary


def count_cells_of_edges(connectivities: Sequence[IntArray]) -> tuple[IntArray, IntArray]:
    """Return each edge of the mesh once, and the number of cells that share it."""
    edges = np.concatenate([list_cell_edges(connectivity) for connectivity in connectivities])
    _, index, count = np.unique(edge_keys(edges), return_index=True, return_counts=True)
    return edges[index], count.astype(np.int32)


def chain_edges(edges: IntArray, points: FloatArray) -> IntArray:
    """Return directed boundary edges in the order in which they follow each other, loop after loop.

    A closed loop starts at the node farthest from its middle, an open chain at its beginning.
    """
    last: list[int] = edges[:, 1].tolist()
    leaving: dict[int, list[int]] = {}
    for number, first in enumerate(edges[:, 0].tolist()):
        leaving.setdefault(first, []).append(number)
    starts = np.setdiff1d(edges[:, 0], edges[:, 1]).tolist()
    order: list[int] = []
    for start in [*starts, *edges[:, 0].tolist()]:
        chain: list[int] = []
        node = start
        while leaving.get(node):
            chain.append(leaving[node].pop(0))
            node = last[chain[-1]]
        if chain and node == start:
            loop = points[edges[chain, 0]]
            farthest = int(np.argmax(((loop - loop.mean(axis=0)) ** 2).sum(axis=1)))
            chain = chain[farthest:] + chain[:farthest]
        order += chain
    return edges[order]


def select_edges(edges: IntArray, nodes: IntArray) -> IntArray:
    """Return the edges all of whose nodes are among the nodes given."""
    return edges[np.isin(edges, nodes).all(axis=1)]


def find_parts(connectivities: Sequence[IntArray], n_points: int) -> tuple[int, IntArray]:
    """Return the number of parts of the mesh that share no node, and the part of each node, shape (n_points,)."""
    rows = [np.repeat(cells[:, 0], cells.shape[1] - 1) for cells in connectivities]
    columns = [cells[:, 1:].ravel() for cells in connectivities]
    row, column = np.concatenate(rows), np.concatenate(columns)
    graph = scipy.sparse.coo_array((np.ones(len(row), dtype=np.int8), (row, column)), shape=(n_points, n_points))
    n_parts, part = scipy.sparse.csgraph.connected_components(graph, directed=False)
    return int(n_parts), part.astype(np.int32)


def drop_unused_points(points: FloatArray, connectivities: Sequence[IntArray]) -> tuple[FloatArray, IntArray]:
    """Return the points that cells use, and the new number of each old point: -1 for a dropped one."""
    used = np.zeros(len(points), dtype=bool)
    for connectivity in connectivities:
        used[connectivity] = True
    number = np.where(used, np.cumsum(used) - 1, -1).astype(np.int32)
    return points[used], number


def with_four_nodes(cells: IntArray) -> IntArray:
    """Return connectivity (n, 4); triangles (n, 3) repeat their last node."""
    return cells[:, [0, 1, 2, 2]] if cells.ndim == 2 and cells.shape[1] == 3 else cells


def is_triangle(cells: IntArray) -> BoolArray:
    """Return which shells of connectivity (n, 4) repeat their last node."""
    return np.asarray(cells[:, 2] == cells[:, 3])
