# SPDX-License-Identifier: Apache-2.0
"""Where tools meet each other, or a symmetry plane, on the path that their stages give them."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from presswork.case.motion.gaps import measure_gap, walk_profile
from presswork.geometry.pose import find_axis, start_centre, start_centre_in_space, turn_about, turn_vectors
from presswork.model import FloatArray, Model, Plane, Profile, Stage, Tool

DEEP = 2e-3
"""How deep tools reach into each other before it counts, over the workpiece's size."""
REACH = 0.2
"""How deep in a tool its metal is looked for, over the workpiece's size."""
MOST_POINTS = 4000
"""Points of a tool in space that are looked at."""
FLAT = 1e-6
"""How far off a plane nodes may lie, over the workpiece's size."""


class Place(Protocol):
    """How far a tool has moved since the start (d,) [mm], and turned [rad]."""

    @property
    def moved(self) -> FloatArray: ...
    @property
    def turned(self) -> float: ...


@dataclass(frozen=True)
class Clash:
    """Tools that meet."""

    names: tuple[str, ...]
    text: str


@dataclass
class Meeting:
    """The tools of an operation, and how deep they have been in each other."""

    model: Model
    points: Mapping[str, FloatArray]
    """Points of the tools in space where they start (n, 3) [mm], by name."""
    slack: float = 0.0
    """How deep tools may be in each other besides [mm]: their heights are estimated."""
    _pairs: list[tuple[str, str]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._size = float(np.linalg.norm(np.ptp(self.model.mesh.points, axis=0)))
        self._tools = {t.name: t for t in self.model.tools if not isinstance(t.shape, Plane)}
        self._points = {name: self._find_points(tool) for name, tool in self._tools.items()}
        self._planes = find_planes(self.model)

    def _find_points(self, tool: Tool) -> FloatArray:
        if isinstance(tool.shape, Profile):
            return walk_profile(tool)
        found = self.points.get(tool.name, np.zeros((0, 3)))
        return found[:: max(len(found) // MOST_POINTS, 1)]

    def begin(self, at: Mapping[str, Place], stage: Stage) -> None:
        """Take up where tools stand when a stage begins: those that are drawn in each other then may stay so."""
        most = DEEP * self._size + self.slack
        self._pairs = [pair for pair in self._list_pairs(stage) if self._measure(pair, at) < most]

    def look(self, at: Mapping[str, Place], stage: Stage) -> Clash | None:
        """Return the tools that meet where they stand, if those that move in the stage do."""
        for pair in self._pairs:
            if self._measure(pair, at) > 2.0 * DEEP * self._size + self.slack:
                one, other = (name.replace("_", " ") for name in pair)
                return Clash(pair, f"{one} meets {other}{', on the estimated part' if self.slack else ''}")
        for name in self._list_moving(stage):
            if plane := self._pass_plane(name, at, np.array(stage.tool_motion[name].move)):
                return Clash((name,), f"{name} passes the symmetry plane {plane}: it meets its mirror image")
        return None

    def _list_moving(self, stage: Stage) -> list[str]:
        """Return the tools whose way in a stage is known; none where a hammer's energy ends it."""
        if stage.drive is not None and not stage.drive.is_prescribed:
            return []
        moves = stage.tool_motion.items()
        return [name for name, motion in moves if any(motion.move) and name in self._tools and not self._is_free(name)]

    def _list_pairs(self, stage: Stage) -> list[tuple[str, str]]:
        """Return the pairs of tools that may meet: one that moves, and another one or one that always stands."""
        moving = self._list_moving(stage)
        driven = {name for each in self.model.stages for name in each.tool_motion}
        standing = [name for name, tool in self._tools.items() if name not in driven and tool.spring is None]
        pairs = itertools.combinations([*moving, *standing], 2)
        return [(one, other) for one, other in pairs if one in moving]

    def _measure(self, pair: tuple[str, str], at: Mapping[str, Place]) -> float:
        """Return how deep two tools are in each other [mm]."""
        one, other = pair
        return max(self._depth(one, other, at), self._depth(other, one, at))

    def _is_free(self, name: str) -> bool:
        """Return whether a force or a spring places a tool, so that its place is not known."""
        motions = [stage.tool_motion[name] for stage in self.model.stages if name in stage.tool_motion]
        return self._tools[name].spring is not None or any(motion.push is not None for motion in motions)

    def _depth(self, one: str, other: str, at: Mapping[str, Place]) -> float:
        """Return how deep points of one tool are in the metal of the other [mm]."""
        points = place_points(self._tools[one], self._points[one], at[one])
        if not len(points):
            return 0.0
        own = unplace_points(self._tools[other], points, at[other])
        gap = measure_gap(self._tools[other], own, REACH * self._size)
        return max(0.0, -float(gap.min()))

    def _pass_plane(self, name: str, at: Mapping[str, Place], move: FloatArray) -> str:
        """Return the symmetry plane that a tool passes by its motion; empty for none."""
        start = self._points[name]
        for axis, place, side in self._planes:
            if not len(start) or side * move[axis] >= 0.0 or (side * (start[:, axis] - place)).min() < 0.0:
                continue
            now = place_points(self._tools[name], start, at[name])
            if (side * (now[:, axis] - place)).min() < -DEEP * self._size:
                return f"{'xyz'[axis]} = {place:g}"
        return ""


def find_planes(model: Model) -> list[tuple[int, float, int]]:
    """Return the planes that hold a straight side of the workpiece: axis, place [mm], side of the workpiece (1, -1)."""
    if model.analysis in ("stamping", "shell"):
        return []
    points, found = model.mesh.points, []
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    driven = {(p.node_set, p.component) for stage in model.stages for p in stage.prescribed}
    for support in model.lasting_supports:
        for axis in range(model.dimension):
            if not support.fix[axis] or support.normal is not None or (support.node_set, axis) in driven:
                continue
            at = points[model.mesh.node_sets[support.node_set]][:, axis]
            if len(at) < 2 or np.ptp(at) > FLAT * size:
                continue
            place = round(float(at.mean()), 9)
            if points[:, axis].min() > place - FLAT * size:
                found.append((axis, place, 1))
            elif points[:, axis].max() < place + FLAT * size:
                found.append((axis, place, -1))
    return found


def place_points(tool: Tool, points: FloatArray, place: Place) -> FloatArray:
    """Return where points of a tool (n, d) are that has moved and turned [mm]."""
    if place.turned == 0.0:
        return np.asarray(points + place.moved)
    if points.shape[1] == 2:
        centre = start_centre(tool)
        return np.asarray(turn_vectors(points - centre, place.turned) + centre + place.moved)
    centre = start_centre_in_space(tool)
    return np.asarray((points - centre) @ turn_about(place.turned * find_axis(tool)).T + centre + place.moved)


def unplace_points(tool: Tool, points: FloatArray, place: Place) -> FloatArray:
    """Return points (n, d) as they would be seen from a tool had it not moved [mm]."""
    if place.turned == 0.0:
        return np.asarray(points - place.moved)
    if points.shape[1] == 2:
        centre = start_centre(tool)
        return np.asarray(turn_vectors(points - centre - place.moved, -place.turned) + centre)
    centre = start_centre_in_space(tool)
    turned = turn_about(-place.turned * find_axis(tool))
    return np.asarray((points - centre - place.moved) @ turned.T + centre)
