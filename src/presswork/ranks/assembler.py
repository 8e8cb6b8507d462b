# SPDX-License-Identifier: Apache-2.0
"""An assembler of which each rank fills a part: the matrix of its own cells, and of what acts on its own nodes.

A rank's pattern holds all entries of the rows that it owns, and those of its cells in rows of others. Values of these
go to their owner, who adds them in the order of the ranks: the same bits in every run on as many ranks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.model import BoolArray, FloatArray, IndexArray, IntArray, MaskArray
from presswork.ranks.division import Division
from presswork.ranks.world import World

MakeAssembler = Callable[[list[IntArray], IntArray], Any]
"""Makes an assembler of the core for cells, block by block, and couplings (n, 2)."""


class DividedAssembler:
    """One rank's part of the matrix, called like an assembler of the core."""

    def __init__(
        self,
        make: MakeAssembler,
        connectivity: Sequence[IntArray],
        couplings: IntArray | None,
        division: Division,
        world: World,
        *,
        symmetric: bool,
    ) -> None:
        """connectivity: of all cells, block by block; couplings: further pairs of nodes (n, 2)."""
        self.world, self.division, self.symmetric = world, division, symmetric
        me, owner = world.rank, division.owner
        own = [cells[own] for cells, own in zip(connectivity, division.cells(me), strict=True)]
        beside = _find_pairs(connectivity, owner == me)
        if couplings is not None and len(couplings):
            beside = np.concatenate([beside, couplings[(owner[couplings] == me).any(axis=1)].astype(np.int32)])
        self._core = make(own, np.ascontiguousarray(beside, dtype=np.int32))
        self.indptr: IntArray = self._core.indptr
        self.indices: IntArray = self._core.indices
        self.freedoms = (len(self.indptr) - 1) // len(owner)
        self._is_own = np.repeat(owner == me, self.freedoms)
        rows = np.repeat(np.arange(len(self.indptr) - 1, dtype=np.int64), np.diff(self.indptr))
        self._plan_nodes(connectivity, couplings)
        self._plan_entries(rows, own)
        on_diagonal = np.flatnonzero(rows == self.indices)
        self._others_diagonal = on_diagonal[~self._is_own[rows[on_diagonal]]]

    @property
    def own_nodes(self) -> IndexArray:
        """The nodes that this rank owns."""
        return np.flatnonzero(self.division.owner == self.world.rank)

    # --- what an assembler of the core does -----------------------------------------------------------------------

    def assemble_matrix(
        self, stiffness: list[FloatArray], turned: MaskArray, frames: FloatArray, data: FloatArray
    ) -> None:
        """Fill data with the stiffness of this rank's cells."""
        self._core.assemble_matrix(stiffness, turned, frames, data)

    def assemble_vector(self, force: list[FloatArray]) -> FloatArray:
        """Return the nodal forces (n_points, D) of the cells of all ranks."""
        return self.gather(self.sum_at_owners(self._core.assemble_vector(force)))

    def add_blocks(
        self, pairs: IntArray, blocks: FloatArray, turned: MaskArray, frames: FloatArray, data: FloatArray
    ) -> None:
        """Add those blocks (n, D, D) whose first node in the mesh's order is this rank's."""
        mine = self.division.owner[pairs.min(axis=1)] == self.world.rank
        own_pairs, own_blocks = np.ascontiguousarray(pairs[mine]), np.ascontiguousarray(blocks[mine])
        self._core.add_blocks(own_pairs, own_blocks, turned, frames, data)

    def constrain(self, mask: MaskArray, value: FloatArray, scale: float, data: FloatArray, rhs: FloatArray) -> None:
        """Prescribe freedoms; of the right-hand side, the same on all ranks, the rows of this rank come out right."""
        change = np.zeros_like(rhs)
        self._core.constrain(mask, value, scale, data, change)
        change[(mask == 1) & ~self._is_own] = 0.0
        data[self._others_diagonal[mask[self.indices[self._others_diagonal]] == 1]] = 0.0
        rhs += self.sum_at_owners(change.reshape(-1, self.freedoms)).reshape(-1)

    # --- between ranks --------------------------------------------------------------------------------------------

    def sum_at_owners(self, vector: FloatArray) -> FloatArray:
        """Return the sum over ranks of a nodal vector (n_points, D), right at the nodes that this rank owns."""
        total = vector.copy()
        incoming = {rank: np.empty((len(nodes), vector.shape[1])) for rank, nodes in self._nodes_from.items()}
        outgoing = {rank: np.ascontiguousarray(vector[nodes]) for rank, nodes in self._nodes_to.items()}
        self.world.exchange(outgoing, incoming)
        for rank, nodes in self._nodes_from.items():
            total[nodes] += incoming[rank]
        return total

    def gather(self, vector: FloatArray) -> FloatArray:
        """Return on every rank a nodal vector (n_points, D) that each rank has at its own nodes."""
        owner = self.division.owner
        counts = np.bincount(owner, minlength=self.division.size) * vector.shape[1]
        whole = np.empty_like(vector)
        whole[np.argsort(owner, kind="stable")] = self.world.gather(
            vector[owner == self.world.rank].reshape(-1), counts
        ).reshape(-1, vector.shape[1])
        return whole

    def sum_entries(self, data: FloatArray) -> FloatArray:
        """Return the values of the matrix summed over ranks, right in the rows that this rank owns."""
        total = data.copy()
        incoming = {rank: np.empty(len(at)) for rank, at in self._entries_from.items()}
        self.world.exchange({rank: data[at] for rank, at in self._entries_to.items()}, incoming)
        for rank, at in self._entries_from.items():
            total[at] += incoming[rank]
        return total

    # --- plans ----------------------------------------------------------------------------------------------------

    def _plan_nodes(self, connectivity: Sequence[IntArray], couplings: IntArray | None) -> None:
        """Find the nodes whose forces go to and come from each rank; every rank finds the same by itself."""
        me, owner = self.world.rank, self.division.owner
        self._nodes_to: dict[int, IndexArray] = {}
        self._nodes_from: dict[int, IndexArray] = {}
        own = self._find_held(me, connectivity, couplings)
        for rank in range(self.division.size):
            if rank == me:
                continue
            to = np.flatnonzero(own & (owner == rank))
            of = np.flatnonzero(self._find_held(rank, connectivity, couplings) & (owner == me))
            self._nodes_to |= {rank: to} if len(to) else {}
            self._nodes_from |= {rank: of} if len(of) else {}

    def _find_held(self, rank: int, connectivity: Sequence[IntArray], couplings: IntArray | None) -> BoolArray:
        """Return for each node whether a rank's pattern has entries of it."""
        owned: BoolArray = self.division.owner == rank
        held: BoolArray = owned.copy()
        for cells, of in zip(connectivity, self.division.rank_of_cell, strict=True):
            held[cells[(of == rank) | owned[cells].any(axis=1)]] = True
        if couplings is not None and len(couplings):
            held[couplings[owned[couplings].any(axis=1)]] = True
        return held

    def _plan_entries(self, rows: NDArray[np.int64], own: list[IntArray]) -> None:
        """Find the entries of the matrix whose values go to and come from each rank."""
        me, owner, d = self.world.rank, self.division.owner, self.freedoms
        n = len(self.indptr) - 1
        row, column = rows // d, self.indices.astype(np.int64) // d
        first, last = np.minimum(row, column), np.maximum(row, column)
        is_filled = (owner[first] == me) | np.isin(first * n + last, _key_pairs(own, n))
        of_row, of_column = owner[row], owner[column] if self.symmetric else owner[row]
        self._entries_to: dict[int, IndexArray] = {}
        keys: dict[int, NDArray[np.int64]] = {}
        for rank in range(self.division.size):
            at = np.flatnonzero(is_filled & ((of_row == rank) | (of_column == rank)))
            if rank != me and len(at):
                self._entries_to[rank] = at
                keys[rank] = rows[at] * n + self.indices[at]
        here = rows * n + self.indices
        self._entries_from: dict[int, IndexArray] = {}
        for rank, wanted in self.world.swap(keys).items():
            at = np.searchsorted(here, wanted)
            assert np.array_equal(here[at], wanted), "an owner's pattern holds all entries of its rows"
            self._entries_from[rank] = at


def _find_pairs(connectivity: Sequence[IntArray], owned: BoolArray) -> IntArray:
    """Return all pairs of nodes (n, 2) in a common cell of which one is owned."""
    found = [np.zeros((0, 2), dtype=np.int32)]
    for cells in connectivity:
        beside = cells[owned[cells].any(axis=1)]
        first, second = np.triu_indices(cells.shape[1])
        pairs = np.stack([beside[:, first].reshape(-1), beside[:, second].reshape(-1)], axis=1)
        found.append(np.unique(pairs[owned[pairs].any(axis=1)], axis=0))
    return np.concatenate(found)


def _key_pairs(connectivity: Sequence[IntArray], n: int) -> NDArray[np.int64]:
    """Return a number for each pair of nodes in a common cell: the smaller times n, plus the larger."""
    found: list[NDArray[np.int64]] = [np.zeros(0, dtype=np.int64)]
    for cells in connectivity:
        first, second = (cells[:, i].astype(np.int64) for i in np.triu_indices(cells.shape[1]))
        found.append(np.unique(np.minimum(first, second) * n + np.maximum(first, second)))
    return np.unique(np.concatenate(found))
