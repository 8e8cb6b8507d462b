# SPDX-License-Identifier: Apache-2.0
"""Tools that slide along each other with a clearance far below the size of cells, as a punch in its container.

A node that the wall holds lies beyond the corner of the punch, in the clearance. It stays there while its neighbours go
on with the punch, whose corner then cuts through the edge between them. No cell can flow into such a gap. So the side
of the punch is moved past the wall, and its face takes the nodes at the wall along.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from presswork import _core, model
from presswork.geometry.pose import start_profile
from presswork.geometry.segments import TURN, X0, X1
from presswork.model import FloatArray

CLOSE = 0.05
"""Clearance, over the mean edge of cells, below which it is closed."""
PAST = 0.05
"""How far the side then stands past the wall, over the same length."""
PARALLEL = 0.01
"""Sine of the angle between two directions that count as one."""


def close_fits(
    tools: Sequence[model.Tool], stages: Sequence[model.Stage], mesh: model.Mesh
) -> tuple[tuple[model.Tool, ...], list[str]]:
    """Return the tools with the clearances closed that cells cannot flow into, and a warning of each."""
    ends = mesh.points[mesh.boundary_edges[:, :2]]
    edge = float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).mean())
    middle = find_middle(mesh.points)
    found, warnings = list(tools), []
    for number, tool in enumerate(tools):
        for other in tools:
            if other is tool or not (direction := find_relative_direction(tool, other, stages, 2)).any():
                continue
            for corner, gap, normal in _find_close_corners(found[number], other, direction, middle, CLOSE * edge):
                closed = move_side(found[number].profile, corner, direction, -(gap + PAST * edge) * normal)
                if closed is not None:
                    found[number] = replace(found[number], shape=closed)
                    warnings.append(
                        f"tools.{tool.name}: its side stands {gap:.3g} mm from tools.{other.name}, beside cells of "
                        f"{edge:.3g} mm that cannot flow into this gap: it is computed without clearance"
                    )
    return tuple(found), warnings


def find_relative_direction(
    tool: model.Tool, other: model.Tool, stages: Sequence[model.Stage], dimension: int
) -> FloatArray:
    """Return the one direction (dimension,) in which a tool moves past another; zero if there is none or several."""
    still, direction = model.ToolMotion(), np.zeros(dimension)
    for stage in stages:
        own, its = (stage.tool_motion.get(t.name, still) for t in (tool, other))
        if own.turn or its.turn or its.push is not None:
            return np.zeros(dimension)
        move = np.array(own.push.direction if own.push is not None else np.subtract(own.move, its.move))[:dimension]
        if not move.any():
            continue
        move = move / np.linalg.norm(move)
        if direction.any() and np.linalg.norm(move - (move @ direction) * direction) > PARALLEL:
            return np.zeros(dimension)
        direction = move
    return direction


def find_middle(points: FloatArray) -> FloatArray:
    """Return the middle of a workpiece (dimension,) [mm]: a face that presses it comes from before that."""
    return np.asarray(0.5 * (points.min(axis=0) + points.max(axis=0)))


def _find_close_corners(
    tool: model.Tool, other: model.Tool, direction: FloatArray, middle: FloatArray, nearest: float
) -> Iterator[tuple[int, float, FloatArray]]:
    """Yield the corners of a tool that go along another tool's wall, towards the middle (2,) of the workpiece.

    Each is the number of the segment that ends there, its gap from the wall [mm], and the wall's normal (2,).
    """
    corners = start_profile(tool)[:-1, X1]
    if not len(corners):
        return
    gap, normal, *_ = _core.touch_profile(start_profile(other), np.ascontiguousarray(corners))
    goes_along = (
        (np.abs(gap) <= nearest) & (np.abs(normal @ direction) < PARALLEL) & ((middle - corners) @ direction > 0.0)
    )
    for corner in np.flatnonzero(goes_along):
        if gap[corner] > -1e-9 * nearest:
            yield int(corner), float(max(gap[corner], 0.0)), normal[corner]


def move_side(profile: model.Profile, corner: int, direction: FloatArray, by: FloatArray) -> model.Profile | None:
    """Return a profile whose side at a corner is moved; None where that is not a side between two straight pieces.

    corner: number of the segment that ends there. direction: of the tool; by: move of the side (2,) [mm], across it.
    """
    segments = profile.segments.copy()
    along = [abs(float(_cross(_direction(s), direction))) < PARALLEL for s in segments[corner : corner + 2]]
    if along[0] == along[1] or segments[corner : corner + 2, TURN].any():
        return None
    side, face = (corner, corner + 1) if along[0] else (corner + 1, corner)
    beyond = side + (1 if side > face else -1)
    if 0 <= beyond < len(segments) and segments[beyond, TURN] != 0.0:
        return None
    face_direction = _direction(segments[face])
    reach = float(by @ by) / float(face_direction @ by)
    at = segments[corner, X1] + reach * face_direction
    segments[corner, X1], segments[corner + 1, X0] = at, at
    far = X1 if side > face else X0
    segments[side, far] += by
    if 0 <= beyond < len(segments):
        segments[beyond, X0 if side > face else X1] = segments[side, far]
    return model.Profile(segments)


def _direction(segment: FloatArray) -> FloatArray:
    direction = segment[X1] - segment[X0]
    return np.asarray(direction / np.linalg.norm(direction))


def _cross(one: FloatArray, other: FloatArray) -> float:
    return float(one[0] * other[1] - one[1] * other[0])
