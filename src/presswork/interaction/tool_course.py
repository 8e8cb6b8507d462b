# SPDX-License-Identifier: Apache-2.0
"""Where strokes, turns and placing bring the rigid tools of a run, in the plane and in space; the State keeps it."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from presswork.interaction.tool_arrays import SpaceToolArrays, ToolArrays
from presswork.model import FloatArray, Stage, Tool, ToolMotion


class ToolCourse:
    """The tools' motions over the stages."""

    def __init__(self, tools: tuple[Tool, ...], stages: tuple[Stage, ...], dimension: int) -> None:
        self._tools, self._stages, self._dimension = tools, stages, dimension

    def base(self, stage: int) -> FloatArray:
        """Prescribed displacement [mm] and angle [rad] of the tools at the start of a stage (n_tools, d + 1)."""
        base = np.zeros((len(self._tools), self._dimension + 1))
        for earlier in self._stages[:stage]:
            base += self._motion(earlier)
        return base

    def _motion(self, stage: Stage) -> FloatArray:
        motions = [stage.tool_motion.get(t.name, ToolMotion()) for t in self._tools]
        moves = [(*m.move[: self._dimension], m.turn) for m in motions]
        return np.array(moves, dtype=np.float64).reshape(-1, self._dimension + 1)

    def pushed(self, stage: int) -> list[int]:
        """Return the numbers of the tools that a force pushes in a stage."""
        motions = self._stages[stage].tool_motion
        return [t for t, tool in enumerate(self._tools) if motions.get(tool.name, ToolMotion()).push is not None]

    def place(
        self,
        placed_n: ToolArrays | SpaceToolArrays,
        placed: ToolArrays | SpaceToolArrays,
        stage: int,
        fraction: float,
        ratio: float,
    ) -> None:
        """Move the tools by their strokes to a fraction of a stage; those that float go on, `ratio` as far."""
        pose = self.base(stage) + fraction * self._motion(self._stages[stage])
        floats = (placed.gives > 0) | np.isin(np.arange(len(pose)), self.pushed(stage))
        placed.travel += ratio * placed_n.travel_increment * floats[:, None]
        placed.displacement, placed.angle = pose[:, :-1] + placed.restart + placed.travel, pose[:, -1]

    def find_jumps(
        self, placed: ToolArrays | SpaceToolArrays, stage: int, find_travel: Callable[[int, ToolMotion], FloatArray]
    ) -> list[tuple[int, FloatArray]]:
        """Return each tool that a stage puts elsewhere when it begins, and its displacement there (d,) [mm].

        find_travel: returns the travel (d,) [mm] of a tool with a motion until it touches the workpiece.
        """
        jumps = []
        for t, tool in enumerate(self._tools):
            motion = self._stages[stage].tool_motion.get(tool.name, ToolMotion())
            if motion.start is None:
                continue
            if isinstance(motion.start, str):
                target = placed.displacement[t] + find_travel(t, motion)
            else:
                target = np.subtract(motion.start, tool.position[: self._dimension])
            if motion.start != "touch_again":
                placed.placed[t] = target
            if (target != placed.displacement[t]).any():
                jumps.append((t, target))
        return jumps

    @staticmethod
    def jump(placed: ToolArrays | SpaceToolArrays, t: int, target: FloatArray) -> None:
        """Put a tool elsewhere; target: its displacement there (d,) [mm]."""
        placed.restart[t] += target - placed.displacement[t]
        placed.displacement[t] = target

    def stop(self, placed: ToolArrays | SpaceToolArrays, stage: int, fraction: float) -> None:
        """Let the tools rest where they are at a fraction of a stage's travel: later stages count from its end."""
        left = (1.0 - fraction) * self._motion(self._stages[stage])
        placed.restart -= left[:, :-1]
        placed.displacement = self.base(stage + 1)[:, :-1] + placed.restart + placed.travel


def find_turning(tools: Iterable[Tool], stages: Iterable[Stage]) -> list[str]:
    """Return the names of the tools that some stage turns."""
    motions = [stage.tool_motion for stage in stages]
    return [t.name for t in tools if any(of_stage.get(t.name, ToolMotion()).turn for of_stage in motions)]
