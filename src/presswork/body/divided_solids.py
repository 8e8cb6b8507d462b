# SPDX-License-Identifier: Apache-2.0
"""Cells of solids divided over ranks: each evaluates its own, and all know forces and converged states."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace

import numpy as np

from presswork.body.contract import Look, Near
from presswork.body.law_failed import LawFailed
from presswork.body.solids import CellBlock, Mechanics, SolidAssembler, TurnedInsideOut
from presswork.model import FloatArray, IndexArray, IntArray, Model
from presswork.ranks.assembler import DividedAssembler
from presswork.ranks.division import divide
from presswork.ranks.world import World
from presswork.state import CellArrays, State
from presswork.timing import Timing

FILLED = ("stress", "eqps", "hourglass", "volume", "history")
"""Arrays that the evaluation fills."""


class DividedMechanics(Mechanics):
    """Evaluates this rank's cells; forces on nodes are those of the cells of all ranks."""

    def __init__(self, model: Model, timing: Timing, world: World) -> None:
        self._world = world
        self._division = divide(model.mesh, world.size)
        self._own = self._division.cells(world.rank)
        super().__init__(model, timing)

    def _choose_cells(self) -> list[IntArray]:
        return [np.ascontiguousarray(c[own]) for c, own in zip(self._connectivity, self._own, strict=True)]

    def _make_assembler(self, couplings: IntArray | None) -> SolidAssembler:
        return DividedAssembler(
            self._make_core_assembler,
            self._connectivity,
            couplings,
            self._division,
            self._world,
            symmetric=self._model.solver.symmetric,
        )

    def _evaluate_cells(
        self, state_n: State, trial: State, increment: FloatArray, *, with_stiffness: bool, dt: float
    ) -> TurnedInsideOut | LawFailed | None:
        """Return the failure of the lowest rank that has one, the same on all ranks."""
        bad = super()._evaluate_cells(state_n, trial, increment, with_stiffness=with_stiffness, dt=dt)
        if not self._world.largest(int(bad is not None)):
            return None
        if bad is not None:
            bad = replace(bad, cell=int(self._own[bad.block][bad.cell]))
        failed: list[TurnedInsideOut | LawFailed | None] = self._world.gather_objects(bad)
        return next(found for found in failed if found is not None)

    def look_near(self, looks: Sequence[Look], places: FloatArray) -> list[Near]:
        """Return what looks find of all nodes: each rank looks from its own, and tells of those that are near."""
        if self._world.leads:
            return super().look_near(looks, places)
        own, rows = np.flatnonzero(self._division.owner == self._world.rank), [np.zeros((0, 6))]
        for look, (nearest, reach) in enumerate(looks):
            gap, normal = nearest(places[own], reach)
            near = np.isfinite(gap)
            rows.append(np.column_stack([np.full(near.sum(), look), own[near], gap[near], normal[near]]))
        found = self._world.gather_rows(np.concatenate(rows))
        of, node = found[:, 0].astype(np.intp), found[:, 1].astype(np.intp)
        seen = np.full((len(looks), len(places)), np.inf), np.zeros((len(looks), len(places), 3))
        seen[0][of, node], seen[1][of, node] = found[:, 2], found[:, 3:]
        return list(zip(*seen, strict=True))

    def _take_block(self, cells: CellArrays, i: int) -> CellBlock:
        """Return copies: a rank's cells lie apart."""
        own = self._own[i]
        return CellBlock(*(_take(getattr(cells, field.name)[i], own) for field in fields(CellBlock)))

    def _keep_block(self, block: CellBlock, cells: CellArrays, i: int) -> None:
        for name in FILLED:
            getattr(cells, name)[i][self._own[i]] = getattr(block, name)

    def complete(self, trial: State) -> None:
        """Bring the arrays of all ranks' cells into the trial state of each rank."""
        for i, of in enumerate(self._division.rank_of_cell):
            arrays = [getattr(trial.cells, name)[i] for name in FILLED]
            widths = [array[0].size for array in arrays]
            rows = [a[self._own[i]].reshape(len(self._own[i]), w) for a, w in zip(arrays, widths, strict=True)]
            packed = np.concatenate(rows, axis=1)
            counts = np.bincount(of, minlength=self._division.size) * sum(widths)
            found = self._world.gather(packed.reshape(-1), counts).reshape(-1, sum(widths))
            whole = np.empty_like(found)
            whole[np.argsort(of, kind="stable")] = found
            for array, part in zip(arrays, np.split(whole, np.cumsum(widths)[:-1], axis=1), strict=True):
                array[...] = part.reshape(array.shape)


def _take(array: FloatArray, own: IndexArray) -> FloatArray:
    """Return the rows of own cells; of what a material does not have, nothing."""
    return array[own] if len(array) else array
