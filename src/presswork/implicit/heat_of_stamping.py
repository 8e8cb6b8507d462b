# SPDX-License-Identifier: Apache-2.0
"""Heat of a sheet between tools in implicit increments: after each converged one heat flows over its time
(interaction/heat/heat_of_sheet.py), and the layers take the temperatures that it leads to.
"""

from __future__ import annotations

import numpy as np

from presswork import _core
from presswork.body.sheet_heat import LayerMap
from presswork.body.shell_arrays import ShellArrays
from presswork.body.shells import ShellMechanics
from presswork.implicit.temperature_change import judge_change
from presswork.interaction.heat.heat_of_sheet import HeatOfSheet, SheetHeatArrays, SheetInstant
from presswork.interaction.tool_arrays import SpaceToolArrays
from presswork.model import FloatArray, Model
from presswork.outcome import Converged, Failed, IterationLog, Step
from presswork.state import State


class HeatOfStamping:
    """Conducts heat in the shells of a stamping."""

    def __init__(self, model: Model, mechanics: ShellMechanics) -> None:
        assert model.heat is not None
        self._model, self._mechanics, self.sheet = model, mechanics, HeatOfSheet(model)
        heights, levels = mechanics.layer_heights(0), model.heat.levels
        self._maps = [
            LayerMap(
                block.connectivity,
                np.asarray(_core.shell_shape(block.element)[0]),
                heights,
                levels,
                len(model.mesh.points),
            )
            for block in model.mesh.blocks
        ]
        self._found = self.at_rest()
        self._positions = np.array([tool.position for tool in model.space_tools]).reshape(-1, 3)

    def at_rest(self) -> SheetHeatArrays:
        """Return the temperatures at the start."""
        return self.sheet.at_rest()

    def spread(self, state: State) -> None:
        """Give the layers of a State their temperatures."""
        state.cells.temperature = self._to_laws(state, state[SheetHeatArrays])

    def _to_laws(self, state: State, arrays: SheetHeatArrays) -> list[FloatArray]:
        """Return the temperatures given to the layers of each block (n_cells, q k) [degrees C]; none where none are."""
        return [
            self._to_layers(block, arrays) if given.size else given
            for block, given in enumerate(state.cells.temperature)
        ]

    def at_points(self, state: State, block: int) -> FloatArray:
        """Return the temperatures of a block's layers (n_cells, q k) [degrees C]."""
        return self._to_layers(block, state[SheetHeatArrays])

    def _to_layers(self, block: int, arrays: SheetHeatArrays) -> FloatArray:
        found = self._maps[block].to_layers(arrays.temperature)
        return found.reshape(len(found), -1)

    def find(self, state_n: State, trial: State, step: Step, log: IterationLog) -> Converged | Failed:
        """Find the heat of an increment in equilibrium, or refuse one in which temperatures given to laws change by
        much.

        Raises GaveUpError if there is no balance of heat.
        """
        tools, tools_n = trial[SpaceToolArrays], state_n[SpaceToolArrays]
        moved = tools.displacement - tools_n.displacement
        plastic = np.zeros_like(trial[SheetHeatArrays].temperature)
        for layers, work in zip(
            self._maps, self._mechanics.plastic_work_at_layers(state_n, trial, step.dt), strict=True
        ):
            plastic += layers.to_levels(work)
        now = SheetInstant(
            self._model.mesh.points + trial.nodes.displacement[:, :3],
            np.concatenate([thickness.mean(axis=1) for thickness in trial[ShellArrays].thickness]),
            self._positions + tools.displacement,
            tools.force,
            trial.nodes.increment[None, :, :3] - moved[:, None],
            plastic,
        )
        self._found = self.sheet.advance(state_n[SheetHeatArrays], now, step.dt, self._model.stages[step.stage].dwell)
        after = self._to_laws(state_n, self._found)
        return judge_change(self._model, state_n.cells.temperature, after, step, log)

    def take(self, trial: State) -> None:
        """Take what was found into a trial state that becomes the converged one."""
        trial.replace(self._found)
        self.spread(trial)
