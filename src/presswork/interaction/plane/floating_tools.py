# SPDX-License-Identifier: Apache-2.0
"""Tools whose place follows from a force: pushed with a given force, or resting on a spring.

The workpiece's force P on a tool is, along the direction d of its travel q,

    P . d = -F (force-controlled),    P . d = preload + stiffness q (on a spring, when off its stop at q = 0).

The nodes that the tool holds follow it: u = u_a + V q, V the motion that contact prescribes for each mm of travel.
placing.py solves for q.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from presswork.interaction.contract import Constraints, turn_back
from presswork.interaction.led import Tangent
from presswork.interaction.placing import (
    Border,
    LostWorkpieceError,
    Placed,
    Springs,
    force_at,
    share_modelled,
)
from presswork.interaction.plane.friction import FrictionForces
from presswork.interaction.plane.tool_contact import Contact
from presswork.interaction.tool_arrays import ToolArrays
from presswork.model import FloatArray, Model
from presswork.outcome import Step
from presswork.state import State

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


@dataclass(frozen=True)
class Floating(Placed):
    """The tools that float at a guess."""

    demand: FloatArray
    """What each is to bear, without its sign (n,) [N]."""
    stiffness: FloatArray
    """Stiffness of their springs (n,) [N/mm]."""
    motions: list[Constraints]
    """What the held nodes do for each mm of travel."""


class FloatingTools:
    """The floating tools of one run; what persists is ToolArrays.travel and ToolArrays.gives."""

    def __init__(self, model: Model, contact: Contact) -> None:
        self._model = model
        self._contact = contact
        self.is_needed = any(t.spring for t in model.plane_tools) or any(
            m.push is not None for s in model.stages for m in s.tool_motion.values()
        )
        self._share = share_modelled(model.plane_tools)
        self._springs = Springs(model.plane_tools)

    def begin_increment(self) -> None:
        """Forget the changes of the increment before."""
        self._springs.begin_increment()

    def pushed(self, stage: int) -> dict[int, tuple[FloatArray, FloatArray]]:
        """Return direction, and rows of part of the stage and force [N], as modelled, of the tools that a force pushes
        in a stage.
        """
        motions = self._model.stages[stage].tool_motion
        return {
            t: (np.asarray(motion.push.direction), motion.push.force * (1.0, float(self._share[t])))
            for t, tool in enumerate(self._model.plane_tools)
            if (motion := motions.get(tool.name)) is not None and motion.push is not None
        }

    def directions(self, stage: int) -> dict[int, FloatArray]:
        """Return the directions (2,) of the tools that forces push in a stage, or that rest on springs, by number."""
        pushed, tools = self.pushed(stage), enumerate(self._model.plane_tools)
        springs = {t: np.asarray(tool.spring.direction) for t, tool in tools if tool.spring is not None}
        return dict(sorted((springs | {t: direction for t, (direction, _) in pushed.items()}).items()))

    def evaluate(
        self, trial: State, reaction: FloatArray, friction: FrictionForces | None, supports: Constraints, stage: int,
        fraction: float, *, near: bool,
    ) -> tuple[Floating, int]:  # fmt: skip
        """Return what floats at a guess, and how many springs have left or reached their stops.

        `reaction` (n_points, 2) [N] on the nodes; the nodes' constraints are taken from the contact of `trial`.
        """
        placed = trial[ToolArrays]
        tools: list[int] = []
        directions, missing, demands, stiffness, motions = [], [], [], [], []
        changes = 0
        pushed = self.pushed(stage)
        for t, tool in enumerate(self._model.plane_tools):
            if t not in pushed and tool.spring is None:
                continue
            direction, demand, k = self._demand(placed, t, stage, fraction)
            motion = self._contact.follow(trial, t, direction, supports)
            lacks = self._force_along(t, direction, motion, reaction, friction) - demand
            if t not in pushed:
                changes += self._springs.leave_or_reach_stop(placed, t, lacks, near=near)
                if not placed.gives[t]:
                    continue
            tools.append(t)
            directions.append(direction)
            missing.append(lacks)
            demands.append(abs(demand))
            stiffness.append(k)
            motions.append(motion)
        shape = np.array(directions).reshape(-1, 2)
        floating = Floating(tools, shape, np.array(missing), np.array(demands), np.array(stiffness), motions)
        return floating, changes

    def _demand(self, placed: ToolArrays, t: int, stage: int, fraction: float) -> tuple[FloatArray, float, float]:
        """Return a tool's direction, the force that it must bear along it [N], and the slope of that over its travel
        [N/mm]."""
        pushed, spring, share = self.pushed(stage), self._model.plane_tools[t].spring, float(self._share[t])
        if t in pushed:
            direction, rows = pushed[t]
            return direction, -force_at(rows, -float(placed.force_start[t] @ direction), fraction), 0.0
        assert spring is not None, "it floats"
        direction, k = np.asarray(spring.direction), spring.stiffness * share
        return direction, spring.preload * share + k * float(placed.travel[t] @ direction), k

    def _force_along(
        self, tool: int, direction: FloatArray, motion: Constraints, reaction: FloatArray,
        friction: FrictionForces | None,
    ) -> float:  # fmt: skip
        """Return the workpiece's force on a tool along a direction [N]."""
        local = np.where(motion.turned[:, None] == 1, np.einsum("nij,nj->ni", motion.frames, reaction), reaction)
        force = -float((motion.value * local).sum())
        if friction is not None:
            own = friction.tools == tool
            force -= float((friction.tangent[own] @ direction) @ friction.force[own])
        return force

    def correct(
        self, floating: Floating, friction: FrictionForces | None, matrix: csr_matrix, correction: FloatArray,
        respond: Callable[[FloatArray, FloatArray], FloatArray],
    ) -> tuple[FloatArray, FloatArray]:  # fmt: skip
        """Return the correction with the tools' travel in it, and that travel (n,) [mm].

        correction: with the tools held fast (n_points, 2), as everything here in the nodes' own frames. matrix: before
        constraints. respond: solves for prescribed values (n_points, 2) and a right-hand side (n_points, 2).
        Raises LostWorkpieceError if no travel can balance a tool.
        """
        responses, rows, own = [], [], floating.stiffness.copy()
        for i, (t, direction, motion) in enumerate(
            zip(floating.tools, floating.directions, floating.motions, strict=True)
        ):
            pull, more = _find_pull(friction, t, direction, correction)
            own[i] += more
            rows.append(np.asarray(matrix.T @ motion.value.ravel()).reshape(-1, 2) - pull)
            responses.append(respond(motion.value, pull))
        border = Border(rows, own, responses)
        diagonal = np.abs(np.diag(border.matrix()))
        if diagonal.min() == 0.0:
            lost = self._model.plane_tools[floating.tools[int(diagonal.argmin())]].name
            raise LostWorkpieceError(f"the tool {lost!r} is pushed by a force, but touches nothing that would hold it")
        travel = border.find_travel(floating.missing, correction)
        return border.carry(correction, travel), travel

    # --- of a neighbour of a run, by which its derivatives are found -----------------------------------------------

    def find_missing(
        self, trial: State, reaction: FloatArray, friction: FrictionForces | None, supports: Constraints, stage: int,
        fraction: float,
    ) -> FloatArray:  # fmt: skip
        """Return what each pushed tool, and each on a spring that gives, lacks (n,) [N]; how far one whose spring rests
        is from there [mm].
        """
        placed, pushed, found = trial[ToolArrays], self.pushed(stage), []
        for t, direction in self.directions(stage).items():
            if t in pushed or placed.gives[t]:
                motion = self._contact.follow(trial, t, direction, supports)
                demand = self._demand(placed, t, stage, fraction)[1]
                found.append(self._force_along(t, direction, motion, reaction, friction) - demand)
            else:
                found.append(-float(placed.travel[t] @ direction))
        return np.array(found)

    def find_border(
        self, trial: State, friction: FrictionForces | None, supports: Constraints, step: Step, tangent: Tangent
    ) -> Border:
        """Return the equations of find_missing, in the global frame."""
        placed, pushed = trial[ToolArrays], self.pushed(step.stage)
        rows, responses, own = [], [], []
        for t, direction in self.directions(step.stage).items():
            motion = self._contact.follow(trial, t, direction, supports)
            if t in pushed or placed.gives[t]:
                pull, more = _find_pull(friction, t, direction, motion.value)
                own.append(self._demand(placed, t, step.stage, step.fraction)[2] + more)
                pull, moves = turn_back(motion, pull), turn_back(motion, motion.value.copy())
                rows.append(tangent.find_row(moves) - pull)
                responses.append(tangent.answer(pull, moves))
            else:
                rows.append(np.zeros_like(motion.value))
                own.append(1.0)
                responses.append(np.zeros_like(motion.value))
        return Border(rows, np.array(own), responses)


def _find_pull(
    friction: FrictionForces | None, t: int, direction: FloatArray, nodes: FloatArray
) -> tuple[FloatArray, float]:
    """Return the friction on the nodes for each mm of a tool's travel, in their own frames and the form of `nodes`
    (n_points, 2), and its share in the tool's own equation, both [N/mm].
    """
    pull = np.zeros_like(nodes)
    if friction is None:
        return pull, 0.0
    own = friction.tools == t
    along = friction.tangent[own] @ direction
    pull[friction.nodes[own], 1] = friction.stiffness[own] * along
    return pull, float((friction.stiffness[own] * along**2).sum())
