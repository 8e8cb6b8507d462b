# SPDX-License-Identifier: Apache-2.0
"""The working faces of corrected tools as B-spline faces, over the flat blank.

A place of a tool has the parameters of the place of the flat blank that lies on it in the closed tools as drawn. So a
steep wall is as long as in the blank, and a face needs no cut. Beyond its tool a face is continued smoothly to the
rectangle of the parameters.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from presswork.geometry.foot_on_triangles import find_feet
from presswork.geometry.spline_face import SplineFace, fit_face
from presswork.mesh.files.step_faces import pack_faces
from presswork.mesh.triangles import find_triangle_parts, pair_triangles
from presswork.model import FloatArray, IntArray
from presswork.results.whole_file import write_whole
from presswork.study.compensated_tools import PressedTool

logger = logging.getLogger(__name__)

WITHIN = 0.02
"""Largest distance of a tool's corners from its faces that is sought [mm]."""
_NEAR, _ASIDE = 1.5, 0.25
"""Distance of a corner from the middle of the sheet along its normal and square to it, over the thickness, within which
the sheet lies on it."""
_SMALL = 0.01
"""Part of a tool's corners below which a piece is left out."""


@dataclass(frozen=True)
class SheetInTools:
    """The sheet in the closed tools as drawn, and where it came from."""

    formed: FloatArray
    """(n_points, 3) [mm]."""
    flat: FloatArray
    """Places in the flat blank (n_points, 2) [mm]."""
    triangles: IntArray
    planes: tuple[bool, bool]
    thickness: float


def write_faces(folder: Path, tools: Sequence[PressedTool], drawn: Sequence[PressedTool], sheet: SheetInTools) -> None:
    """Write the faces of each tool as TOOL.step, and warn of those that lie farther off its triangles than sought."""
    ends = sheet.flat[np.stack([sheet.triangles, np.roll(sheet.triangles, 1, axis=1)])]
    spacing = float(np.median(np.linalg.norm(ends[0] - ends[1], axis=2)))
    for tool, before in zip(tools, drawn, strict=True):
        faces = fit_tool(tool, before, sheet, spacing)
        if not faces:
            continue
        path = folder / f"{tool.name}.step"
        write_whole(path, pack_faces(tool.name, faces))
        off = max(face.off for face in faces)
        if off > WITHIN:
            logger.warning("%s lies up to %.3g mm off the triangles of %s.stl: compare both", path, off, tool.name)


def fit_tool(tool: PressedTool, drawn: PressedTool, sheet: SheetInTools, spacing: float) -> tuple[SplineFace, ...]:
    """Return a face for each piece of a tool on which the sheet lies, in the frame of the tool's triangles.

    drawn: the same tool as drawn; spacing: of the first knots, about an edge of its triangles [mm].
    """
    sign = np.where(np.array([*sheet.planes, False]) & (drawn.closed < 0.0), -1.0, 1.0)
    side = np.where(np.array([*sheet.planes, False]) & (sheet.formed.mean(axis=0) < 0.0), -1.0, 1.0)
    folded = drawn.closed * sign * side
    feet = find_feet(folded, sheet.formed, sheet.triangles)
    away = folded - feet.interpolate(sheet.formed, sheet.triangles)
    corners = sheet.formed[sheet.triangles[feet.triangle]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    height = (away * normal).sum(axis=1) / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
    aside = np.sqrt(np.maximum((away**2).sum(axis=1) - height**2, 0.0))  # of places beyond the edge of the blank
    is_near = (np.abs(height) < _NEAR * sheet.thickness) & (aside < _ASIDE * sheet.thickness)
    flat = feet.interpolate(sheet.flat, sheet.triangles) * (sign * side)[:, :2]
    triangles = tool.shape.triangles
    triangles = triangles[is_near[triangles].all(axis=1)]
    if not len(triangles):
        return ()
    _, part = find_triangle_parts(len(triangles), pair_triangles(triangles))
    found = []
    for number in range(int(part.max()) + 1):
        own = np.unique(triangles[part == number])
        if len(own) > max(_SMALL * len(tool.shape.points), 16):
            found.append(fit_face(tool.shape.points[own], flat[own], spacing, WITHIN))
    return tuple(found)
