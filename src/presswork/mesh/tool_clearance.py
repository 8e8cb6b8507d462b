# SPDX-License-Identifier: Apache-2.0
"""Travel of a rigid tool until it strikes another tool."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from presswork.geometry.swept_tool import triangulate
from presswork.geometry.tool_surface import make_surface
from presswork.model import FloatArray, Surface, SweptProfile, Triangulation

MOST_ADVANCES = 200
"""A gap between surfaces that lie 60 degrees to the way is halved by each or by every other one."""


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
    """Return how far a tool can go along its way before it strikes another [mm]; infinite where it never does.

    between: from the other's origin to the one's (3,) [mm]. way: unit vector (3,). within: as in `sample_tool`.
    tolerance: of the gap that is left [mm].

    Points of either are held against the surface of the other. While the least gap is g nothing can touch within g, so
    the tool advances by g, and gaps that may now be small are asked again. Where that comes to no end, they only slide
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


@dataclass(frozen=True)
class Closing:
    """The place where the distance of two tools falls to a given room."""

    travel: float
    """Travel of the moving tool from its start [mm]."""
    place: FloatArray
    """Place where they are nearest, in the frame of the other tool (3,) [mm]."""


def find_closing(
    one: Surface, other: Surface, between: FloatArray, direction: FloatArray, within: float, room: float, step: float
) -> Closing | None:
    """Return where a tool, going along its way, first leaves less than `room` [mm] to another; None where it does not.

    between, way, within: as in `find_clearance`. step: of the travel [mm]; what they leave less room in over a shorter
    way is not found. Tools that slide along each other with more room between them go on. A gap falls by no more than
    the travel, so only points that may be near are asked again.
    """
    points = sample_tool(one, within) + between, sample_tool(other, within) - between
    surfaces, directions = (make_surface(other), make_surface(one)), (direction, -direction)
    heights = [float(np.ptp(x @ direction)) for x in points]
    farthest = sum(heights) + float(np.abs(between @ direction))
    at_least = [surface.nearest(x)[0] for surface, x in zip(surfaces, points, strict=True)]

    def least_gap(travel: float, near: float) -> tuple[float, FloatArray]:
        """Return the least gap at a travel, and its place, of the points that may be nearer than `near`."""
        found = [(math.inf, np.zeros(3))]
        for side, (surface, x, along) in enumerate(zip(surfaces, points, directions, strict=True)):
            asked = np.flatnonzero(at_least[side] < near)
            if len(asked):
                places = x[asked] + travel * along
                gap = surface.nearest(np.ascontiguousarray(places))[0]
                worst = int(np.argmin(gap))
                found.append((float(gap[worst]), places[worst] + (side == 1) * (between + travel * direction)))
        return min(found, key=lambda pair: pair[0])

    before, travel = 0.0, 0.0
    while travel <= farthest:
        gap, place = least_gap(travel, room + step)
        if gap < room:
            break
        advance = min(max(step, min(float(g.min()) for g in at_least) - room), farthest + step)
        before, travel = travel, travel + advance
        for side, (surface, x, along) in enumerate(zip(surfaces, points, directions, strict=True)):
            at_least[side] = at_least[side] - advance
            near = at_least[side] < room + step
            at_least[side][near] = surface.nearest(np.ascontiguousarray(x[near] + travel * along))[0]
    else:
        return None
    while travel - before > 1e-3 * step:
        middle = 0.5 * (before + travel)
        gap, at = least_gap(middle, room + 2.0 * step)
        if gap < room:
            travel, place = middle, at
        else:
            before = middle
    return Closing(travel, place)
