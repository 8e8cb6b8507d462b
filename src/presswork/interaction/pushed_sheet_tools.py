# SPDX-License-Identifier: Apache-2.0
"""Tools in space that forces place, such as blank holders: one freedom more for each, by a bordered system.

The tool's travel q along its direction w is found with the nodes' displacements. Contact depends on where a node is in
the tool's frame alone, so with K_i = -d f_i/d x_i of each node that it touches

    K dx - sum K_i w dq = r,        sum w K_i w dq - sum w K_i dx_i = F - sum w f_i,

F the force that pushes, f_i the tool's force on the node. The first line is solved for both of its right-hand sides
with the factors that there are, the second then gives dq. A tool goes no further than to its stop, another tool. While
it stands there and the sheet bears less than F, the other bears the rest.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from presswork.interaction.floating_tools import LostWorkpieceError
from presswork.interaction.sheet_contact import SheetForces
from presswork.model import BoolArray, FloatArray, Model, Push
from presswork.state import State

STANDING = 1e-9
"""Way to its stop at which a tool stands on it [mm]."""


@dataclass(frozen=True)
class Pushed:
    """The pushed tools of a stage at a guess."""

    tools: list[int]
    directions: FloatArray
    """Unit vectors (n, 3)."""
    missing: FloatArray
    """What the sheet's resistance lacks of the force (n,) [N]; nothing of a tool that stands on its stop."""
    room: FloatArray
    """Way that is left to its stop (n,) [mm]."""
    stands: BoolArray
    """Whether its stop holds it (n,)."""

    @property
    def is_open(self) -> bool:
        """Whether any tool is pushed."""
        return len(self.tools) > 0


class PushedSheetTools:
    """The pushed tools of one run; where they are lies in the State."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self.is_needed = bool(model.sheet_tools) and any(m.push for s in model.stages for m in s.tool_motion.values())

    def numbers(self, stage: int) -> list[int]:
        """Return the numbers of the tools that a stage pushes."""
        return [t for t, tool in enumerate(self._model.sheet_tools) if tool.name in self._pushes(stage)]

    def _pushes(self, stage: int) -> Mapping[str, Push]:
        motions = self._model.stages[stage].tool_motion
        return {name: motion.push for name, motion in motions.items() if motion.push is not None}

    def evaluate(self, trial: State, sheet: SheetForces, stage: int, fraction: float) -> Pushed:
        """Return what the tools lack at a fraction of a stage."""
        tools = self.numbers(stage)
        pushes = [self._pushes(stage)[self._model.sheet_tools[t].name] for t in tools]
        directions = np.array([p.direction for p in pushes]).reshape(-1, 3)
        demand = np.array([np.interp(fraction, *p.force.T) for p in pushes])
        missing = demand - np.einsum("ni,ni->n", directions, sheet.by_tool[tools].sum(axis=1))
        room = np.array([self._room(trial, t, push) for t, push in zip(tools, pushes, strict=True)])
        stands = (room < -STANDING) | ((room <= STANDING) & (missing > 0))
        return Pushed(tools, directions, np.where(stands, 0.0, missing), room, stands)

    def _room(self, trial: State, tool: int, push: Push) -> float:
        if not push.stop:
            return math.inf
        other = [t.name for t in self._model.sheet_tools].index(push.stop)
        way = trial.sheet_tool_move[tool] - trial.sheet_tool_move[other]
        return push.clearance - float(way @ np.array(push.direction))

    def correct(
        self, pushed: Pushed, sheet: SheetForces, correction: FloatArray, respond: Callable[[FloatArray], FloatArray]
    ) -> tuple[FloatArray, FloatArray]:
        """Return the correction with the tools' travel in it, and that travel (n,) [mm].

        correction: with the tools held fast (n_points, 6), in the global frame. respond: solves for forces (n_points,
        6). Raises LostWorkpieceError for a tool that touches nothing and has no stop to fall on.
        """
        n = len(pushed.tools)
        rows, responses = [], []
        schur, rest = np.zeros((n, n)), pushed.missing.copy()
        for i, (t, w) in enumerate(zip(pushed.tools, pushed.directions, strict=True)):
            own = sheet.tool == t
            nodes, k = sheet.pairs[own, 0], sheet.blocks[own, :3, :3]
            column, row = np.zeros_like(correction), np.zeros_like(correction)
            column[nodes, :3], row[nodes, :3] = k @ w, w @ k
            falls = not column.any()
            if falls and math.isinf(pushed.room[i]):
                name = self._model.sheet_tools[t].name
                raise LostWorkpieceError(f"the tool {name!r} is pushed by a force, but touches nothing that holds it")
            responses.append(respond(column))
            if falls or pushed.stands[i]:
                rows.append(np.zeros_like(row))
                schur[i, i], rest[i] = 1.0, pushed.room[i]
                continue
            rows.append(row)
            schur[i, i] = float((column[:, :3] @ w).sum())
            rest[i] += float((row * correction).sum())
        for i, row in enumerate(rows):
            for j, response in enumerate(responses):
                schur[i, j] -= float((row * response).sum())
        travel = np.minimum(np.linalg.solve(schur, rest), pushed.room)
        for response, q in zip(responses, travel, strict=True):
            correction = correction + q * response
        return correction, np.asarray(travel, dtype=np.float64)

    def move(self, trial: State, pushed: Pushed, travel: FloatArray) -> None:
        """Move the tools by their travel (n,) [mm]."""
        for t, direction, q in zip(pushed.tools, pushed.directions, travel, strict=True):
            trial.sheet_tool_travel[t] += q * direction
            trial.sheet_tool_move[t] += q * direction
