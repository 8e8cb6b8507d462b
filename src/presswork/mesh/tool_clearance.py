# SPDX-License-Identifier: Apache-2.0
"""Travel of a rigid tool until it strikes another tool."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from presswork import _core
from presswork.geometry.swept_tool import triangulate
from presswork.geometry.tool_surface import make_surface
from presswork.model import FloatArray, Surface, SweptProfile, Triangulation

MOST_ADVANCES = 200
"""Most advances of a tool: a gap between surfaces at 60 degrees to its direction is halved by each or by every second
one."""
MOST_TOUCHES = 20_000
WITHIN = 1e-4
"""Part of the thickness that is left between a tool and the part that it touches."""


WALL = 0.7
"""Sine of the angle between a surface and the motion, below which it is a wall along which tools slide: 45 degrees."""


LEVEL = 0.97
"""Sine of that angle from which on a surface is level: within 14 degrees."""


def sample_tool(shape: Surface, within: float) -> FloatArray:
    """Return the corners and middles of a tool's triangles (n, 3) [mm], in its own frame.

    within: by how much those of a drawn tool may be off it [mm].
    """
    if isinstance(shape, Triangulation):
        points, triangles = shape.points, shape.triangles
    else:
        assert isinstance(shape, SweptProfile), "a plane without end has no triangles"
        points, triangles = triangulate(shape, within)
    return np.concatenate([points, points[triangles].mean(axis=1)])


def find_clearance(
    one: Surface, other: Surface, between: FloatArray, direction: FloatArray, within: float, tolerance: float = 1e-4
) -> float:
    """Return how far a tool can go along its direction before it strikes another [mm]; infinite where it never does.

    between: from the other's origin to the one's (3,) [mm]. direction: unit vector (3,). within: as in `sample_tool`.
    tolerance: of the gap that is left [mm].

    Points of either are compared with the surface of the other. While the least gap is g nothing can touch within g, so
    the tool advances by g, and gaps that may now be small are computed again. Where that does not end, they only slide
    past each other. Tools that overlap from the start have no clearance to find: infinite, too.
    """
    points = sample_tool(one, within) + between, sample_tool(other, within) - between
    surfaces, directions = (make_surface(other), make_surface(one)), (direction, -direction)
    gaps = [surface.nearest(x)[0] for surface, x in zip(surfaces, points, strict=True)]  # later: at least so much
    advance = 0.0
    for _ in range(MOST_ADVANCES):
        least = min(float(g.min()) for g in gaps)
        if least < tolerance:
            return advance if advance > 0.0 else math.inf
        if math.isinf(least):
            break
        advance += least
        for surface, x, along, gap in zip(surfaces, points, directions, gaps, strict=True):
            gap -= least
            near = gap < least
            gap[near] = surface.nearest(x[near] + advance * along)[0]
    return math.inf


def find_touch(
    surface: _core.ToolSurface, points: FloatArray, half: FloatArray, direction: FloatArray, farthest: float
) -> float | None:
    """Return how far a tool goes along its direction until it touches a sheet; None: not within `farthest`.

    points: nodes in the tool's frame (n, 3), half the thickness there (n,) [mm]. No gap falls by more than the tool
    advances: it advances by the least, and those that may be small are computed again.
    """
    tolerance = WITHIN * float(half.mean())
    gaps = surface.nearest(points)[0] - half
    travel = 0.0
    for _ in range(MOST_TOUCHES):
        least = float(gaps.min())
        if least < tolerance:
            return travel + least
        travel += least
        if travel > farthest + tolerance or not math.isfinite(travel):
            return None
        gaps = gaps - least
        near = gaps < least
        gaps[near] = surface.nearest(np.ascontiguousarray(points[near] - travel * direction))[0] - half[near]
    return None


@dataclass(frozen=True)
class Closing:
    """The place where the distance of two tools falls to a given room."""

    travel: float
    """Travel of the moving tool from its start [mm]."""
    place: FloatArray
    """Place where they are nearest, in the frame of the other tool (3,) [mm]."""


@dataclass(frozen=True)
class Room:
    """The room that two tools must leave each other [mm]."""

    ahead: float
    """Room between faces that come together as a tool goes on."""
    beside: float
    """Room between walls that slide along each other."""

    @property
    def most(self) -> float:
        """The larger of both."""
        return max(self.ahead, self.beside)


class _Pair:
    """Points of two tools, each compared with the surface of the other as the one moves.

    A gap falls by no more than the travel, so only points that may be near are computed again.
    """

    def __init__(
        self, one: Surface, other: Surface, between: FloatArray, direction: FloatArray, within: float, room: Room
    ) -> None:
        self.points = sample_tool(one, within) + between, sample_tool(other, within) - between
        self.surfaces, self.directions = (make_surface(other), make_surface(one)), (direction, -direction)
        self.between, self.room = between, room
        self.at_least = [surface.nearest(x)[0] for surface, x in zip(self.surfaces, self.points, strict=True)]
        heights = [float(np.ptp(x @ direction)) for x in self.points]
        self.farthest = sum(heights) + float(np.abs(between @ direction))

    def advance(self, step: float) -> float:
        """Return a travel after which no gap has fallen below the room by more than the step [mm]."""
        nearest = min(float(gap.min()) for gap in self.at_least) - self.room.most
        return min(max(step, nearest), self.farthest + step)

    def go_on(self, travel: float, advance: float, step: float) -> None:
        """Ask those again that may be near after an advance to a travel [mm]."""
        for side, (surface, x, along) in enumerate(zip(self.surfaces, self.points, self.directions, strict=True)):
            self.at_least[side] = self.at_least[side] - advance
            near = self.at_least[side] < self.room.most + step
            self.at_least[side][near] = surface.nearest(np.ascontiguousarray(x[near] + travel * along))[0]

    def least_excess(self, travel: float, near: float) -> tuple[float, FloatArray]:
        """Return the least gap beyond the room at a travel [mm], and its place in the frame of the other tool (3,).

        near: points whose gap is at least that are left out [mm].
        """
        found = [(math.inf, np.zeros(3))]
        for side, (surface, x, along) in enumerate(zip(self.surfaces, self.points, self.directions, strict=True)):
            asked = np.flatnonzero(self.at_least[side] < near)
            if len(asked):
                places = x[asked] + travel * along
                gap, normal = surface.nearest(np.ascontiguousarray(places))[:2]
                aslant = np.where(np.isfinite(gap), np.abs(normal @ along), 1.0)
                excess = gap - np.where(aslant > WALL, self.room.ahead, self.room.beside)
                worst = int(np.argmin(excess))
                moved = (self.between + travel * self.directions[0]) if side == 1 else 0.0
                found.append((float(excess[worst]), places[worst] + moved))
        return min(found, key=lambda pair: pair[0])


def find_closing(
    one: Surface,
    other: Surface,
    between: FloatArray,
    direction: FloatArray,
    within: float,
    room: float | Room,
    step: float,
) -> Closing | None:
    """Return where a moving tool first leaves less than `room` [mm] to another; None where it does not.

    between, direction, within: as in `find_clearance`. step: of the travel [mm]; what they leave less room in over
    a shorter stroke is not found. Tools that slide along each other with more room between them go on.
    """
    room = room if isinstance(room, Room) else Room(room, room)
    pair = _Pair(one, other, between, direction, within, room)
    before, travel = 0.0, 0.0
    while travel <= pair.farthest:
        excess, place = pair.least_excess(travel, room.most + step)
        if excess < 0.0:
            break
        advance = pair.advance(step)
        before, travel = travel, travel + advance
        pair.go_on(travel, advance, step)
    else:
        return None
    while travel - before > 1e-3 * step:
        middle = 0.5 * (before + travel)
        excess, at = pair.least_excess(middle, room.most + 2.0 * step)
        if excess < 0.0:
            travel, place = middle, at
        else:
            before = middle
    return Closing(travel, place)


def find_level_gap(one: Surface, other: Surface, between: FloatArray, direction: FloatArray, within: float) -> float:
    """Return the least gap of a tool to another's level faces [mm], infinite where it has none ahead.

    between: from the other's origin to the one's (3,) [mm], where both stand now. direction, within: as in
    `find_clearance`.
    """
    points = np.ascontiguousarray(sample_tool(one, within) + between)
    gap, normal = make_surface(other).nearest(points)[:2]
    is_level = np.isfinite(gap) & (np.abs(normal @ direction) >= LEVEL)
    return float(gap[is_level].min(initial=math.inf))
