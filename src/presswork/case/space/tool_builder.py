# SPDX-License-Identifier: Apache-2.0
"""The Model's tools in space from a case's: drawn or read, directed to the workpiece, clear of it."""

from __future__ import annotations

import logging
import math
from pathlib import Path

import numpy as np

from presswork.case.errors import Problem
from presswork.case.space.tools import PlaneTool, ProfileTool, SpaceTool
from presswork.case.tools.builder import is_backwards
from presswork.case.tools.profile import ProfileError, draw_outline
from presswork.case.units import LENGTH, unit_factor
from presswork.geometry.segments import TURN, X0, X1, reverse_segments, sample_arc
from presswork.geometry.tool_surface import make_surface
from presswork.mesh import MeshError
from presswork.mesh.tool_file import read_tool
from presswork.model import FloatArray, Friction, Mesh, Plane, Surface, SweptProfile, Tool, Triangulation

logger = logging.getLogger(__name__)

TOLERANCE = 1e-6
"""Of the size of the workpiece: how deep a node may lie in a tool at the start."""
CHORD = 1e-4
"""Of the size of the workpiece: how far the facets of a straight tool may lie off its arcs."""
BEYOND = 5.0
"""Times the size of the workpiece: half the length of a straight tool."""


def build_tool(name: str, tool: SpaceTool, mesh: Mesh, mirrors: tuple[FloatArray, ...], folder: Path) -> Tool | Problem:
    """Build a tool, or say why it cannot be.

    mirrors: positions of the symmetry planes normal to x, y and z [mm]. folder: what the path of a file is relative to.
    """
    nodes = mesh.points[np.unique(mesh.boundary_faces)]
    size = float(np.linalg.norm(np.ptp(nodes, axis=0)))
    shape = _make_shape(name, tool, nodes, size, folder)
    if isinstance(shape, Problem):
        return shape
    gap, normal, _, _ = make_surface(shape).nearest(np.ascontiguousarray(nodes - np.array(tool.position)), size)
    deepest = int(np.argmin(gap))
    if gap[deepest] < -TOLERANCE * size:
        place = ", ".join(f"{x:.6g}" for x in nodes[deepest])
        away = ", ".join(f"{x + 0.0:.6g}" for x in gap[deepest] * normal[deepest])
        return Problem(
            f"tools.{name}",
            f"the tool starts inside the workpiece: {int((gap < -TOLERANCE * size).sum())} boundary nodes lie in it, "
            f"the deepest {-gap[deepest]:.6g} mm at ({place})",
            f"move the tool by ({away}) mm, or turn its surface over if its metal is on the other side",
        )
    cut = _find_mirrors(tool, shape, mirrors, size)
    for axis in (0, 1):
        if tool.shape == "round" and cut[axis] and abs(tool.position[axis] - mirrors[axis][0]) > TOLERANCE * size:
            plane = f"{'xy'[axis]} = {mirrors[axis][0]:g}"
            return Problem(
                f"tools.{name}.position",
                f"the symmetry plane {plane} cuts this round tool beside its axis, so it has no mirror image of itself",
                f"put its axis on {plane}, or model the whole workpiece",
                list(tool.position),
            )
    return Tool(name, shape, tool.position, Friction(tool.contact, tool.m, tool.mu), mirrored_across=cut)


def _make_shape(name: str, tool: SpaceTool, nodes: FloatArray, size: float, folder: Path) -> Surface | Problem:
    if isinstance(tool, PlaneTool):
        x, y, z = (part / math.hypot(*tool.normal) + 0.0 for part in tool.normal)
        return Plane((x, y, z))
    if isinstance(tool, ProfileTool):
        return _draw(name, tool, nodes, size)
    try:
        scale = unit_factor(tool.unit, LENGTH)
        read, notes = read_tool(folder / tool.path, scale=scale, usual_size=size)
    except ValueError as error:
        return Problem(f"tools.{name}.unit", f"expected a unit of length, but {error}", "e.g. mm, m, inch", tool.unit)
    except MeshError as error:
        return Problem(f"tools.{name}.path", error.fault, error.remedy, tool.path)
    for note in notes:
        logger.warning("tools.%s.path = %s: %s", name, tool.path, note)
    return read


def _draw(name: str, tool: ProfileTool, nodes: FloatArray, size: float) -> Surface | Problem:
    """Draw a profile with the workpiece on its left, and turn or draw it out."""
    try:
        segments = draw_outline(tool.profile, False).segments
    except ProfileError as error:
        value = list(tool.profile[error.point].to)
        return Problem(f"tools.{name}.profile.{error.point}", error.fault, error.remedy, value)
    seen = nodes - np.array(tool.position)
    across = np.hypot(seen[:, 0], seen[:, 1]) if tool.shape == "round" else seen[:, 0]
    backwards = is_backwards(name, tool.free_side, np.column_stack([across, seen[:, 2]]), segments)
    if isinstance(backwards, Problem):
        return backwards
    if backwards:
        segments = reverse_segments(segments)
    return _turn(segments) if tool.shape == "round" else _draw_out(segments, CHORD * size, BEYOND * size)


def _turn(segments: FloatArray) -> SweptProfile:
    """Turn a profile (n, 7) in r and z about the z axis."""
    radius = float(np.maximum(segments[:, X0.start], segments[:, X1.start]).max())
    swept = segments.copy()
    swept[:, [0, 2, 4]] -= radius
    swept[segments[:, TURN] == 0.0, 4:6] = 0.0
    return SweptProfile((radius, radius), radius, swept)


def _draw_out(segments: FloatArray, tolerance: float, half_length: float) -> Triangulation:
    """Draw a profile (n, 7) in x and z straight along y, to both sides by half a length [mm]."""
    line = np.concatenate([*(sample_arc(segment, tolerance)[:-1] for segment in segments), segments[-1:, X1]])
    n = len(line)
    points = np.concatenate([np.insert(line, 1, y, axis=1) for y in (-half_length, half_length)])
    first = np.arange(n - 1)
    triangles = np.concatenate(
        [
            np.column_stack([first, first + 1, first + 1 + n]),
            np.column_stack([first, first + 1 + n, first + n]),
        ]
    )
    return Triangulation(points, triangles.astype(np.int32), False)


def _find_mirrors(
    tool: SpaceTool, shape: Surface, mirrors: tuple[FloatArray, ...], size: float
) -> tuple[bool, bool, bool]:
    """Say whether a symmetry plane normal to x, y and z cuts a tool, which is then twice what is modelled.

    Between two planes a slice is modelled, and nothing is cut in half.
    """
    cut = []
    for axis, planes in enumerate(mirrors):
        if len(planes) != 1:
            cut.append(False)
            continue
        if isinstance(shape, Plane):  # one across the plane leaves it whole
            cut.append(abs(shape.normal[axis]) < 1.0 - 1e-9)
            continue
        low, high = _extent(shape, axis)
        low, high = low + tool.position[axis], high + tool.position[axis]
        cut.append(low < planes[0] + 1e-6 * size and high > planes[0] - 1e-6 * size)
    return cut[0], cut[1], cut[2]


def _extent(shape: SweptProfile | Triangulation, axis: int) -> tuple[float, float]:
    """Return how far a shape reaches along an axis [mm]."""
    if isinstance(shape, Triangulation):
        return float(shape.points[:, axis].min()), float(shape.points[:, axis].max())
    if axis < 2:
        return -shape.half_widths[axis], shape.half_widths[axis]
    heights = shape.segments[:, [1, 3]]
    return float(heights.min()), float(heights.max())
