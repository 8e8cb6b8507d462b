# SPDX-License-Identifier: Apache-2.0
"""Tools in space whose place follows from a force: pushed with a given one, as a blank holder, or resting on a spring.

Contact depends on where a node is in the tool's frame alone. With K_i = -d f_i/d x_i of each node that the tool
touches, f_i the tool's force on the node, w the direction of its travel q, F the force that pushes it, and preload and
stiffness k those of a spring that is off its stop at q = 0,

    sum w K_i w dq - sum w K_i dx_i = F - sum w f_i,
    (k + sum w K_i w) dq - sum w K_i dx_i = -sum w f_i - preload - k q.

placing.py solves for q. A pushed tool goes no further than to its stop, another tool. While it stands there and the
sheet bears less than F, the other bears the rest.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from presswork.interaction.placing import (
    Border,
    LostWorkpieceError,
    Placed,
    Springs,
    force_at,
    share_modelled,
)
from presswork.interaction.space.space_contact import SpaceForces
from presswork.interaction.tool_arrays import SpaceToolArrays
from presswork.model import BoolArray, FloatArray, Model, Push, Spring
from presswork.outcome import GaveUpError
from presswork.state import State

STANDING = 1e-9
"""Distance to its stop at which a tool stands on it [mm]."""
STANDING_ROOM = 1e-6
"""The same of a neighbour of a run, by which its derivatives are found [mm]."""


@dataclass(frozen=True)
class FloatingInSpace(Placed):
    """The tools that float at a guess; one that stands on its stop lacks nothing."""

    demand: FloatArray
    """What each is to bear, without its sign (n,) [N]."""
    stiffness: FloatArray
    """Stiffness of their springs (n,) [N/mm]."""
    room: FloatArray
    """Way that is left to its stop (n,) [mm]."""
    stands: BoolArray
    """Whether its stop holds it (n,)."""


class FloatingSpaceTools:
    """The floating tools of one run; where they are lies in the State."""

    def __init__(self, model: Model) -> None:
        self._model = model
        tools = model.space_tools
        pushes = any(m.push for s in model.stages for m in s.tool_motion.values())
        self.is_needed = bool(tools) and (pushes or any(tool.spring for tool in tools))
        self._share = share_modelled(tools)
        self._springs = Springs(tools)

    def begin_increment(self) -> None:
        """Forget the changes of the increment before."""
        self._springs.begin_increment()

    def pushes(self, stage: int) -> dict[int, Push]:
        """Return what pushes tools in a stage, by their numbers."""
        motions = self._model.stages[stage].tool_motion
        found = {t: motions[tool.name].push for t, tool in enumerate(self._model.space_tools) if tool.name in motions}
        return {t: push for t, push in found.items() if push is not None}

    def directions(self, stage: int) -> dict[int, FloatArray]:
        """Return the directions (3,) of the tools that forces push in a stage, or that rest on springs, by number."""
        pushes, tools = self.pushes(stage), enumerate(self._model.space_tools)
        return {t: np.asarray(by.direction) for t, tool in tools if (by := pushes.get(t, tool.spring)) is not None}

    def evaluate(
        self, trial: State, contact: SpaceForces, stage: int, fraction: float, *, near: bool
    ) -> tuple[FloatingInSpace, int]:
        """Return what the tools lack at a fraction of a stage, and how many springs have left or reached stops."""
        placed, pushes = trial[SpaceToolArrays], self.pushes(stage)
        tools: list[int] = []
        directions, missing, demands, stiffness, room, changes = [], [], [], [], [], 0
        for t, tool in enumerate(self._model.space_tools):
            push = pushes.get(t)
            if push is not None:
                direction, k = np.asarray(push.direction), 0.0
                demand = self._demand(placed, t, push, fraction)
            elif tool.spring is not None:
                direction = np.asarray(tool.spring.direction)
                demand, k = self._resist(placed, t, tool.spring)
            else:
                continue
            lacks = _bear(contact, t, direction) - demand
            if push is None:
                changes += self._springs.leave_or_reach_stop(placed, t, lacks, near=near)
                if not placed.gives[t]:
                    continue
            tools.append(t)
            directions.append(direction)
            missing.append(lacks)
            demands.append(abs(demand))
            stiffness.append(k)
            room.append(math.inf if push is None else self._room(trial, t, push))
        left, lacking = np.array(room), np.array(missing)
        stands = (left < -STANDING) | ((left <= STANDING) & (lacking > 0))
        shape = np.array(directions).reshape(-1, 3)
        lacking = np.where(stands, 0.0, lacking)
        floating = FloatingInSpace(tools, shape, lacking, np.array(demands), np.array(stiffness), left, stands)
        return floating, changes

    def _demand(self, placed: SpaceToolArrays, t: int, push: Push, fraction: float) -> float:
        """Return the force along its push that the workpiece must bear on a tool at a part of a stage [N]."""
        start = -float(placed.force_start[t] @ np.asarray(push.direction))
        return -force_at(push.force * (1.0, float(self._share[t])), start, fraction)

    def _resist(self, placed: SpaceToolArrays, t: int, spring: Spring) -> tuple[float, float]:
        """Return the force of a tool's spring where it gives, and its slope [N, N/mm]."""
        share = float(self._share[t])
        k = spring.stiffness * share
        return spring.preload * share + k * float(placed.travel[t] @ np.asarray(spring.direction)), k

    def _room(self, trial: State, tool: int, push: Push) -> float:
        if not push.stop:
            return math.inf
        placed = trial[SpaceToolArrays]
        other = [t.name for t in self._model.space_tools].index(push.stop)
        apart = placed.displacement[tool] - placed.displacement[other]
        return push.clearance - float(apart @ np.array(push.direction))

    def find_columns(self, floating: FloatingInSpace, contact: SpaceForces) -> Sequence[FloatArray]:
        """Return the forces on the nodes for each mm of each tool's travel (n_points, freedoms) [N/mm]."""
        along = zip(floating.tools, floating.directions, strict=True)
        return [_spread(contact, t, contact.blocks[:, :3, :3] @ w) for t, w in along]

    def correct(
        self,
        floating: FloatingInSpace,
        contact: SpaceForces,
        correction: FloatArray,
        responses: Sequence[FloatArray],
    ) -> tuple[FloatArray, FloatArray]:
        """Return the correction with the tools' travel in it, and that travel (n,) [mm].

        correction: with the tools held fast (n_points, 6), in the global frame. responses: of the nodes to the forces
        of find_columns. Raises LostWorkpieceError for a tool that touches nothing and has neither spring nor stop to
        fall on.
        """
        rows = []
        own_slope, missing = floating.stiffness.copy(), floating.missing.copy()
        for i, (t, w) in enumerate(zip(floating.tools, floating.directions, strict=True)):
            pull = contact.blocks[contact.tool == t, :3, :3] @ w
            falls = not pull.any() and floating.stiffness[i] == 0.0
            if falls and math.isinf(floating.room[i]):
                name = self._model.space_tools[t].name
                raise LostWorkpieceError(f"the tool {name!r} is pushed by a force, but touches nothing that holds it")
            if falls or floating.stands[i]:
                rows.append(np.zeros_like(correction))
                own_slope[i], missing[i] = 1.0, floating.room[i]
            else:
                rows.append(_spread(contact, t, -(w @ contact.blocks[:, :3, :3])))
                own_slope[i] += float((pull @ w).sum())
        border = Border(rows, own_slope, responses)
        travel = np.minimum(border.find_travel(missing, correction), floating.room)
        return border.carry(correction, travel), travel

    # --- of a neighbour of a run, by which its derivatives are found -----------------------------------------------

    def find_missing(self, trial: State, contact: SpaceForces, stage: int, fraction: float) -> FloatArray:
        """Return what each pushed tool, and each on a spring that gives, lacks (n,) [N]; how far one whose spring rests
        is from there [mm]. Raises GaveUpError where one has come to stand on its stop.
        """
        placed, pushes, found = trial[SpaceToolArrays], self.pushes(stage), []
        for t, direction in self.directions(stage).items():
            tool, push = self._model.space_tools[t], pushes.get(t)
            if push is not None:
                if self._room(trial, t, push) <= STANDING_ROOM:
                    raise GaveUpError(f"{tool.name!r} stands on {push.stop!r}")
                found.append(_bear(contact, t, direction) - self._demand(placed, t, push, fraction))
            elif placed.gives[t] and tool.spring is not None:
                found.append(_bear(contact, t, direction) - self._resist(placed, t, tool.spring)[0])
            else:
                found.append(-float(placed.travel[t] @ direction))
        return np.array(found)

    def find_border(
        self,
        trial: State,
        contact: SpaceForces,
        stage: int,
        respond: Callable[[FloatArray], FloatArray],
    ) -> Border:
        """Return the equations of find_missing; respond: solves for forces (n_points, freedoms)."""
        placed, pushes = trial[SpaceToolArrays], self.pushes(stage)
        rows, responses, own = [], [], []
        for t, direction in self.directions(stage).items():
            spring = self._model.space_tools[t].spring
            column = _spread(contact, t, contact.blocks[:, :3, :3] @ direction)
            row = _spread(contact, t, -(direction @ contact.blocks[:, :3, :3]))
            if t in pushes or placed.gives[t]:
                k = self._resist(placed, t, spring)[1] if t not in pushes and spring is not None else 0.0
                own.append(k + float((column[:, :3] @ direction).sum()))
                responses.append(respond(column))
            else:
                row[:] = 0.0
                own.append(1.0)
                responses.append(column)
            rows.append(row)
        return Border(rows, np.array(own), responses)


def _bear(contact: SpaceForces, t: int, direction: FloatArray) -> float:
    """Return the workpiece's force on a tool along a direction [N]."""
    return -float(contact.by_tool[t].sum(axis=0) @ direction)


def _spread(contact: SpaceForces, t: int, values: FloatArray) -> FloatArray:
    """Return a vector of the nodes (n_points, freedoms) with the values (n, 3) of the blocks of a tool."""
    own = contact.tool == t
    vector = np.zeros_like(contact.force)
    vector[contact.pairs[own, 0], :3] = values[own]
    return vector
