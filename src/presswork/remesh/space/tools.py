# SPDX-License-Identifier: Apache-2.0
"""Rigid tools as a new mesh must know them: where they stand, their sharp edges, the radii of their bends, and how wide
their ridges and slots are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from presswork.geometry.pose import SpacePose
from presswork.geometry.tool_widths import NO_WIDTHS, Widths
from presswork.model import BoolArray, FloatArray, IndexArray, IntArray

SHARP = float(np.radians(35.0))
"""Turn from facet to facet above which an edge has no radius."""
FLAT = float(np.radians(1.0))
"""Turn below which two facets are one."""
_ROUNDS = 20


class Touched(Protocol):
    """A surface where it stands."""

    def nearest(self, points: FloatArray, reach: float) -> tuple[FloatArray, FloatArray]:
        """Return the gap of points (n, 3) closer than reach [mm], infinite of others, and the normal there (n, 3)."""


@dataclass(frozen=True)
class Bends:
    """Edges between the facets of a rigid tool that turn."""

    segments: FloatArray
    """Their ends (m, 2, 3) [mm]."""
    turn: FloatArray
    """Turn between the facets, positive where the tool is convex (m,) [rad]."""
    width: FloatArray
    """Width of the narrower facet (m,) [mm]."""

    def carry(self, pose: SpacePose) -> Bends:
        """Return the edges where the tool stands."""
        return replace(self, segments=pose.carry(self.segments.reshape(-1, 3)).reshape(-1, 2, 3))


def find_bends(corners: FloatArray, triangles: IntArray) -> Bends:
    """Return the bends of triangles (n, 3) over corners [mm], counter-clockwise as seen from free space."""
    ends, one, other = _pair_facets(triangles)
    placed = corners[triangles]
    normal = np.cross(placed[:, 1] - placed[:, 0], placed[:, 2] - placed[:, 0])
    doubled = np.linalg.norm(normal, axis=1)
    normal = normal / np.maximum(doubled, 1e-300)[:, None]
    segments = corners[ends]
    length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
    width = np.minimum(doubled[one], doubled[other]) / np.maximum(length, 1e-300)
    turn = np.arccos(np.clip((normal[one] * normal[other]).sum(axis=1), -1.0, 1.0))
    away = placed[other].mean(axis=1) - placed[one].mean(axis=1)
    convex = (normal[one] * away).sum(axis=1) <= 0.0
    bent = turn > FLAT
    return Bends(segments[bent], np.where(convex, turn, -turn)[bent], width[bent])


@dataclass(frozen=True)
class PlacedTool:
    """A rigid tool where it stands."""

    surface: Touched
    bends: Bends
    widths: Widths = NO_WIDTHS

    def touch(self, points: FloatArray, reach: float) -> tuple[FloatArray, FloatArray]:
        """Return the gap of points (n, 3) [mm], infinite beyond reach, and normals out of the tool (n, 3)."""
        return self.surface.nearest(points, reach)

    @property
    def sharp_edges(self) -> FloatArray:
        """Edges without a radius that point into the metal (m, 2, 3) [mm]."""
        return self.bends.segments[self.bends.turn > SHARP]

    def tight_edges(self, radius: float) -> FloatArray:
        """Return edges that point into the metal, and whose radius is below one [mm] (m, 2, 3) [mm]."""
        segments, turn, width = self.bends.segments, self.bends.turn, self.bends.width
        return segments[(turn > SHARP) | ((turn > 0.0) & (width < radius * turn))]

    def list_radii(self, spacing: float) -> tuple[FloatArray, FloatArray]:
        """Return places on its bends no farther apart than a spacing [mm] (n, 3), and the radii there [mm] (n,).

        0 at sharp edges that point into the metal; those that point out of it need no cells: metal does not fill them.
        """
        segments, turn, width = self.bends.segments, self.bends.turn, self.bends.width
        radius = np.where(turn > SHARP, 0.0, width / np.abs(turn))
        counts = turn > -SHARP
        return _sample(segments[counts], radius[counts], spacing)


@dataclass(frozen=True)
class ToolShape:
    """What does not change of a rigid tool, in its own frame."""

    bends: Bends
    widths: Widths

    def place(self, surface: Touched, pose: SpacePose) -> PlacedTool:
        """Return the tool where it stands."""
        return PlacedTool(surface, self.bends.carry(pose), self.widths.carry(pose))


def put_on_tools(
    points: FloatArray, tools: Sequence[PlacedTool], own: BoolArray, held: BoolArray, reach: float
) -> FloatArray:
    """Return points (n, 3) on all the tools that own (n_tools, n) marks for each; what lies farther than reach stays.

    held (n, 3) marks coordinates that planes hold: those stay to the last bit.
    """
    result = points.copy()
    marked = np.flatnonzero(own.any(axis=0))
    for _ in range(_ROUNDS):
        largest = 0.0
        for tool, holds in zip(tools, own, strict=True):
            nodes = marked[holds[marked]]
            if not len(nodes):
                continue
            gap, normal = tool.touch(result[nodes], reach)
            near = np.isfinite(gap)
            nodes, gap, normal = nodes[near], gap[near], normal[near]
            along = np.where(held[nodes], 0.0, normal)
            # in a plane the way to the tool is longer than the gap
            slope = np.maximum((along**2).sum(axis=1), 1e-2)
            result[nodes] -= (gap / slope)[:, None] * along
            largest = max(largest, float(np.abs(gap).max(initial=0.0)))
        if largest <= 1e-13 * reach:
            break
    return result


def _pair_facets(triangles: IntArray) -> tuple[IndexArray, IndexArray, IndexArray]:
    """Return the edges (m, 2) that two triangles share, and those two (m,) each."""
    ends = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    owner = np.tile(np.arange(len(triangles)), 3)
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    ends, owner = ends[order], owner[order]
    same = np.flatnonzero((ends[1:] == ends[:-1]).all(axis=1))
    return ends[same].astype(np.intp), owner[same], owner[same + 1]


def _sample(segments: FloatArray, values: FloatArray, spacing: float) -> tuple[FloatArray, FloatArray]:
    """Return points along segments (m, 2, 3) no farther apart than a spacing, each with its segment's value."""
    length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
    count = np.maximum(np.ceil(length / spacing).astype(int), 1)
    owner = np.repeat(np.arange(len(segments)), count)
    first = np.repeat(np.cumsum(count) - count, count)
    part = ((np.arange(len(owner)) - first) + 0.5) / count[owner]
    return segments[owner, 0] + part[:, None] * (segments[owner, 1] - segments[owner, 0]), values[owner]
