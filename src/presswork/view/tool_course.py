# SPDX-License-Identifier: Apache-2.0
"""How far tools have come at the saved steps of a run, and which of them works there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.model import BoolArray, FloatArray, IntArray
from presswork.results import OutputError, Result


@dataclass(frozen=True)
class ToolCourse:
    """The tools of a run at all of its saved steps."""

    names: tuple[str, ...]
    at_work: BoolArray
    """Whether a tool belongs to the operation of a step (n_steps, n_tools)."""
    moved: FloatArray
    """Displacement of each tool since the step before (n_steps, n_tools) [mm]; its placing does not count."""
    strokes: FloatArray | None
    """Stroke since the tool was placed (n_steps, n_tools) [mm]; None of a run whose stages place no tools."""

    def find_working(self, step: int) -> str | None:
        """Return the tool that has moved most since the step before, or since the last one since which any has moved.

        At the first step it is the one that moves first. None if no tool moves in the whole run.
        """
        at = step % len(self.moved)
        moved = np.where(self.at_work[at], self.moved, 0.0)
        steps = np.flatnonzero((moved > 0.0).any(axis=1))
        if not len(steps):
            return None
        now = steps[steps <= at][-1] if steps[0] <= at else steps[0]
        return self.names[int(np.argmax(moved[now]))]

    def measure_stroke(self, tool: str, step: int) -> float | None:
        """Return the stroke of a tool since it was placed, without its sign [mm]; None where stages place no tools."""
        return None if self.strokes is None else abs(float(self.strokes[step, self.names.index(tool)]))


def find_course(result: Result) -> ToolCourse:
    """Return the course of a run's tools; while the results are kept open, it is found once."""
    return result.keep("course of tools", lambda: _find_course(result))


def _find_course(result: Result) -> ToolCourse:
    names = tuple(result.surfaces or result.tools)
    place = result.surface_displacement if result.surfaces else result.tool_displacement
    steps, dimension = len(result.times), 3 if result.surfaces else 2
    places = np.array([[place(name, step) for name in names] for step in range(steps)], dtype=np.float64)
    places = places.reshape(steps, len(names), dimension)
    moved = np.zeros((steps, len(names)))
    moved[1:] = np.nan_to_num(np.linalg.norm(np.diff(places, axis=0), axis=2))
    strokes = None
    if result.info.get("placing"):
        strokes, operation = _find_strokes(result, names)
        begins = np.diff(operation) != 0
        moved[1:] = np.abs(strokes[1:] - np.where(begins[:, None], 0.0, strokes[:-1]))
    return ToolCourse(names, np.asarray(np.isfinite(places).all(axis=2)), moved, strokes)


def _find_strokes(result: Result, names: tuple[str, ...]) -> tuple[FloatArray, IntArray]:
    """Return strokes (n_steps, n_tools) [mm] and the number of stages that have placed tools (n_steps,), by the rows
    of the history that are nearest in time; zero at the first step, and without a history.
    """
    strokes, operation = np.zeros((len(result.times), len(names))), np.zeros(len(result.times), dtype=np.int32)
    try:
        history = result.history
    except OutputError:
        return strokes, operation
    times = np.asarray(history["time"])
    if len(times):
        rows = [int(np.abs(times - time).argmin()) for time in result.times[1:]]
        operation[1:] = count_operations(result)[rows]
        for tool, name in enumerate(names):
            if f"{name}.stroke" in history:
                strokes[1:, tool] = history[f"{name}.stroke"][rows]
    return strokes, operation


def count_operations(result: Result) -> IntArray:
    """Return the number of stages that have placed tools by each row of the history (n_rows,)."""
    stages = np.asarray(result.history["stage"])
    begins = np.append(True, stages[1:] != stages[:-1])
    placing = str(result.info.get("placing", "")).split("\n")
    return np.cumsum(begins & np.isin(stages, placing)).astype(np.int32)
