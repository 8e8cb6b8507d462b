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
from presswork.geometry.pose import find_space_pose, start_profile
from presswork.geometry.tool_surface import make_surface
from presswork.mesh.faces import split_faces
from presswork.model import BoolArray, FloatArray, Model, Profile, Stage, Tool, ToolMotion, Triangulation

CELLS, CELLS_IN_SPACE = 160, 40
"""Number of cells of the grid along its longest side, in the plane and in space."""
MARGIN = 0.5
"""How far the grid reaches beyond the workpiece, over its size: metal that flows farther has found an outlet."""
SHRUNK = 0.75
"""Part of a cell by which tools are taken smaller."""
SAMPLES = 6
"""Places along each stage."""
SLACK, SLACK_IN_SPACE = 0.02, 0.08
"""Part of the volume that may be missing: the error of the grid, in the plane and in space."""
HALVINGS = 12
"""Number of halvings of the travel in the search for the stroke at which tools close."""


def check_cavity(model: Model) -> list[Problem]:
    """Return a problem for the first stage in which tools whose path is known leave too little room, if any does."""
    if model.analysis in ("shell", "stamping") or (model.heat is not None and model.heat.alone):
        return []
    tools = [tool for tool in model.tools if _has_known_motion(tool, model.stages)]
    d, slack = model.dimension, SLACK if model.dimension == 2 else SLACK_IN_SPACE
    moves = [{tool.name: np.array(_motion(stage, tool).move[:d]) for tool in tools} for stage in model.stages]
    if not any(move.any() for stage in moves for move in stage.values()):
        return []
    cavity = _Cavity(model, tools)
    if not cavity.volume:
        return []  # the workpiece is too thin for the grid
    at = {tool.name: np.zeros(d) for tool in tools}
    if cavity.part_of_volume(at) < 1.0 - slack:
        return []  # the workpiece starts in a tool, which contact sees
    for index, move in enumerate(moves):

        def is_closed(part: float, at: Mapping[str, FloatArray] = at, move: Mapping[str, FloatArray] = move) -> bool:
            return cavity.part_of_volume({name: at[name] + part * move[name] for name in at}) < 1.0 - slack

        parts = np.linspace(0.0, 1.0, SAMPLES + 1) if any(each.any() for each in move.values()) else np.zeros(1)
        closed = next((i for i in range(1, len(parts)) if is_closed(float(parts[i]))), None)
        if closed is not None:
            part = _find_first(is_closed, float(parts[closed - 1]), float(parts[closed]))
            left = cavity.part_of_volume({name: at[name] + move[name] for name in at})
            return [_explain(index, model.stages[index], move, part, left)]
        at = {name: at[name] + move[name] for name in at}
    return []


def _explain(index: int, stage: Stage, move: Mapping[str, FloatArray], part: float, left: float) -> Problem:
    mover = max(move, key=lambda name: float(np.linalg.norm(move[name])))
    stroke = float(np.linalg.norm(move[mover]))
    room = "no room" if left == 0.0 else f"room for {100.0 * left:.3g} % of the workpiece"
    return Problem(
        f"stages.{index}.tools.{mover}",
        f"after about {part * stroke:.3g} of its {stroke:.4g} mm the tools close on the workpiece: when the stage "
        f'"{stage.name}" ends, they leave {room}',
        "shorten the stroke, make the workpiece smaller, or open the die; limits.stop = false runs it anyway",
    )


def _find_first(is_closed: Callable[[float], bool], low: float, high: float) -> float:
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if is_closed(middle) else (middle, high)
    return high


def _motion(stage: Stage, tool: Tool) -> ToolMotion:
    return stage.tool_motion.get(tool.name, ToolMotion())


def _has_known_motion(tool: Tool, stages: Sequence[Stage]) -> bool:
    """Return whether neither forces nor springs place the tool, it does not turn, and no stage places it anew."""
    motions = [_motion(stage, tool) for stage in stages]
    return tool.spring is None and all(
        motion.push is None and motion.turn == 0.0 and motion.start is None for motion in motions
    )


class _Cavity:
    """The space between tools, on a grid."""

    def __init__(self, model: Model, tools: Sequence[Tool]) -> None:
        self._look = {tool.name: _look_at(tool) for tool in tools}
        points = model.mesh.points
        low, high = points.min(axis=0), points.max(axis=0)
        low, high = low - MARGIN * (high - low), high + MARGIN * (high - low)
        self._cell = float((high - low).max()) / (CELLS if len(low) == 2 else CELLS_IN_SPACE)
        lines = [np.arange(a + 0.5 * self._cell, b, self._cell) for a, b in zip(low, high, strict=True)]
        self._places = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1)
        axisymmetric = model.analysis == "axisymmetric"
        self._weight = np.abs(self._places[..., 0]) if axisymmetric else np.ones(self._places.shape[:-1])
        self._filled = np.ones(self._weight.shape)
        self._open = ~self._find_walls(model, axisymmetric=axisymmetric)
        flat = np.ascontiguousarray(self._places.reshape(-1, len(low)))
        self._workpiece = _find_inside(model, flat).reshape(self._weight.shape)
        self.volume = float(self._weight[self._workpiece].sum())
        """Volume of the workpiece in cells, weighted by the radius in axisymmetry; zero where no cell lies inside."""

    def _find_walls(self, model: Model, *, axisymmetric: bool) -> BoolArray:
        """Mark what lies behind the axis, and behind straight sides that supports hold; cut cells count in part."""
        walls = np.zeros(self._weight.shape, dtype=bool)
        if axisymmetric:
            walls |= self._places[..., 0] < 0.0
        points = model.mesh.points
        driven = {(p.node_set, p.component) for stage in model.stages for p in stage.prescribed}
        tolerance = 1e-6 * float(np.ptp(points, axis=0).max())
        for support in model.lasting_supports:
            held = [np.eye(points.shape[1])[axis] for axis in range(points.shape[1]) if support.fix[axis]]
            for normal in held if support.normal is None else [np.array(support.normal)]:
                axis = int(np.argmax(np.abs(normal)))
                at = points[model.mesh.node_sets[support.node_set]] @ normal
                if (support.node_set, axis) in driven or len(at) < 2 or np.ptp(at) > tolerance:
                    continue
                beyond = self._places @ normal - at[0]
                if (points @ normal).max() < at[0] + tolerance:
                    beyond = -beyond
                elif (points @ normal).min() < at[0] - tolerance:
                    continue
                walls |= beyond < -SHRUNK * self._cell
                self._filled = np.minimum(self._filled, np.clip(0.5 + beyond / self._cell, 0.0, 1.0))
        return walls

    def part_of_volume(self, displacement: Mapping[str, FloatArray]) -> float:
        """Return the room that the displaced tools leave, over the workpiece's volume; infinite where it is open."""
        free, filled = self._open.copy(), self._filled
        for name, look in self._look.items():
            local = np.ascontiguousarray((self._places - displacement[name]).reshape(-1, self._places.shape[-1]))
            cells = look(local).reshape(free.shape) / self._cell
            free &= cells > -SHRUNK
            filled = np.minimum(filled, np.clip(0.5 + cells, 0.0, 1.0))
        flooded = _flood(free, self._workpiece & free)
        if any(np.take(flooded, end, axis=axis).any() for axis in range(flooded.ndim) for end in (0, -1)):
            return float("inf")
        return float((self._weight * filled)[flooded].sum()) / self.volume


def _look_at(tool: Tool) -> Callable[[FloatArray], FloatArray]:
    """Return what gives the gap of a tool where it starts at places (n, d) [mm], negative in its metal."""
    if isinstance(tool.shape, Profile):
        segments = start_profile(tool)

        def measure(places: FloatArray) -> FloatArray:
            gap, _, other_face, *_ = _core.touch_profile(segments, places)
            return np.minimum(gap, other_face)

        return measure
    surface, pose = make_surface(tool.surface), find_space_pose(tool, np.zeros(3))
    return lambda places: np.asarray(surface.nearest(np.ascontiguousarray(pose.to_frame(places)))[0])


def _find_inside(model: Model, places: FloatArray) -> BoolArray:
    """Mark the places (n, d) that lie in the workpiece."""
    mesh = model.mesh
    if model.dimension == 2:
        return np.asarray(contains(mesh.points[mesh.boundary_edges[:, :2]], places), dtype=bool)
    triangles = np.ascontiguousarray(split_faces(mesh.boundary_faces), dtype=np.int32)
    skin = make_surface(Triangulation(mesh.points, triangles, True))
    return np.asarray(skin.nearest(places)[0] < 0.0, dtype=bool)


def _flood(free: BoolArray, start: BoolArray) -> BoolArray:
    """Return the free cells that are joined to those of the start over sides of free cells, in any dimension.

    The flood runs along whole lines of free cells, one axis after the other, until none is added.
    """
    runs = [np.moveaxis(_number_runs(np.moveaxis(free, axis, -1)), -1, axis) for axis in range(free.ndim)]
    flooded, count = start, -1
    while count != (count := int(np.count_nonzero(flooded))):
        for run in runs:
            reached = np.zeros(run.max() + 1, dtype=bool)
            reached[run[flooded]] = True
            flooded = reached[run] & free
    return flooded


def _number_runs(free: BoolArray) -> NDArray[np.int64]:
    """Return the number of the run of free cells that each free cell of a line along the last axis belongs to."""
    pad = [(0, 0)] * (free.ndim - 1) + [(1, 0)]
    closed = np.pad(~free, pad, constant_values=True)
    return np.cumsum(closed, dtype=np.int64).reshape(closed.shape)[..., 1:]
