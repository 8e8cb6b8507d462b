# SPDX-License-Identifier: Apache-2.0
"""Which rank computes which cells, and owns which nodes: recursive coordinate bisection (Berger & Bokhari 1987).

Every rank finds the whole division by itself, from the mesh and the number of ranks alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.model import BoolArray, FloatArray, IndexArray, IntArray, Mesh


@dataclass(frozen=True)
class Division:
    """Cells and nodes of a mesh over ranks."""

    size: int
    """Ranks."""
    rank_of_cell: tuple[IntArray, ...]
    """Rank of each cell, block by block (n_cells,)."""
    owner: IntArray
    """Rank of each node (n_points,): it has a cell there."""

    def cells(self, rank: int) -> list[IndexArray]:
        """Return the cells of a rank in each block."""
        return [np.flatnonzero(of == rank) for of in self.rank_of_cell]


def divide(mesh: Mesh, size: int) -> Division:
    """Divide a mesh over ranks, of which none is left without cells."""
    centres = np.concatenate([mesh.points[block.connectivity].mean(axis=1) for block in mesh.blocks])
    if size > len(centres):
        raise ValueError(f"{size} ranks, but the mesh has only {len(centres)} cells")
    rank = bisect(centres, size)
    ends = np.cumsum([len(block.connectivity) for block in mesh.blocks])[:-1]
    of_blocks = tuple(np.split(rank, ends))
    touches = np.zeros((len(mesh.points), size), dtype=bool)
    for block, of in zip(mesh.blocks, of_blocks, strict=True):
        touches[block.connectivity, of[:, None]] = True
    return Division(size, of_blocks, _choose_owners(touches))


def bisect(centres: FloatArray, size: int) -> IntArray:
    """Return the rank (n,) of cells by their centres (n, d): halved across the longest side, again and again."""
    rank = np.zeros(len(centres), dtype=np.int32)
    parts = [(np.arange(len(centres)), 0, size)]
    while parts:
        cells, first, ranks = parts.pop()
        if ranks == 1:
            rank[cells] = first
            continue
        axis = int(np.argmax(np.ptp(centres[cells], axis=0)))
        ordered = cells[np.argsort(centres[cells, axis], kind="stable")]
        half = ranks // 2
        cut = len(cells) * half // ranks
        parts += [(np.sort(ordered[:cut]), first, half), (np.sort(ordered[cut:]), first + half, ranks - half)]
    return rank


def _choose_owners(touches: BoolArray) -> IntArray:
    """Return one of the ranks that have a cell at each node, in turn, so that none owns all of a border."""
    count = touches.sum(axis=1)
    turn = np.arange(len(touches)) % np.maximum(count, 1)
    reached = np.cumsum(touches, axis=1) > turn[:, None]
    owner: IntArray = np.argmax(reached & touches, axis=1).astype(np.int32)
    return owner
