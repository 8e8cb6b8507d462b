# SPDX-License-Identifier: Apache-2.0
"""The parts of an explicit loop's mesh: each rank owns nodes, and has all elements that touch them.

The other nodes of these elements are its ghosts. Every rank finds the whole division by itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph

from presswork.model import FloatArray, IndexArray, IntArray
from presswork.ranks.division import bisect


@dataclass(frozen=True)
class Part:
    """What a rank has; nodes and elements are numbered as in the whole loop unless stated otherwise."""

    owner: IntArray
    """Rank of each node of the whole loop (n_nodes,)."""
    element_owner: tuple[IntArray, ...]
    """Rank that answers for each element of each block, which others may compute, too (n,)."""
    nodes: IndexArray
    """Own nodes and ghosts, rising: the nodes of the rank's own loop."""
    elements: tuple[IndexArray, ...]
    """Elements of each block, rising."""
    around: tuple[IndexArray | None, ...]
    """Elements round all nodes of these, where a block depends on them."""
    sent: dict[int, IndexArray]
    """Own nodes that are ghosts elsewhere, by rank, as the rank's own loop numbers them."""
    ghosts: dict[int, IndexArray]
    """Nodes that other ranks own, by rank, as the rank's own loop numbers them."""

    def list_elements(self) -> IntArray:
        """Return the numbers in the whole loop, in which blocks follow each other, of this rank's elements."""
        before = np.cumsum([0, *(len(of) for of in self.element_owner)])
        return np.concatenate([kept + n for kept, n in zip(self.elements, before[:-1], strict=True)]).astype(np.int32)

    def number(self, nodes: IntArray) -> IntArray:
        """Return the numbers of nodes in the rank's own loop, which has them all."""
        return np.searchsorted(self.nodes, nodes).astype(np.int32)


def own_nodes(points: FloatArray, blocks: Sequence[IntArray], size: int) -> IntArray:
    """Return the rank of each node (n_nodes,): bisected by coordinates; nodes without elements are of rank 0.

    points (n_nodes, d); blocks: nodes of elements (n, k) each.
    """
    used = np.unique(np.concatenate([block.ravel() for block in blocks]))
    if size > len(used):
        raise ValueError(f"{size} ranks, but the mesh has only {len(used)} nodes")
    owner = np.zeros(len(points), dtype=np.int32)
    owner[used] = bisect(points[used], size)
    return owner


def make_part(
    points: FloatArray,
    blocks: Sequence[IntArray],
    size: int,
    rank: int,
    measures_nodes: Sequence[bool],
    *,
    following: tuple[IntArray, int] | None = None,
    known: IntArray | None = None,
) -> Part:
    """Return what a rank has of a mesh divided over ranks.

    measures_nodes: of each block, whether its cells depend on all cells round their nodes. following: rows (n, k) of a
    node that follows others and those that it needs for it, and to how many of these, the first, it gives its forces:
    with them it has one owner, and a part that has it has all that it needs. known: nodes whose motion all ranks know.
    """
    owner, n = own_nodes(points, blocks, size), len(points)
    rows, leaders = following or (np.zeros((0, 1), dtype=np.int32), 0)
    needs = _link(rows, n)
    chain = csgraph.connected_components(_link(rows[:, : 1 + leaders], n), directed=False)[1]
    owner = owner[np.unique(chain, return_index=True)[1]][chain]
    has = sparse.csr_matrix((np.ones(n, dtype=bool), (np.arange(n), owner)), shape=(n, size))
    touches = [_touch(block, n) for block in blocks]
    computes = [(touch @ has).astype(bool) for touch in touches]
    has_first = sum((touch.T @ of for touch, of in zip(touches, computes, strict=True)), start=has)
    has_first = _close(has_first, needs)
    has = has_first
    around = []
    for touch, measures in zip(touches, measures_nodes, strict=True):
        of = (touch @ has_first).astype(bool)
        around.append(of.getcol(rank).nonzero()[0] if measures else None)
        has = has + touch.T @ of if measures else has
    if known is not None:
        has = has + sparse.csr_matrix(
            (np.ones(len(known) * size, dtype=bool), (known.repeat(size), np.tile(np.arange(size), len(known)))),
            shape=(n, size),
        )
    has = _close(has, needs)
    nodes = np.flatnonzero(has.getcol(rank).toarray().ravel())
    place = np.full(n, -1, dtype=np.intp)
    place[nodes] = np.arange(len(nodes))
    node, by = has.astype(bool).nonzero()
    goes, comes = (owner[node] == rank) & (by != rank), (owner[node] != rank) & (by == rank)
    return Part(
        owner,
        tuple(owner[block[:, 0]] for block in blocks),
        nodes,
        tuple(of.getcol(rank).nonzero()[0] for of in computes),
        tuple(around),
        _by_rank(by[goes], place[node[goes]]),
        _by_rank(owner[node[comes]], place[node[comes]]),
    )


def _touch(block: IntArray, n: int) -> sparse.csr_matrix:
    """Return which elements (rows) have which nodes."""
    rows = np.repeat(np.arange(len(block)), block.shape[1])
    return sparse.csr_matrix((np.ones(block.size, dtype=bool), (rows, block.ravel())), shape=(len(block), n))


def _link(rows: IntArray, n: int) -> sparse.csr_matrix:
    """Return which nodes (rows) are named behind which (columns)."""
    named, by = rows[:, 1:].ravel(), rows[:, 0].repeat(rows.shape[1] - 1)
    return sparse.csr_matrix((np.ones(len(named), dtype=bool), (named, by)), shape=(n, n))


def _close(has: sparse.csr_matrix, needs: sparse.csr_matrix) -> sparse.csr_matrix:
    """Return which nodes ranks have, with all that these need, and all that those need."""
    more = (has + needs @ has).astype(bool)
    return more if more.nnz == has.astype(bool).nnz else _close(more, needs)


def _by_rank(rank: IntArray, node: IndexArray) -> dict[int, IndexArray]:
    """Return the nodes by rank, both rising."""
    return {int(each): np.sort(node[rank == each]) for each in np.unique(rank)}
