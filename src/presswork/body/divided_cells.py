# SPDX-License-Identifier: Apache-2.0
"""Cells divided over ranks: which are this rank's, and how all ranks get to know of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from presswork.body.contract import Look, Near
from presswork.model import FloatArray, IntArray, Mesh
from presswork.ranks.assembler import DividedAssembler, MakeAssembler
from presswork.ranks.division import divide
from presswork.ranks.world import World


class DividedCells:
    """The cells of a mesh on the ranks of a run, for the bodies that evaluate them."""

    def __init__(self, mesh: Mesh, world: World) -> None:
        self.world = world
        self.division = divide(mesh, world.size)
        self.own = self.division.cells(world.rank)
        """This rank's cells in each block."""

    def choose(self, connectivity: Sequence[IntArray]) -> list[IntArray]:
        """Return the rows of this rank's cells, block by block."""
        return [np.ascontiguousarray(cells[own]) for cells, own in zip(connectivity, self.own, strict=True)]

    def take(self, array: FloatArray, block: int) -> FloatArray:
        """Return a copy of the rows of own cells; None where the material has no such array."""
        return array[self.own[block]] if len(array) else array

    def make_assembler(
        self, make: MakeAssembler, connectivity: Sequence[IntArray], couplings: IntArray | None, *, symmetric: bool
    ) -> DividedAssembler:
        """Return the assembler of this rank's cells. connectivity: of all cells; couplings: pairs of nodes (n, 2)."""
        return DividedAssembler(make, connectivity, couplings, self.division, self.world, symmetric=symmetric)

    def agree_on(self, bad: Any) -> Any:
        """Return the fault of a cell, as ShellFailed, of the lowest rank that has one; None if no rank has one."""
        if not self.world.largest(int(bad is not None)):
            return None
        if bad is not None:
            bad = replace(bad, cell=int(self.own[bad.block][bad.cell]))
        return next(found for found in self.world.gather_objects(bad) if found is not None)

    def look_near(self, looks: Sequence[Look], places: FloatArray) -> list[Near]:
        """Return what looks find of all nodes: each rank looks from its own nodes and sends those that are near."""
        if self.world.leads:
            return [nearest(places, reach) for nearest, reach in looks]
        own, rows = np.flatnonzero(self.division.owner == self.world.rank), [np.zeros((0, 6))]
        for look, (nearest, reach) in enumerate(looks):
            gap, normal = nearest(places[own], reach)
            near = np.isfinite(gap)
            rows.append(np.column_stack([np.full(near.sum(), look), own[near], gap[near], normal[near]]))
        found = self.world.gather_rows(np.concatenate(rows))
        of, node = found[:, 0].astype(np.intp), found[:, 1].astype(np.intp)
        seen = np.full((len(looks), len(places)), np.inf), np.zeros((len(looks), len(places), 3))
        seen[0][of, node], seen[1][of, node] = found[:, 2], found[:, 3:]
        return list(zip(*seen, strict=True))

    def share(self, block: int, arrays: Sequence[FloatArray]) -> None:
        """Fill arrays of a block's cells (n_cells, ...), of which each rank has the rows of its own, on all ranks."""
        own, of = self.own[block], self.division.rank_of_cell[block]
        widths = [array[0].size for array in arrays]
        rows = [array[own].reshape(len(own), width) for array, width in zip(arrays, widths, strict=True)]
        packed = np.concatenate(rows, axis=1)
        counts = np.bincount(of, minlength=self.division.size) * sum(widths)
        found = self.world.gather(packed.reshape(-1), counts).reshape(-1, sum(widths))
        whole = np.empty_like(found)
        whole[np.argsort(of, kind="stable")] = found
        for array, part in zip(arrays, np.split(whole, np.cumsum(widths)[:-1], axis=1), strict=True):
            array[...] = part.reshape(array.shape)
