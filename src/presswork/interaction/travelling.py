# SPDX-License-Identifier: Apache-2.0
"""What tools that float share in the plane and in space: their travels are freedoms of their own."""

from __future__ import annotations

import numpy as np

from presswork.interaction.contract import Interaction
from presswork.interaction.led import Led
from presswork.interaction.placing import Placed, move_tools
from presswork.interaction.tool_arrays import SpaceToolArrays, ToolArrays
from presswork.model import FloatArray
from presswork.outcome import Step
from presswork.state import State


class TravellingTools(Led, Interaction):
    """Tools some of which forces push, or rest on springs."""

    _arrays: type[ToolArrays] | type[SpaceToolArrays]
    """What a state has of them."""

    def _directions(self, stage: int) -> dict[int, FloatArray]:
        """Return the directions (d,) of the tools that float in a stage, by their numbers."""
        raise NotImplementedError

    def find_travel(self, state_n: State, trial: State, step: Step) -> FloatArray:
        """Return the travel of the tools that float in an increment (n,) [mm]."""
        return self._along(trial[self._arrays].travel - state_n[self._arrays].travel, step.stage)

    def find_last_travel(self, state: State, step: Step) -> FloatArray:
        """Return how far they went in the increment that has led to a state (n,) [mm]."""
        return self._along(state[self._arrays].travel_increment, step.stage)

    def _along(self, travel: FloatArray, stage: int) -> FloatArray:
        return np.array([float(travel[t] @ direction) for t, direction in self._directions(stage).items()])

    def travel_like(self, state_n: State, trial: State, step: Step, travel: FloatArray) -> None:
        """Put the tools that float where their travel in the increment leads (n,) [mm]."""
        moving, arrays = self._directions(step.stage), trial[self._arrays]
        directions = np.array(list(moving.values())).reshape(-1, arrays.travel.shape[1])
        further = travel - self.find_travel(state_n, trial, step)
        move_tools(arrays, Placed(list(moving), directions, further), further)
