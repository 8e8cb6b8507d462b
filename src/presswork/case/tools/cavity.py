# SPDX-License-Identifier: Apache-2.0
"""Whether tools of solids leave the workpiece the room that its volume needs: they may cross, or close a die too far.

The space that the workpiece can flow through is flooded on a grid, from where the workpiece lies to the tools, to the
planes that hold it, and to the edge of the grid. A flood that reaches the edge has room for any volume; another must be
as large as the workpiece. Tools are taken smaller by most of a cell, so gaps that the grid does not resolve are open:
what is refused here is certain, and what is not may still close the die in the run.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from presswork import _core
from presswork.case.errors import Problem
from presswork.geometry.polygon import contains
from presswork.geometry.pose import start_profile
from presswork.model import BoolArray, FloatArray, Model, Stage, Tool, ToolMotion

CELLS = 160
"""Of the grid along its longer side."""
MARGIN = 0.5
"""Of the workpiece's size, by which the grid reaches beyond it: what flows farther has found a way out."""
SHRUNK = 0.75
"""Part of a cell by which tools are taken smaller."""
SAMPLES = 6
"""Places along each stage."""
SLACK = 0.02
"""Part of the volume that may be missing: the error of the grid."""
HALVINGS = 12
"""Of the way in which the stroke is looked for at which tools close."""


def check_cavity(model: Model) -> list[Problem]:
    """Return a problem for the first stage in which tools whose way is known leave too little room, if any does."""
    tools = [tool for tool in model.tools if _has_known_way(tool, model.stages)]
    moves = [{tool.name: np.array(_motion(stage, tool).move[:2]) for tool in tools} for stage in model.stages]
    if not any(move.any() for stage in moves for move in stage.values()):
        return []
    cavity = _Cavity(model, tools)
    if not cavity.volume:
        return []  # the workpiece is too thin for the grid
    at = {tool.name: np.zeros(2) for tool in tools}
    if cavity.part_of_volume(at) < 1.0 - SLACK:
        return []  # the workpiece starts in a tool, which contact sees
    for index, move in enumerate(moves):

        def is_closed(part: float, at: Mapping[str, FloatArray] = at, move: Mapping[str, FloatArray] = move) -> bool:
            return cavity.part_of_volume({name: at[name] + part * move[name] for name in at}) < 1.0 - SLACK

        parts = np.linspace(0.0, 1.0, SAMPLES + 1) if any(way.any() for way in move.values()) else np.zeros(1)
        closed = next((i for i in range(1, len(parts)) if is_closed(float(parts[i]))), None)
        if closed is not None:
            part = _find_first(is_closed, float(parts[closed - 1]), float(parts[closed]))
            left = cavity.part_of_volume({name: at[name] + move[name] for name in at})
            return [_explain(index, model.stages[index], move, part, left)]
        at = {name: at[name] + move[name] for name in at}
    return []


def _explain(index: int, stage: Stage, move: Mapping[str, FloatArray], part: float, left: float) -> Problem:
    mover = max(move, key=lambda name: float(np.linalg.norm(move[name])))
    way = float(np.linalg.norm(move[mover]))
    room = "no room" if left == 0.0 else f"room for {100.0 * left:.3g} % of the workpiece"
    return Problem(
        f"stages.{index}.tools.{mover}",
        f"after about {part * way:.3g} of its {way:.4g} mm the tools close on the workpiece: at the end of the stage "
        f'"{stage.name}" they leave {room}',
        "shorten the stroke, make the workpiece smaller, or open the die; limits.stop = false lets it run all the same",
    )


def _find_first(is_closed: Callable[[float], bool], low: float, high: float) -> float:
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if is_closed(middle) else (middle, high)
    return high


def _motion(stage: Stage, tool: Tool) -> ToolMotion:
    return stage.tool_motion.get(tool.name, ToolMotion())


def _has_known_way(tool: Tool, stages: Sequence[Stage]) -> bool:
    """Say whether neither forces nor springs place the tool, it does not turn, and no stage places it anew."""
    motions = [_motion(stage, tool) for stage in stages]
    return tool.spring is None and all(
        motion.push is None and motion.turn == 0.0 and motion.start is None for motion in motions
    )


class _Cavity:
    """The space between tools, on a grid."""

    def __init__(self, model: Model, tools: Sequence[Tool]) -> None:
        self._tools = tools
        points = model.mesh.points
        low, high = points.min(axis=0), points.max(axis=0)
        low, high = low - MARGIN * (high - low), high + MARGIN * (high - low)
        self._cell = float((high - low).max()) / CELLS
        x, y = (np.arange(a + 0.5 * self._cell, b, self._cell) for a, b in zip(low, high, strict=True))
        self._places = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
        axisymmetric = model.analysis == "axisymmetric"
        self._weight = np.abs(self._places[..., 0]) if axisymmetric else np.ones(self._places.shape[:2])
        self._open = ~self._find_walls(model, axisymmetric=axisymmetric)
        flat = self._places.reshape(-1, 2)
        self._workpiece = contains(points[model.mesh.boundary_edges[:, :2]], flat).reshape(self._weight.shape)
        self.volume = float(self._weight[self._workpiece].sum())
        """That of the workpiece in cells, weighted by the radius in axisymmetry; zero where no cell lies inside."""

    def _find_walls(self, model: Model, *, axisymmetric: bool) -> BoolArray:
        """Mark what lies behind the axis, and behind straight sides that supports hold."""
        walls = np.zeros(self._places.shape[:2], dtype=bool)
        if axisymmetric:
            walls |= self._places[..., 0] < 0.0
        points = model.mesh.points
        driven = {(p.node_set, p.component) for stage in model.stages for p in stage.prescribed}
        tolerance = 1e-6 * float(np.ptp(points, axis=0).max())
        for support in model.lasting_supports:
            for axis in (0, 1):
                at = points[model.mesh.node_sets[support.node_set], axis]
                if not support.fix[axis] or (support.node_set, axis) in driven or len(at) < 2 or np.ptp(at) > tolerance:
                    continue
                beyond = self._places[..., axis] - at[0]
                if points[:, axis].min() > at[0] - tolerance:
                    walls |= beyond < -SHRUNK * self._cell
                elif points[:, axis].max() < at[0] + tolerance:
                    walls |= beyond > SHRUNK * self._cell
        return walls

    def part_of_volume(self, displacement: Mapping[str, FloatArray]) -> float:
        """Return the room that the displaced tools leave, over the workpiece's volume; infinite where it is open."""
        free, filled = self._open.copy(), np.ones(self._weight.shape)
        for tool in self._tools:
            local = np.ascontiguousarray((self._places - displacement[tool.name]).reshape(-1, 2))
            gap, _, other_face, *_ = _core.touch_profile(start_profile(tool), local)
            cells = np.minimum(gap, other_face).reshape(free.shape) / self._cell
            free &= cells > -SHRUNK
            filled = np.minimum(filled, np.clip(0.5 + cells, 0.0, 1.0))
        flooded = _flood(free, self._workpiece & free)
        edges = (flooded[0], flooded[-1], flooded[:, 0], flooded[:, -1])
        if any(edge.any() for edge in edges):
            return float("inf")
        return float((self._weight * filled)[flooded].sum()) / self.volume


def _flood(free: BoolArray, start: BoolArray) -> BoolArray:
    """Return the free cells (n, m) that a way over the sides of free cells joins to those of the start.

    The flood runs along whole rows and columns of free cells in turn, until none is added.
    """
    runs = [_number_runs(free), _number_runs(free.T).T]
    flooded, count = start, -1
    while count != (count := int(np.count_nonzero(flooded))):
        for run in runs:
            reached = np.zeros(run.max() + 1, dtype=bool)
            reached[run[flooded]] = True
            flooded = reached[run] & free
    return flooded


def _number_runs(free: BoolArray) -> NDArray[np.int64]:
    """Return the number of the run of free cells that each free cell of a row belongs to (n, m)."""
    closed = np.pad(~free, ((0, 0), (1, 0)), constant_values=True)
    return np.cumsum(closed, dtype=np.int64).reshape(closed.shape)[:, 1:]
