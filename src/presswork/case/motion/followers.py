# SPDX-License-Identifier: Apache-2.0
"""Tools that a force or a spring places, as far as their place follows from other tools alone.

A holder or pad on a sheet goes along its direction until the sheet's thickness is left to the tools ahead, and comes
back with them. A tool of solids stands where it starts, and is carried by tools that come upon it. How far a force
drives a tool into the workpiece is known only after the run.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from presswork.case.motion.clashes import Place
from presswork.case.motion.gaps import walk_profile
from presswork.geometry.blocked_motion import look_at
from presswork.geometry.touch_in_space import find_touch_in_space
from presswork.mesh.tool_clearance import Room, find_closing
from presswork.model import FloatArray, Model, Plane, Profile, Stage, Tool

PARALLEL = 1e-6
"""Part of a tool's stroke across a follower's direction beyond which how they meet is not looked for."""
WITHIN, STEP = 0.02, 0.5
"""Deviation of drawn tools, and their advance, over the sheet's thickness."""


@dataclass(frozen=True)
class _Follower:
    """A tool that others place in a stage."""

    name: str
    direction: FloatArray
    """Unit vector along which it presses (d,)."""
    farthest: float
    """How far it goes along the direction, if nothing is ahead [mm]."""
    ahead: tuple[tuple[str, float], ...]
    """Tools ahead, and how far it goes until it meets them where they are when the stage begins [mm]."""


class Followers:
    """The tools of an operation that others place."""

    def __init__(self, model: Model, points: Mapping[str, FloatArray], most_points: int) -> None:
        """points: of the tools in space where they start (n, 3) [mm], by name."""
        self._model = model
        self._tools = {tool.name: tool for tool in model.tools if not isinstance(tool.shape, Plane)}
        self._thickness = model.thickest if model.analysis == "stamping" else 0.0
        self._points = {
            name: walk_profile(tool) if isinstance(tool.shape, Profile) else thin_out(points.get(name), most_points)
            for name, tool in self._tools.items()
        }
        self._begun: list[_Follower] = []
        self._at: Mapping[str, Place] = {}

    def begin(self, at: Mapping[str, Place], stage: Stage) -> None:
        """Take up where tools are when a stage begins."""
        self._at = at
        followers = list(self._list_followers(stage))
        names = [name for name, _, _ in followers]
        self._begun = []
        for name, direction, farthest in followers:
            others = [
                other for other in self._tools if other not in names and self._goes_along(other, direction, stage)
            ]
            found = [(other, self._find_travel(name, other, direction)) for other in others]
            ahead = tuple((other, travel) for other, travel in found if travel is not None)
            self._begun.append(_Follower(name, direction, farthest if ahead else min(farthest, 0.0), ahead))

    def place(self, now: Mapping[str, Place]) -> dict[str, FloatArray]:
        """Return how far each is moved since the stage began (d,) [mm], with the other tools where they are now."""
        found = {}
        for each in self._begun:
            travels = [w + float((now[o].moved - self._at[o].moved) @ each.direction) for o, w in each.ahead]
            found[each.name] = min([each.farthest, *travels]) * each.direction
        return {name: travel for name, travel in found.items() if np.isfinite(travel).all()}

    def _list_followers(self, stage: Stage) -> Iterator[tuple[str, FloatArray, float]]:
        """Yield tools that a force or a spring places in a stage: name, direction, how far they go by themselves."""
        d, on_sheet = self._model.dimension, self._thickness > 0.0
        for name, tool in self._tools.items():
            motion = stage.tool_motion.get(name)
            if motion is not None and motion.push is not None:
                yield name, np.array(motion.push.direction[:d], dtype=float), math.inf if on_sheet else 0.0
            elif tool.spring is not None and not (motion is not None and motion.moves):
                yield name, -np.array(tool.spring.direction[:d], dtype=float), 0.0

    def _goes_along(self, name: str, direction: FloatArray, stage: Stage) -> bool:
        """Return whether a tool only moves along a direction, or stands."""
        motion = stage.tool_motion.get(name)
        if motion is None:
            return True
        move = np.array(motion.move[: len(direction)])
        across = move - (move @ direction) * direction
        return motion.turn == 0.0 and bool(
            np.linalg.norm(across) <= PARALLEL * max(float(np.linalg.norm(move)), 1e-300)
        )

    def _find_travel(self, name: str, other: str, direction: FloatArray) -> float | None:
        """Return how far a tool goes until it meets another one [mm], with the sheet between; None: never."""
        one, two = self._tools[name], self._tools[other]
        between = np.asarray(self._at[name].moved - self._at[other].moved)
        if self._thickness > 0.0:
            return self._find_closing(one, two, between, direction)
        first = find_touch_in_space(look_at(one), self._points[other] - between, direction)
        second = find_touch_in_space(look_at(two), self._points[name] + between, -direction)
        return min((travel for travel in (first, second) if travel is not None), default=None)

    def _find_closing(self, one: Tool, two: Tool, between: FloatArray, direction: FloatArray) -> float | None:
        """Return the travel after which a tool leaves the sheet's thickness to another one [mm]."""
        between = between + np.subtract(one.position, two.position)
        if float(np.dot(np.array(two.working_direction or direction), direction)) > -0.5:
            return None  # both on one side of the sheet
        t = self._thickness
        found = find_closing(one.surface, two.surface, between, direction, WITHIN * t, Room(t, 0.0), STEP * t)
        return None if found is None else found.travel


def thin_out(points: FloatArray | None, most: int) -> FloatArray:
    """Return points of a tool in space, some of them where there are many."""
    found = np.zeros((0, 3)) if points is None else points
    return found[:: max(len(found) // most, 1)]
