# SPDX-License-Identifier: Apache-2.0
"""The surfaces of tools in space, cut into triangles for pictures."""

from __future__ import annotations

import numpy as np

from presswork.geometry.pose import find_space_pose
from presswork.geometry.swept_tool import triangulate
from presswork.geometry.tool_surface import cut_plane
from presswork.model import FloatArray, IntArray, Model, Plane, SweptProfile, Tool

SHEET_CHORD = 0.02
"""How far the triangles of a drawn tool lie off its surface, over the thickness of a sheet."""
SOLID_CHORD = 1e-3
"""The same, of the size of a solid."""
AROUND = 1.5
"""Size to which a plane without end is drawn, over the farthest point of a solid."""


def cut_tools(model: Model) -> dict[str, tuple[FloatArray, IntArray]]:
    """Return points and triangles of every tool in space where it starts, by its name."""
    points, chord = model.mesh.points, _chord(model)
    found = {}
    for tool in model.space_tools:
        corners, triangles = draw_tool(tool, points, chord)
        found[tool.name] = (find_space_pose(tool, np.zeros(3)).carry(corners), triangles)
    return found


def draw_tool(tool: Tool, points: FloatArray, chord: float) -> tuple[FloatArray, IntArray]:
    """Return points and triangles of a tool in its own frame; points (n, 3): of the body that it meets [mm].

    chord: how far the triangles may lie off its surface [mm].
    """
    shape = tool.surface
    if isinstance(shape, Plane):
        shape = cut_plane(shape, AROUND * float(np.linalg.norm(points - np.asarray(tool.position), axis=1).max()))
    if isinstance(shape, SweptProfile):
        return triangulate(shape, chord, length=2.5 * float(np.abs(points[:, 1]).max()))
    return shape.points, shape.triangles


def _chord(model: Model) -> float:
    """Return how far the triangles of a drawn tool may lie off its surface [mm]."""
    if model.mesh.blocks[0].section is not None:
        return SHEET_CHORD * model.thickest
    return SOLID_CHORD * float(np.linalg.norm(np.ptp(model.mesh.points, axis=0)))
