# SPDX-License-Identifier: Apache-2.0
"""Tools that turn and take nothing along: a roll that does not bite."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.geometry.pose import turn_about
from presswork.model import FloatArray, Model, Tool
from presswork.observe.contract import History, Measure, Observed, Observer

STANDS_STILL = 0.01
"""Least path of the workpiece where a roll does not slip, over the travel of the roll's surface."""


class SlippingRolls(Observer):
    """How far the workpiece moves in the stages in which a tool turns."""

    def __init__(self, model: Model) -> None:
        self.turns = [[n for n, motion in stage.tool_motion.items() if motion.turn] for stage in model.stages]
        self.path: FloatArray = np.zeros(len(model.stages))
        """How far the farthest node has moved in each stage, over the meshes of the stage [mm]."""
        self.reach: FloatArray = np.full(len(model.stages), np.inf)
        """Least radius on which a tool that turns meets the workpiece in each stage [mm]."""
        self._start: tuple[int, int, FloatArray] | None = None
        """Stage and mesh that the run is in, and places of the nodes as they began."""
        self._now: FloatArray = np.zeros(0)
        self._done: float = 0.0
        """Path in the stage on the meshes before [mm]."""

    def measures(self, run: Observed) -> list[Measure]:
        """Follow the path and the radii; it measures nothing of a limit."""
        if not any(self.turns):
            return []
        stage, now = run.current_stage(), run.positions().copy()
        if self._start is None or self._start[1] != run.epoch:
            self._done = self.path[stage]
            self._start = stage, run.epoch, now
        elif self._start[0] != stage:
            self._done = self.path[stage]
            self._start = stage, run.epoch, self._now
        self._now = now
        self.path[stage] = self._done + np.linalg.norm(now - self._start[2], axis=1).max()
        moved = run.tool_displacements()
        for tool in run.model.tools:
            if tool.name in self.turns[stage]:
                self.reach[stage] = min(self.reach[stage], _find_reach(tool, moved[tool.name], now))
        return []

    def warnings(self, run: Observed, history: History) -> list[str]:
        """Return the tools that have turned in a stage in which the workpiece stood still."""
        least = float(np.ptp(run.model.mesh.points, axis=0).min())
        found = []
        for number, (stage, tools) in enumerate(zip(run.model.stages, self.turns, strict=True)):
            for tool in tools:
                rows = np.flatnonzero(np.asarray(history["stage"]) == stage.name)
                angle = np.append(history.get(f"{tool}.angle", np.zeros(len(history["stage"]))), 0.0)
                turned = abs(angle[rows[-1]] - angle[rows[0] - 1]) if len(rows) else 0.0  # from the row before on
                presses = any(np.any(history[f"{tool}.{force}"][rows]) for force in _forces(history, tool))
                travel = np.radians(turned) * max(self.reach[number], least)
                if presses and self.path[number] < STANDS_STILL * travel:
                    found.append(
                        f"the tool {tool} turned by {turned:.3g} degrees in the stage '{stage.name}', and the "
                        "workpiece stood still: its friction takes nothing along; give it more friction, make the "
                        "reduction smaller, push the workpiece further in, or turn it the other way"
                    )
        return found

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the paths of stages with a tool that turns, and its radii."""
        return {"path_under_rolls": self.path, "reach_of_rolls": self.reach} if any(self.turns) else {}

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up the paths and the radii."""
        self.path = np.array(arrays.get("path_under_rolls", self.path))
        self.reach = np.array(arrays.get("reach_of_rolls", self.reach))


def _forces(history: History, tool: str) -> list[str]:
    """Return the components of its force among the columns."""
    return [name for name in ("force_x", "force_y", "force_z") if f"{tool}.{name}" in history]


def _find_reach(tool: Tool, moved: FloatArray, places: FloatArray) -> float:
    """Return the distance of the nearest node from the axis of a tool [mm]; moved: since the start (2 | 3)."""
    size = places.shape[1]
    centre, position = np.asarray(tool.centre), np.asarray(tool.position)
    if size == 2:
        return float(np.linalg.norm(places - position[:2] - centre[:2] - moved, axis=1).min())
    turn = turn_about(np.array(tool.rotation))
    away = places - position - turn @ centre - moved
    return float(np.linalg.norm(np.cross(away, turn @ tool.axis), axis=1).min())
