# SPDX-License-Identifier: Apache-2.0
"""Tools that turn and take nothing along: a roll that does not bite."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.model import FloatArray, Model
from presswork.observe.contract import History, Measure, Observed, Observer

STANDS_STILL = 0.01
"""Path of nodes below which a roll has slipped, over its angle times the least extent of the workpiece."""


class SlippingRolls(Observer):
    """How far the workpiece moves in the stages in which a tool turns."""

    def __init__(self, model: Model) -> None:
        self.turns = [[n for n, motion in stage.tool_motion.items() if motion.turn] for stage in model.stages]
        self.path: FloatArray = np.zeros(len(model.stages))
        """Sum of the longest steps of a node in each stage [mm]."""
        self._before: tuple[int, FloatArray] | None = None
        """Mesh and places of its nodes after the increment before."""

    def measures(self, run: Observed) -> list[Measure]:
        """Add up the path; it measures nothing of a limit."""
        if any(self.turns):
            now = run.positions()
            if self._before is not None and self._before[0] == run.epoch:
                self.path[run.current_stage()] += np.linalg.norm(now - self._before[1], axis=1).max()
            self._before = run.epoch, now.copy()
        return []

    def warnings(self, run: Observed, history: History) -> list[str]:
        """Return the tools that have turned in a stage in which the workpiece stood still."""
        least = float(np.ptp(run.model.mesh.points, axis=0).min())
        found = []
        for stage, tools, path in zip(run.model.stages, self.turns, self.path, strict=True):
            for tool in tools:
                rows = np.flatnonzero(np.asarray(history["stage"]) == stage.name)
                angle = np.append(history.get(f"{tool}.angle", np.zeros(len(history["stage"]))), 0.0)
                turned = abs(angle[rows[-1]] - angle[rows[0] - 1]) if len(rows) else 0.0  # from the row before on
                if path < STANDS_STILL * np.radians(turned) * least:
                    found.append(
                        f"the tool {tool} turned by {turned:.3g} degrees in the stage '{stage.name}', and the "
                        "workpiece stood still: its friction takes nothing along; give it more friction, make the "
                        "reduction smaller, or push the workpiece further in"
                    )
        return found

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the paths of stages with a tool that turns."""
        return {"path_under_rolls": self.path} if any(self.turns) else {}

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up the paths."""
        self.path = np.array(arrays.get("path_under_rolls", self.path))
