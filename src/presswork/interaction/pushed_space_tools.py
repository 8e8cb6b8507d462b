# SPDX-License-Identifier: Apache-2.0
"""Tools in space that forces place, such as blank holders.

Contact depends on where a node is in the tool's frame alone. With K_i = -d f_i/d x_i of each node that the tool
touches, f_i the tool's force on the node, w the direction of its travel q and F the force that pushes it,

    sum w K_i w dq - sum w K_i dx_i = F - sum w f_i.

placing.py solves for q. A tool goes no further than to its stop, another tool. While it stands there and the sheet
bears less than F, the other bears the rest.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from presswork.interaction.placing import Border, LostWorkpieceError, Placed
from presswork.interaction.space_contact import SpaceForces
from presswork.interaction.tool_arrays import SpaceToolArrays
from presswork.model import BoolArray, FloatArray, Model, Push
from presswork.state import State

STANDING = 1e-9
"""Way to its stop at which a tool stands on it [mm]."""


@dataclass(frozen=True)
class Pushed(Placed):
    """The pushed tools of a stage at a guess; one that stands on its stop lacks nothing."""

    room: FloatArray
    """Way that is left to its stop (n,) [mm]."""
    stands: BoolArray
    """Whether its stop holds it (n,)."""


class PushedSpaceTools:
    """The pushed tools of one run; where they are lies in the State."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self.is_needed = bool(model.space_tools) and any(m.push for s in model.stages for m in s.tool_motion.values())

    def numbers(self, stage: int) -> list[int]:
        """Return the numbers of the tools that a stage pushes."""
        return [t for t, tool in enumerate(self._model.space_tools) if tool.name in self._pushes(stage)]

    def _pushes(self, stage: int) -> Mapping[str, Push]:
        motions = self._model.stages[stage].tool_motion
        return {name: motion.push for name, motion in motions.items() if motion.push is not None}

    def evaluate(self, trial: State, sheet: SpaceForces, stage: int, fraction: float) -> Pushed:
        """Return what the tools lack at a fraction of a stage."""
        tools = self.numbers(stage)
        pushes = [self._pushes(stage)[self._model.space_tools[t].name] for t in tools]
        directions = np.array([p.direction for p in pushes]).reshape(-1, 3)
        demand = np.array([np.interp(fraction, *p.force.T) for p in pushes])
        missing = demand - np.einsum("ni,ni->n", directions, sheet.by_tool[tools].sum(axis=1))
        room = np.array([self._room(trial, t, push) for t, push in zip(tools, pushes, strict=True)])
        stands = (room < -STANDING) | ((room <= STANDING) & (missing > 0))
        return Pushed(tools, directions, np.where(stands, 0.0, missing), room, stands)

    def _room(self, trial: State, tool: int, push: Push) -> float:
        if not push.stop:
            return math.inf
        placed = trial[SpaceToolArrays]
        other = [t.name for t in self._model.space_tools].index(push.stop)
        way = placed.displacement[tool] - placed.displacement[other]
        return push.clearance - float(way @ np.array(push.direction))

    def correct(
        self, pushed: Pushed, sheet: SpaceForces, correction: FloatArray, respond: Callable[[FloatArray], FloatArray]
    ) -> tuple[FloatArray, FloatArray]:
        """Return the correction with the tools' travel in it, and that travel (n,) [mm].

        correction: with the tools held fast (n_points, 6), in the global frame. respond: solves for forces (n_points,
        6). Raises LostWorkpieceError for a tool that touches nothing and has no stop to fall on.
        """
        rows, responses = [], []
        own_slope, missing = np.zeros(len(pushed.tools)), pushed.missing.copy()
        for i, (t, w) in enumerate(zip(pushed.tools, pushed.directions, strict=True)):
            own = sheet.tool == t
            nodes, k = sheet.pairs[own, 0], sheet.blocks[own, :3, :3]
            column, row = np.zeros_like(correction), np.zeros_like(correction)
            column[nodes, :3] = k @ w
            falls = not column.any()
            if falls and math.isinf(pushed.room[i]):
                name = self._model.space_tools[t].name
                raise LostWorkpieceError(f"the tool {name!r} is pushed by a force, but touches nothing that holds it")
            if falls or pushed.stands[i]:
                own_slope[i], missing[i] = 1.0, pushed.room[i]
            else:
                row[nodes, :3] = -(w @ k)
                own_slope[i] = float((column[:, :3] @ w).sum())
            responses.append(respond(column))
            rows.append(row)
        border = Border(rows, own_slope, responses)
        travel = np.minimum(border.find_travel(missing, correction), pushed.room)
        return border.carry(correction, travel), travel
