# SPDX-License-Identifier: Apache-2.0
"""Tools in space drawn whole behind the part, pale if they are in front of it, so that none hides or tints it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from presswork.model import FloatArray
from presswork.results import Result

if TYPE_CHECKING:
    from mpl_toolkits.mplot3d import Axes3D

TOOL_COLOURS = ("#a9b0b7", "#c4ae8e", "#9db9c6", "#adc49b")
"""Pale colours of tools, in turn."""
THIN = 0.25
"""Opacity of a tool in front of the part."""
_AROUND = 0.15
"""How far tools are drawn beyond the frame, over its longest side."""
_MOST_POINTS = 400
"""Points of the part that the faces of tools are held against."""
_LONGEST = 0.06
"""Longest edge of a tool's triangles, over the frame's longest side that is cut and shaded."""
_MOST_SPLITS = 14


@dataclass(frozen=True)
class DrawnTool:
    """The faces of a tool that are drawn."""

    corners: FloatArray
    """(n, 3, 3) [mm]"""
    colours: FloatArray
    """Red, green, blue and opacity of each (n, 4)."""


def find_tool_faces(
    result: Result, tool: str, step: int, part: FloatArray, low: FloatArray, high: FloatArray, towards: FloatArray
) -> tuple[FloatArray, float]:
    """Return the corners of the faces (n, 3, 3) [mm] of a tool that are drawn, and its opacity.

    part: points of the part and its images (n, 3) [mm]; low, high: corners of the frame, beyond which tools are cut
    off; towards: unit vector from the part to the viewer (3,). Faces that look away are left out if the tool is
    behind the part.
    """
    reach = float((high - low).max())
    corners = result.placed_surface(tool, step)[result.surfaces[tool][1]]
    corners = split_long(clip_triangles(corners, low - _AROUND * reach, high + _AROUND * reach), _LONGEST * reach)
    normals = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    if normals[_face_points(corners, normals, part, 1e-3 * reach)].sum(axis=0) @ towards <= 0.0:
        return corners, THIN
    return corners[normals @ towards > 0.0], 1.0


def view_direction(ax: Axes3D) -> FloatArray:
    """Return the unit vector from what is drawn to the viewer (3,)."""
    elevation, azimuth = np.radians([ax.elev, ax.azim])
    return np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])


def clip_triangles(corners: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """Return the parts of triangles (n, 3, 3) in a box, cut into triangles."""
    for axis in range(3):
        for side, end in ((1.0, low[axis]), (-1.0, high[axis])):
            corners = _clip(corners, side * (corners[..., axis] - end))
    return corners


def _clip(corners: FloatArray, over: FloatArray) -> FloatArray:
    """Return what lies above zero of triangles (n, 3, 3) with a height at each corner (n, 3)."""
    inside = over >= 0.0
    count = inside.sum(axis=1)
    kept = [corners[count == 3]]
    for number in (1, 2):
        chosen = count == number
        first = inside[chosen].argmax(axis=1) if number == 1 else (~inside[chosen]).argmax(axis=1)
        order = (first[:, None] + np.arange(3)) % 3  # the corner that is alone on its side comes first
        points = np.take_along_axis(corners[chosen], order[..., None], axis=1)
        heights = np.take_along_axis(over[chosen], order, axis=1)
        alone, others = points[:, :1], points[:, 1:]
        cut = alone + (heights[:, :1] / (heights[:, :1] - heights[:, 1:]))[..., None] * (others - alone)
        if number == 1:
            kept.append(np.concatenate([alone, cut], axis=1))
        else:
            kept.append(np.concatenate([cut[:, :1], others], axis=1))
            kept.append(np.stack([cut[:, 0], others[:, 1], cut[:, 1]], axis=1))
    return np.concatenate(kept)


def split_long(corners: FloatArray, longest: float) -> FloatArray:
    """Return triangles (n, 3, 3) halved across their longest edges until these are no longer than `longest`."""
    done = []
    for _ in range(_MOST_SPLITS):
        edges = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
        is_long = edges.max(axis=1, initial=0.0) > longest
        done.append(corners[~is_long])
        corners, edges = corners[is_long], edges[is_long]
        if not len(corners):
            break
        order = (edges.argmax(axis=1)[:, None] + np.arange(3)) % 3
        a, b, c = np.moveaxis(np.take_along_axis(corners, order[..., None], axis=1), 1, 0)
        middle = 0.5 * (a + b)
        corners = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
    return np.concatenate([*done, corners])


def _face_points(corners: FloatArray, normals: FloatArray, part: FloatArray, least: float) -> FloatArray:
    """Return whether any point of the part lies on the outside of each triangle (n,)."""
    points = part[:: max(len(part) // _MOST_POINTS, 1)]
    unit = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    off = (corners.mean(axis=1) * unit).sum(axis=1)
    farthest = np.full(len(unit), -np.inf)
    for chunk in np.array_split(points, max(len(points) // 50, 1)):
        farthest = np.maximum(farthest, (unit @ chunk.T).max(axis=1))
    return np.asarray(farthest - off > least)
