# SPDX-License-Identifier: Apache-2.0
"""Shells split in four where a size is exceeded: neighbours one level apart at most, hanging nodes on the sides
between.

Triangles have their last node twice. The middle of a side is one node, however many shells have the side; where one
shell has the whole side and two others its halves, that node hangs: cpp/explicit/space/hanging.hpp describes how it
moves.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from presswork.mesh.topology import edge_keys, with_four_nodes
from presswork.model import BoolArray, FloatArray, IntArray, Mesh

_QUAD = ((0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3))
_TRIANGLE = ((0, 4, 7, 7), (4, 1, 5, 5), (7, 5, 2, 2), (4, 5, 7, 7))
"""Children by corner (0 to 3), middle of side (4 to 7: 01, 12, 23, 30) and centre (8)."""


@dataclass(frozen=True)
class SplitMesh:
    """A mesh with the levels of its shells, and the middles of sides that have been split."""

    cells: IntArray
    """Nodes in turn (n, 4)."""
    level: IntArray
    """Number of times that each shell has been split (n,)."""
    n_nodes: int
    side: NDArray[np.int64]
    """Keys of sides with a middle, sorted (m,)."""
    middle: IntArray
    """Node in the middle of each (m,)."""

    @classmethod
    def begin(cls, cells: IntArray, n_nodes: int) -> SplitMesh:
        """Return the mesh before any shell is split; triangles (n, 3) get their last node twice."""
        none = np.zeros(0, dtype=np.int32)
        four = with_four_nodes(cells).astype(np.int32)
        return cls(four, np.zeros(len(cells), np.int32), n_nodes, none.astype(np.int64), none)

    def middles(self, cells: IntArray) -> IntArray:
        """Return the nodes in the middle of the sides 01, 12, 23, 30 of cells (n, 4); -1 where there is none."""
        return self._middle_of(np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1))

    def _middle_of(self, sides: IntArray) -> IntArray:
        """Return the nodes in the middle of sides (..., 2), -1 where there is none."""
        keys = edge_keys(sides.reshape(-1, 2))
        at = np.minimum(np.searchsorted(self.side, keys), max(len(self.side) - 1, 0))
        found = self.side[at] == keys if len(self.side) else np.zeros(len(keys), dtype=bool)
        return np.where(found, self.middle[at] if len(self.side) else -1, -1).reshape(sides.shape[:-1]).astype(np.int32)

    def hanging(self) -> IntArray:
        """Return the hanging nodes (n, 7) as the explicit loop wants them.

        Columns: the node; the ends of its side; the two far nodes of the shell that has the whole side; a far node of
        each of the shells that have its halves.
        """
        middle = self.middles(self.cells)
        cell, k = np.nonzero(middle >= 0)
        whole = self.cells[cell]
        row, corner = np.arange(len(cell)), (k + np.arange(4)[:, None]) % 4
        first, last, far, near = (whole[row, corner[i]] for i in range(4))  # a triangle's far nodes may be an end
        node = middle[cell, k]
        keys = edge_keys(np.stack([self.cells, np.roll(self.cells, -1, axis=1)], axis=-1).reshape(-1, 2))
        order = np.argsort(keys, kind="stable")
        beyond = []
        for end, to in ((last, 2), (first, 3)):  # one shell has each half
            at = order[np.searchsorted(keys[order], edge_keys(np.stack([node, end], axis=1)))]
            beyond.append(self.cells[at // 4, (at % 4 + to) % 4])
        return np.stack([node, first, last, far, near, *beyond], axis=1).astype(np.int32)

    def split(self, chosen: BoolArray) -> SplitStep:
        """Split the chosen shells (n,), and others as far as neighbours would be more than a level apart."""
        step = self._split(chosen)
        while len(more := step.mesh.unbalanced()):
            chosen = chosen.copy()
            chosen[step.parent[more]] = True
            step = self._split(chosen)
        return step

    def unbalanced(self) -> IntArray:
        """Return the shells with a side of which a half is split again, or an end hangs."""
        whole = self.middles(self.cells)
        ends = np.stack([self.cells, np.roll(self.cells, -1, axis=1)], axis=-1)
        halves = [self._middle_of(np.stack([ends[..., i], whole], axis=-1)) for i in (0, 1)]
        too_fine = (whole >= 0) & ((halves[0] >= 0) | (halves[1] >= 0))
        # a hanging end: the shell that has that end's side whole is the one to split
        hangs = np.zeros(self.n_nodes, dtype=bool)
        hangs[whole[whole >= 0]] = True
        is_end = np.zeros(self.n_nodes, dtype=bool)
        is_end[ends[whole >= 0]] = True
        chained = (whole >= 0) & (hangs & is_end)[whole]
        return np.flatnonzero((too_fine | chained).any(axis=1)).astype(np.int32)

    def _split(self, chosen: BoolArray) -> SplitStep:
        cells, n = self.cells[chosen], self.n_nodes
        triangle = cells[:, 2] == cells[:, 3]
        # 1. nodes in the middle of sides that have none yet
        sides = np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1)
        real = sides[..., 0] != sides[..., 1]
        new = sides[(self.middles(cells) < 0) & real]
        keys, first = np.unique(edge_keys(new), return_index=True)
        ends = new[first]
        number = n + np.arange(len(keys), dtype=np.int32)
        order = np.argsort(np.concatenate([self.side, keys]), kind="stable")
        with_middles = replace(
            self,
            side=np.concatenate([self.side, keys])[order],
            middle=np.concatenate([self.middle, number])[order],
            n_nodes=n + len(keys),
        )
        # 2. and in the middle of quadrilaterals
        centre = np.full(len(cells), -1, dtype=np.int32)
        centre[~triangle] = with_middles.n_nodes + np.arange(int((~triangle).sum()))
        made_of = np.concatenate([ends[:, [0, 1, 0, 1]], cells[~triangle]])
        # 3. children in the place of their parents
        parent = np.repeat(np.arange(len(self.cells)), np.where(chosen, 4, 1))
        children, level = self.cells[parent], self.level[parent]
        corners = np.column_stack([cells, with_middles.middles(cells), centre])
        own = corners[:, _QUAD]
        own[triangle] = corners[triangle][:, _TRIANGLE]
        children[chosen[parent]] = own.reshape(-1, 4)
        level[chosen[parent]] += 1
        mesh = replace(with_middles, cells=children, level=level, n_nodes=n + len(made_of))
        return SplitStep(mesh, chosen, parent.astype(np.int32), made_of.astype(np.int32))


@dataclass(frozen=True)
class SplitStep:
    """A mesh that comes from another by splitting shells. Nodes keep their numbers, new ones follow."""

    mesh: SplitMesh
    chosen: BoolArray
    """Shells of the other mesh that were split."""
    parent: IntArray
    """Shell of the other mesh that each comes from, or is (n,)."""
    made_of: IntArray
    """Nodes of the other mesh in whose middle each new node lies (n_new, 4): the ends of a side, twice, or corners."""

    def node_parents(self) -> IntArray:
        """Return the nodes of the other mesh that each is, four times, or lies in the middle of (n_nodes, 4)."""
        old = np.arange(self.mesh.n_nodes - len(self.made_of), dtype=np.int32)
        return np.concatenate([np.repeat(old[:, None], 4, axis=1), self.made_of])

    def interpolate(self, values: FloatArray) -> FloatArray:
        """Return values at the nodes (n_nodes before, ...) with those at the new ones."""
        return np.concatenate([values, values[self.made_of].mean(axis=1)])

    def apply(self, mesh: Mesh) -> Mesh:
        """Return a mesh of whose blocks' cells, one after the other, this is a split: points, sets and boundary too.

        New nodes join the sets that all their nodes belong to; sets of nodes of the boundary grow along it only.
        """
        blocks, first = [], 0
        for block in mesh.blocks:
            n, corners = block.connectivity.shape
            own = (self.parent >= first) & (self.parent < first + n)
            blocks.append(block.take(self.parent[own] - first, self.mesh.cells[own, :corners]))
            first += n
        boundary = mesh.boundary_edges
        on_boundary = np.isin(edge_keys(self.made_of[:, :2]), edge_keys(boundary))
        on_boundary &= (self.made_of[:, :2] == self.made_of[:, 2:]).all(axis=1)
        new = np.arange(len(mesh.points), self.mesh.n_nodes, dtype=np.int32)
        node_sets = {}
        for name, nodes in mesh.node_sets.items():
            inside = np.isin(self.made_of, nodes).all(axis=1)
            on_rim = np.isin(nodes, boundary).all() and len(nodes) < len(mesh.points)
            if on_rim or name in mesh.edge_sets:
                inside &= on_boundary
            node_sets[name] = np.concatenate([nodes, new[inside]]).astype(np.int32)
        edge_sets = {name: self._split_edges(edges) for name, edges in mesh.edge_sets.items()}
        return replace(
            mesh,
            points=self.interpolate(mesh.points),
            blocks=tuple(blocks),
            node_sets=node_sets,
            edge_sets=edge_sets,
            boundary_edges=self._split_edges(mesh.boundary_edges),
        )

    def _split_edges(self, edges: IntArray) -> IntArray:
        """Return edges (n, 2) with both halves of those that have a middle."""
        middle = self.mesh._middle_of(edges)
        whole = np.stack([edges, edges], axis=1)
        whole[:, 0, 1] = whole[:, 1, 0] = middle
        whole[middle < 0, 0] = edges[middle < 0]
        kept = np.stack([np.ones(len(edges), dtype=bool), middle >= 0], axis=1)
        return np.asarray(whole[kept], dtype=np.int32)
