# SPDX-License-Identifier: Apache-2.0
"""Force against stroke, operation by operation, of a run whose stages place tools anew."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from presswork.model import BoolArray, IntArray
from presswork.results import Result
from presswork.view.history_marks import mark_peak
from presswork.view.style import begin_at_zero, clean_axes, new_figure, require_matplotlib
from presswork.view.tool_course import count_operations

if TYPE_CHECKING:
    from matplotlib.axes import Axes

HARDLY = 0.1
"""Part of the stroke of the tool that moves farthest below which another hardly moves."""


@dataclass(frozen=True)
class Operation:
    """The rows of the history from one placing of tools to the next."""

    name: str
    """Name of the operation in a line of them, else of its first stage in which a tool is loaded."""
    rows: IntArray
    """Rows up to the last one in which a tool is loaded (n,)."""
    tools: tuple[str, ...]
    """Tools that move and are loaded."""

    @property
    def file_name(self) -> str:
        """The name in letters, digits and underscores."""
        return re.sub(r"\W+", "_", self.name).strip("_")


def list_operations(result: Result) -> list[Operation]:
    """Return the operations in which tools are loaded; none of a run with fewer than two."""
    found = find_operations(result)
    return found if len(found) > 1 else []


def find_operations(result: Result) -> list[Operation]:
    """Return the operations in which tools are loaded."""
    history = result.history
    number, stages = count_operations(result), np.asarray(history["stage"])
    names = [name.removesuffix(".stroke") for name in history if name.endswith(".stroke")]
    found = []
    for own in (np.flatnonzero(number == n) for n in np.unique(number)):
        tools = tuple(
            name
            for name in names
            if np.any(history[f"{name}.force"][own]) and np.ptp(np.append(0.0, history[f"{name}.stroke"][own])) > 0
        )
        if not tools:
            continue
        loaded = np.any([history[f"{name}.force"][own] != 0.0 for name in tools], axis=0)
        rows = own[: np.flatnonzero(loaded)[-1] + 1]
        found.append(Operation(_name_operation(result, str(stages[own[loaded][0]])), rows.astype(np.int32), tools))
    return found


def _name_operation(result: Result, stage: str) -> str:
    """Return the operation of a line that a stage belongs to, whose name its own begins with; else the stage."""
    line = str(result.info.get("operations", "")).split("\n")
    return max((name for name in line if name and stage.startswith(f"{name}_")), key=len, default=stage)


def choose_strokes(result: Result, operation: Operation) -> dict[str, str]:
    """Return over whose stroke the force of each tool of an operation is drawn.

    Its own, or that of the tool of a stamping that moves farthest where it hardly moves, as a holder does.
    """
    history, rows = result.history, operation.rows
    far = {tool: float(np.ptp(np.append(0.0, history[f"{tool}.stroke"][rows]))) for tool in operation.tools}
    main = max(far, key=lambda tool: far[tool])
    return {tool: main if result.is_stamping and stroke < HARDLY * far[main] else tool for tool, stroke in far.items()}


def find_idle(result: Result, tool: str) -> BoolArray:
    """Mark rows of the history (n_rows,) of no operation of a tool, and those in which it is lifted off."""
    operations, history = list_operations(result), result.history
    idle = np.full(len(history["time"]), bool(operations))
    for operation in operations:
        if tool in operation.tools:
            idle[operation.rows] = False
    idle = idle if not idle.all() else ~idle
    if f"{tool}.stroke" not in history or f"{tool}.force" not in history:
        return idle
    goes_back = np.diff(history[f"{tool}.stroke"], prepend=0.0) < 0.0
    return np.asarray(idle | (goes_back & (history[f"{tool}.force"] == 0.0)))


def plot_operation(result: Result, operation: Operation, ax: Axes | None = None) -> Axes:
    """Draw force [kN] against stroke [mm] since the tools were placed, with the largest force marked."""
    require_matplotlib()
    ax = new_figure(6.4, 4.2).subplots() if ax is None else ax
    history, rows = result.history, operation.rows
    peaks, over = [], choose_strokes(result, operation)
    for tool in operation.tools:
        stroke, force = history[f"{over[tool]}.stroke"][rows], 1e-3 * history[f"{tool}.force"][rows]
        ax.plot(stroke, force, label=tool, linewidth=1.8)
        top = int(np.argmax(np.abs(force)))
        peaks.append((float(stroke[top]), float(force[top])))
    for x, y in peaks:
        mark_peak(ax, x, y)
    only = f"{operation.tools[0]} " if len(operation.tools) == 1 else ""
    ax.set_xlabel(f"{over[operation.tools[0]]} stroke [mm]" if len(set(over.values())) == 1 else "stroke [mm]")
    ax.set_ylabel(f"{only}force [kN]")
    ax.set_title(f"{result.info.get('title', '')}: {operation.name}", fontsize="medium")
    if len(operation.tools) > 1:
        ax.legend(frameon=False)
    begin_at_zero(ax)
    clean_axes(ax)
    return ax
