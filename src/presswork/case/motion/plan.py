# SPDX-License-Identifier: Apache-2.0
"""How the tools of a case move before anything is computed: through the strokes of all stages and operations.

The workpiece stays as it starts. A tool that a force or a spring places goes with the tools that it meets
(followers.py); one that comes to a touch in a later stage is placed as if the workpiece were shorter by what tools have
pressed it before. Tools of later operations of a press line, which come to the part, stand on the part that is
estimated from the tools before, if the caller has one, else as for a level sheet.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from presswork.case.errors import Problem
from presswork.case.motion.clashes import MOST_POINTS, Clash, Meeting, Place
from presswork.case.motion.followers import Followers
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
    ends: tuple[int, int] | None = None
    """Operation and stage that end with it."""

    def to_data(self, names: Sequence[str], dimension: int) -> dict[str, Any]:
        """Return it as the page takes it; names: of all tools in the order of the page."""
        none = [None] * (3 if dimension == 2 else 6)
        tools = [[float(value) for value in self.poses[name]] if name in self.poses else none for name in names]
        clash = {"names": list(self.clash.names), "text": self.clash.text} if self.clash else None
        return {"label": self.label, "time": self.time, "tools": tools, "clash": clash}


class Part(Protocol):
    """The part of a press line, as tools leave it."""

    def lay(self, number: int) -> tuple[Model, Mapping[str, FloatArray]]:
        """Return an operation after the first, strokes of tools that close known, and how far its tools are from where
        they are drawn (3,) [mm], by name; without tools that do not come to the part.
        """

    def form(self, operation: Model, at: Mapping[str, Place]) -> None:
        """Take the shape that tools leave where they are."""


def plan_motion(model: Model, points: Mapping[str, FloatArray], part: Part | None = None) -> list[Moment]:
    """Return the moments that the tools pass through, the start first; one where no tool moves.

    points: of the tools in space where they start (n, 3) [mm], by name.
    """
    operations = [model.of_operation(number) for number in range(len(model.operations))]
    moving = sum(any(map(_is_going, stage.tool_motion.values())) for each in operations for stage in each.stages)
    count = int(np.clip(MOST // max(moving, 1), COARSEST, FINEST))
    moments: list[Moment] = []
    for number, operation in enumerate(operations):
        moments += _follow(operation, points, count, number, float(len(moments)), part if len(operations) > 1 else None)
    return moments


def mark_ends(moments: Sequence[Moment], problems: Sequence[Problem]) -> list[Moment]:
    """Return the moments with the problems of tools in a stage marked where that stage ends."""
    marks = {}
    for problem in problems:
        if match := re.fullmatch(r"(?:operations\.(\d+)\.)?stages\.(\d+)\.tools\.(\w+)(\..*)?", problem.key):
            operation, stage, tool, _ = match.groups()
            marks[int(operation or 0), int(stage)] = Clash((tool,), problem.expected)
    marked = ((each, marks.get(each.ends) if each.ends else None) for each in moments)
    return [replace(each, clash=_name_clash(clash, each)) if clash else each for each, clash in marked]


def _name_clash(clash: Clash, moment: Moment) -> Clash:
    """Return a clash with the names that the tools have in an operation of a line."""
    names = (next((n for n in moment.poses if n == name or n.endswith(f"_{name}")), name) for name in clash.names)
    return replace(clash, names=tuple(names))


def _follow(
    model: Model, points: Mapping[str, FloatArray], count: int, number: int, before: float, part: Part | None
) -> Iterator[Moment]:
    """Yield the moments of an operation; number: of the operation; before: time at its beginning."""
    at = {tool.name: _Place(np.zeros(model.dimension), 0.0) for tool in model.tools}
    is_line, is_known = model.following or number > 0 or part is not None, number == 0
    if number > 0 and part is not None:
        model, starts = part.lay(number)
        at |= {name: _Place(moved, 0.0) for name, moved in starts.items()}
        is_known = len(starts) == len(at)  # else heights of tools that come to the part are not
    slack = model.thickest if number > 0 else 0.0
    meeting, followers, pressed = (
        Meeting(model, points, slack), Followers(model, points, MOST_POINTS), _Pressed(model.dimension)
    )  # fmt: skip
    operation = f"{model.operation}: " if is_line else ""
    yield Moment(f"{operation}start", before, _to_poses(model, at))
    for index, stage in enumerate(model.stages):
        name = f"{operation}{stage.name.removeprefix(f'{model.operation}_') if is_line else stage.name}"
        for tool in model.tools:
            motion = stage.tool_motion.get(tool.name)
            if motion is not None and motion.start is not None:
                at[tool.name] = _Place(_find_start(model, tool, motion, pressed), 0.0)
        is_going = any(map(_is_going, stage.tool_motion.values()))
        followers.begin(at, stage)
        if is_known:
            meeting.begin(at, stage)
        now = at
        for share in np.linspace(0.0, 1.0, count + 1)[1:] if is_going else (1.0,):
            now = {key: place.after(stage.tool_motion.get(key), float(share)) for key, place in at.items()}
            now |= {key: now[key].shift(travel) for key, travel in followers.place(now).items()}
            clash = meeting.look(now, stage) if is_going and is_known else None
            ends = (number, index) if share == 1.0 else None
            label = f"{name}{_describe_stroke(model, stage, float(share))}"
            yield Moment(label, before + index + float(share), _to_poses(model, now), clash, ends)
        pushed = {key for key, motion in stage.tool_motion.items() if motion.push is not None}
        at = {k: now[k] if k in pushed else place.after(stage.tool_motion.get(k), 1.0) for k, place in at.items()}
        pressed.note(stage)
        if part is not None:
            part.form(model, now)


def _is_going(motion: ToolMotion) -> bool:
    return any(motion.move) or motion.turn != 0.0


def _describe_stroke(model: Model, stage: Stage, part: float) -> str:
    """Return the stroke of what moves farthest, or its turn."""
    found = [(float(np.linalg.norm(m.move[: model.dimension])), name) for name, m in stage.tool_motion.items()]
    stroke, name = max(found, default=(0.0, ""))
    if stroke > 0.0:
        return f", {name} {part * stroke:.4g} of {stroke:.4g} mm"
    for name, motion in stage.tool_motion.items():
        if motion.push is not None:
            return f", {name} pushed with {motion.push.force[-1, 1] / 1e3:.4g} kN: how far it goes is computed"
    turn, name = max(((abs(m.turn), name) for name, m in stage.tool_motion.items()), default=(0.0, ""))
    return f", {name} {np.degrees(part * turn):.4g} of {np.degrees(turn):.4g}°" if turn > 0.0 else ""


@dataclass(frozen=True)
class _Place:
    """Where a tool stands: displacement since the start (d,) [mm] and turn [rad]."""

    moved: FloatArray
    turned: float

    def shift(self, travel: FloatArray) -> _Place:
        """Return where it stands if it is moved besides [mm]."""
        return _Place(self.moved + travel, self.turned)

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
