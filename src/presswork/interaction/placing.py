# SPDX-License-Identifier: Apache-2.0
"""Tools that forces place: each adds one freedom, its travel q along a direction, and one equation. In that equation

the workpiece's force on the tool equals the force that pushes it. The system of the nodes so gets a border,

    K dx - c_j q_j = r,        a_i dx + d_i q_i = m_i,

c_j being the force on the nodes for each mm of travel, m_i what tool i lacks, a_i and d_i the derivatives of that. K is
factorised as before. The response b_j of the nodes to c_j costs one substitution for each tool, and a system of as many
equations as there are tools gives their travel (Schur complement),

    (a_i b_j + d_i delta_ij) q_j = m_i - a_i dx_0,        dx = dx_0 + b_j q_j,

dx_0 being the correction with the tools held fast.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from presswork.interaction.tool_arrays import SpaceToolArrays, ToolArrays
from presswork.model import FloatArray, Tool

MAX_CHANGES = 4
"""Most times that a spring-backed tool may leave or reach its stop in an increment."""


class LostWorkpieceError(Exception):
    """A tool that a force pushes touches nothing: nothing balances the force."""


@dataclass(frozen=True)
class Placed:
    """The tools that forces place at a guess."""

    tools: list[int]
    directions: FloatArray
    """Unit vectors (n, 2 | 3)."""
    missing: FloatArray
    """What each lacks for equilibrium (n,) [N]."""

    @property
    def is_open(self) -> bool:
        """Whether there is any such tool."""
        return len(self.tools) > 0


@dataclass(frozen=True)
class Border:
    """Rows and columns that the tools add to the system of the nodes."""

    rows: Sequence[FloatArray]
    """a: derivative of each equation by the nodes' displacement (n_points, freedoms) [N/mm]."""
    own: FloatArray
    """d: by the tool's own travel (n,) [N/mm]."""
    responses: Sequence[FloatArray]
    """b: of the nodes to each mm of travel (n_points, freedoms)."""

    def matrix(self) -> FloatArray:
        """Return the Schur complement (n, n) [N/mm]."""
        coupled = [[float((row * response).sum()) for response in self.responses] for row in self.rows]
        return np.asarray(np.diag(self.own) + np.reshape(coupled, (len(self.rows), len(self.rows))), dtype=np.float64)

    def find_travel(self, missing: FloatArray, correction: FloatArray) -> FloatArray:
        """Return the travel (n,) [mm]; correction: of the nodes with the tools held fast (n_points, freedoms).

        Raises LostWorkpieceError where the workpiece moves along with a tool without any force on it.
        """
        rest = missing - [float((row * correction).sum()) for row in self.rows]
        try:
            return np.asarray(np.linalg.solve(self.matrix(), rest), dtype=np.float64)
        except np.linalg.LinAlgError:
            raise LostWorkpieceError(
                "a force pushes a tool, but what the tool touches moves along with it and nothing holds it; let the "
                "workpiece reach under the tool, or place the tool by a stroke"
            ) from None

    def carry(self, correction: FloatArray, travel: FloatArray) -> FloatArray:
        """Return the correction of the nodes with the tools' travel in it."""
        for response, q in zip(self.responses, travel, strict=True):
            correction = correction + q * response
        return correction


class Springs:
    """Tools on springs, which leave and reach their stops."""

    def __init__(self, tools: Sequence[Tool]) -> None:
        self._tools = tools
        self._changes = np.zeros(len(tools), dtype=np.int64)

    def begin_increment(self) -> None:
        """Forget the changes of the increment before."""
        self._changes[:] = 0

    def leave_or_reach_stop(self, placed: ToolArrays | SpaceToolArrays, t: int, lacks: float, *, near: bool) -> int:
        """Let a spring give when it is pushed with more than its preload, and stop it where it began.

        lacks: force on the tool beyond that of the spring [N]. Returns how many springs have changed.
        """
        spring = self._tools[t].spring
        assert spring is not None
        direction = np.asarray(spring.direction)
        travel = float(placed.travel[t] @ direction)
        if not near or self._changes[t] >= MAX_CHANGES:
            return 0
        if placed.gives[t] and travel < 0.0:
            placed.displacement[t] -= travel * direction
            placed.travel[t] -= travel * direction
            placed.gives[t] = 0
        elif not placed.gives[t] and lacks > 0.0:
            placed.gives[t] = 1
        else:
            return 0
        self._changes[t] += 1
        return 1


def share_modelled(tools: Sequence[Tool]) -> FloatArray:
    """Return which part of each whole tool is modelled (n_tools,)."""
    return np.array([0.5 ** sum(tool.mirrored_across) / tool.sectors for tool in tools])


def force_at(rows: FloatArray, start: float, fraction: float) -> float:
    """Return the force at a part of a stage [N]; rows: of parts and forces (n, 2), start: force as it begins."""
    part, force = rows[0]
    if fraction >= part:
        return float(np.interp(fraction, *rows.T))
    return float((1.0 - fraction / part) * start + fraction / part * force)


def move_tools(arrays: ToolArrays | SpaceToolArrays, placed: Placed, travel: FloatArray) -> None:
    """Move the tools by their travel (n,) [mm]."""
    for t, direction, q in zip(placed.tools, placed.directions, travel, strict=True):
        arrays.travel[t] += q * direction
        arrays.displacement[t] += q * direction
