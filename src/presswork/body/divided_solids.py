# SPDX-License-Identifier: Apache-2.0
"""Cells of solids divided over ranks: each evaluates its own, and all know forces and converged states."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields

from presswork.body.contract import Look, Near
from presswork.body.divided_cells import DividedCells
from presswork.body.law_failed import LawFailed
from presswork.body.solids import CellBlock, Mechanics, SolidAssembler
from presswork.body.turned_inside_out import TurnedInsideOut
from presswork.model import FloatArray, IntArray, Model
from presswork.ranks.world import World
from presswork.state import CellArrays, State
from presswork.timing import Timing

FILLED = ("stress", "eqps", "hourglass", "volume", "history")
"""Arrays that the evaluation fills."""


class DividedMechanics(Mechanics):
    """Evaluates this rank's cells; forces on nodes are those of the cells of all ranks."""

    def __init__(self, model: Model, timing: Timing, world: World) -> None:
        self._divided = DividedCells(model.mesh, world)
        super().__init__(model, timing)

    def _choose_cells(self) -> list[IntArray]:
        return self._divided.choose(self._connectivity)

    def _make_assembler(self, couplings: IntArray | None) -> SolidAssembler:
        symmetric = self._model.solver.symmetric
        make, cells = self._make_core_assembler, self._connectivity
        return self._divided.make_assembler(make, cells, couplings, symmetric=symmetric)

    def _evaluate_cells(
        self, state_n: State, trial: State, increment: FloatArray, *, with_stiffness: bool, dt: float
    ) -> TurnedInsideOut | LawFailed | None:
        bad = super()._evaluate_cells(state_n, trial, increment, with_stiffness=with_stiffness, dt=dt)
        agreed: TurnedInsideOut | LawFailed | None = self._divided.agree_on(bad)
        return agreed

    def look_near(self, looks: Sequence[Look], places: FloatArray) -> list[Near]:
        """Return what looks find of all nodes: each rank looks from its own."""
        return self._divided.look_near(looks, places)

    def _take_block(self, cells: CellArrays, i: int) -> CellBlock:
        """Return copies: a rank's cells lie apart."""
        return CellBlock(*(self._divided.take(getattr(cells, field.name)[i], i) for field in fields(CellBlock)))

    def _keep_block(self, block: CellBlock, cells: CellArrays, i: int) -> None:
        for name in FILLED:
            getattr(cells, name)[i][self._divided.own[i]] = getattr(block, name)

    def complete(self, trial: State) -> None:
        """Bring the arrays of all ranks' cells into the trial state of each rank."""
        for i in range(len(self._connectivity)):
            self._divided.share(i, [getattr(trial.cells, name)[i] for name in FILLED])
