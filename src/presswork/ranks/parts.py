# SPDX-License-Identifier: Apache-2.0
"""The parts of an explicit loop's mesh: each rank owns nodes, and has all elements that touch them.

The other nodes of these elements are its ghosts. Every rank finds the whole division by itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from presswork.model import FloatArray, IndexArray, IntArray
from presswork.ranks.division import bisect


@dataclass(frozen=True)
class Part:
    """What a rank has; nodes and elements are numbered as in the whole loop unless said otherwise."""

    owner: IntArray
    """Rank of each node of the whole loop (n_nodes,)."""
    element_owner: tuple[IntArray, ...]
    """Rank that answers for each element of each block, which others may compute, too (n,)."""
    nodes: IndexArray
    """Own nodes and ghosts, rising: the nodes of the rank's own loop."""
    elements: tuple[IndexArray, ...]
    """Of each block, rising."""
    sent: dict[int, IndexArray]
    """Own nodes that are ghosts elsewhere, by rank, as the rank's own loop numbers them."""
    ghosts: dict[int, IndexArray]
    """Nodes that other ranks own, by rank, as the rank's own loop numbers them."""


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


def make_part(points: FloatArray, blocks: Sequence[IntArray], size: int, rank: int) -> Part:
    """Return what a rank has of a mesh divided over ranks."""
    owner = own_nodes(points, blocks, size)
    elements = tuple(np.flatnonzero((owner[block] == rank).any(axis=1)) for block in blocks)
    has = owner == rank
    for block, own in zip(blocks, elements, strict=True):
        has[block[own]] = True
    nodes = np.flatnonzero(has)
    place = np.full(len(points), -1, dtype=np.intp)
    place[nodes] = np.arange(len(nodes))
    sent, ghosts = _find_messages(owner, [block[own] for block, own in zip(blocks, elements, strict=True)], rank)
    return Part(
        owner,
        tuple(owner[block[:, 0]] for block in blocks),
        nodes,
        elements,
        {to: place[numbers] for to, numbers in sent.items()},
        {of: place[numbers] for of, numbers in ghosts.items()},
    )


def _find_messages(
    owner: IntArray, blocks: Sequence[IntArray], rank: int
) -> tuple[dict[int, IndexArray], dict[int, IndexArray]]:
    """Return the nodes that go to and come from each rank, rising; blocks: elements that touch own nodes."""
    out: list[IntArray] = [np.zeros((0, 2), dtype=np.int64)]
    back: list[IntArray] = [np.zeros((0, 2), dtype=np.int64)]
    for block in blocks:
        border = block[(owner[block] != rank).any(axis=1)]
        k = block.shape[1]
        first, second = (border[:, i].ravel() for i in np.divmod(np.arange(k * k), k))
        goes = (owner[first] == rank) & (owner[second] != rank)
        out.append(np.unique(np.column_stack([owner[second[goes]], first[goes]]), axis=0))
        back.append(np.unique(np.column_stack([owner[second[goes]], second[goes]]), axis=0))
    return _by_rank(np.unique(np.concatenate(out), axis=0)), _by_rank(np.unique(np.concatenate(back), axis=0))


def _by_rank(rows: IntArray) -> dict[int, IndexArray]:
    """Return the second of each row by the first."""
    return {int(rank): rows[rows[:, 0] == rank, 1].astype(np.intp) for rank in np.unique(rows[:, 0])}
