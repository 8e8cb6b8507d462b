# SPDX-License-Identifier: Apache-2.0
"""The part of a press line before anything is computed: a taut sheet over the tools of the operations so far.

Nodes keep their place in the plan; how they rise and fall is that of a membrane between the tools below and above.
Draw-in, trimming and springback are left out. It shows where tools of later operations come to the part, roughly: for a
drawing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from scipy.sparse import coo_matrix, diags
from scipy.sparse.linalg import spsolve

from presswork.case.motion.clashes import Place
from presswork.geometry.tool_surface import make_surface
from presswork.mesh.tool_clearance import sample_tool
from presswork.mesh.topology import list_cell_edges
from presswork.model import FloatArray, Model, Plane, Tool
from presswork.process.line.laying import LayingError, close_tools, find_turn, touch_part

HELD = 1e-6
"""How much a node is held where it was, over what its neighbours hold it."""
MOST_CHANGES = 30
"""Changes of which nodes lie on tools."""
MOST_STEPS = 200
UPRIGHT = 0.7
"""Vertical component of a tool's direction from which on it is below or above the sheet."""


class EstimatedPart:
    """The sheet of a line, where tools have left it."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self._points = np.array(model.mesh.points, dtype=float)
        self._half = 0.5 * model.thickest
        edges = np.unique(
            np.sort(np.concatenate([list_cell_edges(b.connectivity) for b in model.mesh.blocks]), axis=1), axis=0
        )
        n = len(self._points)
        beside = coo_matrix((np.ones(len(edges)), tuple(edges.T)), shape=(n, n)).tocsr()
        beside = beside + beside.T
        self._laplace = diags(np.asarray(beside.sum(axis=1)).ravel() + HELD) - beside

    def lay(self, number: int) -> tuple[Model, Mapping[str, FloatArray]]:
        """Lay the part into an operation, and bring its tools to it; see Part of case.motion.plan."""
        operation, alone = self._model.following[number - 1], self._model.of_operation(number)
        self._points = self._points @ find_turn(operation.place).T + np.asarray(operation.place.move)
        if operation.place.tips:
            self._sink([tool for tool in operation.tools if tool.kind == "die" and tool.name not in operation.laid])
        half, placed = np.full(len(self._points), self._half), dict[str, Tool]()
        try:
            for tool in operation.tools:
                is_laid = tool.name in operation.laid
                placed[tool.name] = touch_part(operation, tool, self._points, half) if is_laid else tool
            for name, (other, above) in operation.spaced.items():
                x, y, _ = placed[name].position
                placed[name] = replace(placed[name], position=(x, y, placed[other].position[2] + above))
            stages = close_tools(operation, list(placed.values()), self._model.thickest)
        except LayingError:
            return alone, {}
        drawn = {tool.name: np.asarray(tool.position) for tool in alone.tools}
        starts = {name: np.asarray(tool.position) - drawn[name] for name, tool in placed.items()}
        return replace(alone, stages=stages), starts

    def form(self, operation: Model, at: Mapping[str, Place]) -> None:
        """Draw the sheet taut between tools where they are."""
        low, high = np.full((2, len(self._points)), np.nan)
        for tool in operation.tools:
            if isinstance(tool.shape, Plane) or abs((tool.working_direction or (0.0, 0.0, 0.0))[2]) < UPRIGHT:
                continue
            heights = self._find_heights(tool, at[tool.name].moved)
            is_below = tool.working_direction is not None and tool.working_direction[2] > 0.0
            low, high = (np.fmax(low, heights), high) if is_below else (low, np.fmin(high, heights))
        tight = low > high  # between walls
        low[tight] = high[tight] = 0.5 * (low + high)[tight]
        self._points[:, 2] += self._draw_taut(low - self._points[:, 2], high - self._points[:, 2])

    def _sink(self, dies: list[Tool]) -> None:
        """Let the part sink along the press until it lies on a die."""
        gaps = [self._points[:, 2] - self._find_heights(die, np.zeros(3)) for die in dies]
        if gaps and np.isfinite(gaps).any():
            self._points[:, 2] -= float(np.nanmin(gaps))

    def _find_heights(self, tool: Tool, moved: FloatArray) -> FloatArray:
        """Return the height at which the middle of the sheet lies on a tool, at each node; nan beside it (n,) [mm]."""
        surface, corners = make_surface(tool.surface), sample_tool(tool.surface, self._half)
        place, side = np.asarray(tool.position) + moved, 1.0 if (tool.working_direction or (0, 0, -1))[2] > 0 else -1.0
        own = self._points - place
        begin, end = (float(f(side * corners[:, 2])) for f in (np.max, np.min))
        heights, found = np.full(len(own), begin + 2.0 * self._half), np.full(len(own), np.nan)
        waits = np.arange(len(own))
        for _ in range(MOST_STEPS):
            at = np.column_stack([own[waits, :2], side * heights[waits]])
            gap = surface.nearest(np.ascontiguousarray(at))[0] - self._half
            on = gap < 1e-3 * self._half
            found[waits[on]] = heights[waits[on]]
            heights[waits] -= np.maximum(gap, 1e-2 * self._half)
            waits = waits[~on & (heights[waits] > end - 2.0 * self._half)]
            if not len(waits):
                break
        return np.asarray(side * found + place[2])

    def _draw_taut(self, low: FloatArray, high: FloatArray) -> FloatArray:
        """Return how far each node moves (n,) [mm], at least and at most so far; nan: no tool is there."""
        low, high = np.nan_to_num(low, nan=-np.inf), np.nan_to_num(high, nan=np.inf)
        change, fixed = np.clip(np.zeros(len(low)), low, high), np.zeros(len(low), dtype=bool)
        for _ in range(MOST_CHANGES):
            pull = np.asarray(self._laplace @ change)  # down where positive
            kept = fixed & ((low == high) | ((change <= low) & (pull >= 0.0)) | ((change >= high) & (pull <= 0.0)))
            now = kept | (change < low) | (change > high) | (low == high)
            if (now == fixed).all() and fixed.any():
                break
            fixed = now
            change[fixed] = np.clip(change, low, high)[fixed]
            free = ~fixed
            if free.any():
                change[free] = spsolve(
                    self._laplace[free][:, free].tocsc(), -self._laplace[free][:, fixed] @ change[fixed]
                )
        return np.asarray(np.clip(change, low, high))
