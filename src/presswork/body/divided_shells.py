# SPDX-License-Identifier: Apache-2.0
"""Shells divided over ranks: each evaluates its own, and all know forces and converged states."""

from __future__ import annotations

from collections.abc import Sequence

from presswork.body.contract import Look, Near
from presswork.body.divided_cells import DividedCells
from presswork.body.law_failed import LawFailed
from presswork.body.shell_arrays import ShellBlock
from presswork.body.shells import ShellAssembler, ShellFailed, ShellMechanics
from presswork.model import FloatArray, IntArray, Model
from presswork.ranks.world import World
from presswork.state import State
from presswork.timing import Timing


class DividedShellMechanics(ShellMechanics):
    """Evaluates this rank's shells; forces on nodes are those of the shells of all ranks."""

    def __init__(self, model: Model, timing: Timing, world: World) -> None:
        self._divided = DividedCells(model.mesh, world)
        super().__init__(model, timing)

    def _choose_cells(self, of_cells: list[IntArray]) -> list[IntArray]:
        return self._divided.choose(of_cells)

    def _make_assembler(self, couplings: IntArray | None) -> ShellAssembler:
        symmetric = self._model.solver.symmetric
        make, cells = self._make_core_assembler, self._connectivity
        return self._divided.make_assembler(make, cells, couplings, symmetric=symmetric)

    def _evaluate_cells(
        self, state_n: State, trial: State, increment: FloatArray, *, with_stiffness: bool, dt: float
    ) -> ShellFailed | LawFailed | None:
        bad = super()._evaluate_cells(state_n, trial, increment, with_stiffness=with_stiffness, dt=dt)
        agreed: ShellFailed | LawFailed | None = self._divided.agree_on(bad)
        return agreed

    def look_near(self, looks: Sequence[Look], places: FloatArray) -> list[Near]:
        """Return what looks find of all nodes: each rank looks from its own."""
        return self._divided.look_near(looks, places)

    def _take_block(self, state: State, i: int) -> ShellBlock:
        """Return copies: a rank's shells lie apart."""
        whole = super()._take_block(state, i)
        return ShellBlock(*(self._divided.take(array, i) for array in (*whole.filled, whole.temperature)))

    def _keep_block(self, block: ShellBlock, state: State, i: int) -> None:
        for to, array in zip(super()._take_block(state, i).filled, block.filled, strict=True):
            to[self._divided.own[i]] = array

    def complete(self, trial: State) -> None:
        """Bring the arrays of all ranks' shells into the trial state of each rank."""
        for i in range(len(self._connectivity)):
            whole = super()._take_block(trial, i)
            self._divided.share(i, whole.filled)
            self._store_plastic_strain(trial, i)
