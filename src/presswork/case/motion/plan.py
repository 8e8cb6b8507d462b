# SPDX-License-Identifier: Apache-2.0
"""How the tools of a case move before anything is computed: through the strokes of all stages and operations.

The workpiece stays as it starts. A tool that a force or a spring places stands; one that comes to a touch in a later
stage is placed as if the workpiece were shorter by what tools have pressed it before. Tools of later operations of a
press line, which come to the part, stand as for a level sheet.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from presswork.case.errors import Problem
from presswork.case.motion.clashes import Clash, Meeting
from presswork.geometry.blocked_motion import look_at
from presswork.geometry.pose import find_axis, start_profile
from presswork.geometry.segments import find_touch
from presswork.geometry.touch_in_space import find_touch_in_space
from presswork.model import FloatArray, Model, Profile, Stage, Tool, ToolMotion, find_direction

MOST = 160
"""Moments, at most."""
FINEST, COARSEST = 20, 4
"""Moments of a stage in which tools move, at most and at least."""
SAME = 0.99
"""Cosine from which on two directions are one."""


@dataclass(frozen=True)
class Moment:
    """Where tools stand."""

    label: str
    time: float
    """Number of the stage and what is done of it."""
    poses: Mapping[str, FloatArray]
    """Displacement since the start (d,) [mm], then turn [rad], in space a vector, of each tool at work."""
    clash: Clash | None = None

    def to_data(self, names: Sequence[str], dimension: int) -> dict[str, Any]:
        """Return it as the page takes it; names: of all tools in the order of the page."""
        none = [None] * (3 if dimension == 2 else 6)
        tools = [[float(value) for value in self.poses[name]] if name in self.poses else none for name in names]
        clash = {"names": list(self.clash.names), "text": self.clash.text} if self.clash else None
        return {"label": self.label, "time": self.time, "tools": tools, "clash": clash}


def plan_motion(model: Model, points: Mapping[str, FloatArray]) -> list[Moment]:
    """Return the moments that the tools pass through, the start first; one where no tool moves.

    points: of the tools in space where they start (n, 3) [mm], by name.
    """
    operations = [model.of_operation(number) for number in range(len(model.operations))]
    moving = sum(any(map(_is_going, stage.tool_motion.values())) for each in operations for stage in each.stages)
    count = int(np.clip(MOST // max(moving, 1), COARSEST, FINEST))
    moments: list[Moment] = []
    for operation in operations:
        moments += _follow(operation, points, count, float(len(moments)), is_line=len(operations) > 1)
    return moments


def mark_ends(moments: Sequence[Moment], problems: Sequence[Problem]) -> list[Moment]:
    """Return the moments with the problems of tools in a stage marked where that stage ends."""
    marks = {}
    for problem in problems:
        if match := re.fullmatch(r"stages\.(\d+)\.tools\.(\w+)(\..*)?", problem.key):
            marks[float(match[1]) + 1.0] = Clash((match[2],), problem.expected)
    return [replace(each, clash=marks[each.time]) if each.time in marks else each for each in moments]


def _follow(
    model: Model, points: Mapping[str, FloatArray], count: int, before: float, *, is_line: bool
) -> Iterator[Moment]:
    """Yield the moments of an operation; before: time at its beginning."""
    at = {tool.name: _Place(np.zeros(model.dimension), 0.0) for tool in model.tools}
    is_first = before == 0.0  # heights of tools that come to the part of an earlier operation are not known
    meeting, pressed = Meeting(model, points), _Pressed(model.dimension)
    operation = f"{model.operation}: " if is_line else ""
    yield Moment(f"{operation}start", before, _to_poses(model, at))
    for number, stage in enumerate(model.stages):
        name = f"{operation}{stage.name.removeprefix(f'{model.operation}_') if is_line else stage.name}"
        for tool in model.tools:
            motion = stage.tool_motion.get(tool.name)
            if motion is not None and motion.start is not None:
                at[tool.name] = _Place(_find_start(model, tool, motion, pressed), 0.0)
        is_going = any(map(_is_going, stage.tool_motion.values()))
        if is_first:
            meeting.begin(at, stage)
        for part in np.linspace(0.0, 1.0, count + 1)[1:] if is_going else (1.0,):
            now = {key: place.after(stage.tool_motion.get(key), float(part)) for key, place in at.items()}
            clash = meeting.look(now, stage) if is_going and is_first else None
            label = f"{name}{_describe_stroke(model, stage, float(part))}"
            yield Moment(label, before + number + float(part), _to_poses(model, now), clash)
        at = {key: place.after(stage.tool_motion.get(key), 1.0) for key, place in at.items()}
        pressed.note(stage)


def _is_going(motion: ToolMotion) -> bool:
    return any(motion.move) or motion.turn != 0.0


def _describe_stroke(model: Model, stage: Stage, part: float) -> str:
    """Return the stroke of what moves farthest, or its turn."""
    found = [(float(np.linalg.norm(m.move[: model.dimension])), name) for name, m in stage.tool_motion.items()]
    stroke, name = max(found, default=(0.0, ""))
    if stroke > 0.0:
        return f", {name} {part * stroke:.4g} of {stroke:.4g} mm"
    turn, name = max(((abs(m.turn), name) for name, m in stage.tool_motion.items()), default=(0.0, ""))
    return f", {name} {np.degrees(part * turn):.4g} of {np.degrees(turn):.4g}°" if turn > 0.0 else ""


@dataclass(frozen=True)
class _Place:
    """Where a tool stands: displacement since the start (d,) [mm] and turn [rad]."""

    moved: FloatArray
    turned: float

    def after(self, motion: ToolMotion | None, part: float) -> _Place:
        """Return where it stands after a part of a motion."""
        if motion is None:
            return self
        return _Place(self.moved + part * np.array(motion.move[: len(self.moved)]), self.turned + part * motion.turn)


def _to_poses(model: Model, at: Mapping[str, _Place]) -> dict[str, FloatArray]:
    turns = {tool.name: [1.0] if model.dimension == 2 else find_axis(tool) for tool in model.tools}
    return {name: np.append(place.moved, place.turned * np.array(turns[name])) for name, place in at.items()}


class _Pressed:
    """Strokes of tools that have pressed the workpiece, by direction."""

    def __init__(self, dimension: int) -> None:
        self._moves: list[FloatArray] = []
        self._dimension = dimension

    def note(self, stage: Stage) -> None:
        """Take up the strokes of a stage."""
        self._moves += [np.array(m.move[: self._dimension]) for m in stage.tool_motion.values() if any(m.move)]

    def along(self, direction: FloatArray) -> float:
        """Return the sum of the strokes along a direction [mm]."""
        strokes = [float(move @ direction) for move in self._moves]
        return sum(s for s, move in zip(strokes, self._moves, strict=True) if s > SAME * float(np.linalg.norm(move)))


def _find_start(model: Model, tool: Tool, motion: ToolMotion, pressed: _Pressed) -> FloatArray:
    """Return how far a tool is from its start when a stage begins that places it (d,) [mm]."""
    d = model.dimension
    if not isinstance(motion.start, str):
        assert motion.start is not None
        return np.asarray(np.array(motion.start[:d]) - np.array(tool.position[:d]))
    if not motion.moves or (motion.push is None and not any(motion.move)):
        return np.zeros(d)
    direction, nodes = find_direction(motion, d), model.mesh.points
    if isinstance(tool.shape, Profile):
        travel = find_touch(nodes, start_profile(tool), direction)
    else:
        travel = find_touch_in_space(look_at(tool), nodes, direction)
    placed: FloatArray = ((travel or 0.0) + pressed.along(direction)) * direction
    return placed
