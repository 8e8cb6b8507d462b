# SPDX-License-Identifier: Apache-2.0
"""Where the tools of a stamping stand at the start: drawn or read, and placed so that they just touch the blank."""

from __future__ import annotations

import logging
import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from presswork.case.errors import Problem
from presswork.case.stamping.plan_line import draw_line
from presswork.case.stamping.schema import StampingCase
from presswork.case.stamping.shapes import draw_shape
from presswork.case.stamping.tools import Tool, ToolFile
from presswork.case.tool_sizes import doubt_file
from presswork.case.units import LENGTH, unit_factor
from presswork.geometry.polygon import contains
from presswork.geometry.tool_surface import make_surface
from presswork.mesh import MeshError
from presswork.mesh.files.tool_file import read_tool
from presswork.mesh.make.surface_offset import cut_surface, move_surface
from presswork.mesh.tool_clearance import find_touch
from presswork.model import FloatArray, Friction, Mesh, Surface, ToolKind, Triangulation
from presswork.model import Tool as ToolModel

logger = logging.getLogger(__name__)

BEYOND = 1.5
"""Extent of a face that is given no width, over the blank's radius."""

LEVEL = 1e-2
"""Part of the thickness below which a tool's face counts as level with the blank."""
CUT = 1e-4
"""How far the chords of its arcs may be off, over the extent of a line that cuts a tool."""


def build_tools(
    case: StampingCase, mesh: Mesh, before: float | None = None
) -> tuple[tuple[ToolModel, ...], list[Problem]]:
    """Draw, read and place the tools.

    before: sum of the strokes of operations before [mm], after which a tool without position stands at the origin;
    None: there are none, and it is laid on the flat blank.
    """
    radius = float(np.linalg.norm(mesh.points[:, :2], axis=1).max())
    strokes = [abs(a.stroke) for stage in case.stages for a in stage.tools.values() if a.stroke]
    depth = sum(strokes) + 10.0 * case.blank.thickest + (before or 0.0)
    folder = case.source.parent if case.source is not None else Path()
    tools, problems = [], []
    for name, tool in case.tools.items():
        shape = _make_shape(name, tool, depth, radius, folder)
        if isinstance(shape, Problem):
            problems.append(shape)
            continue
        position = _place(name, tool, shape, case, mesh) if before is None else tool.position or (0.0, 0.0, 0.0)
        if isinstance(position, Problem):
            problems.append(position)
            continue
        friction = Friction(mu=tool.mu, factors=None if tool.friction is None else tool.friction.build())
        tools.append(ToolModel(name, shape, position, friction, tool.kind, find_tool_direction(tool)))
    return tuple(tools), problems


def find_kind_direction(kind: ToolKind) -> tuple[float, float, float]:
    """Return the unit vector along which a tool works: a die upwards, punch and holder downwards."""
    return 0.0, 0.0, 1.0 if kind == "die" else -1.0


def find_tool_direction(tool: Tool) -> tuple[float, float, float]:
    """Return the unit vector along which a tool's strokes and forces count: its direction, or that of its kind."""
    if tool.direction is None:
        return find_kind_direction(tool.kind)
    x, y, z = (each / math.hypot(*tool.direction) for each in tool.direction)
    return x, y, z


def _make_shape(name: str, tool: Tool, depth: float, radius: float, folder: Path) -> Surface | Problem:
    """Draw or read a tool. depth: of its walls [mm]. radius: of the blank [mm]."""
    if not isinstance(tool, ToolFile):
        width = getattr(tool, "face_width", None)
        return draw_shape(tool, depth, BEYOND * radius if width is None else width)
    try:
        scale = unit_factor(tool.unit, LENGTH)
        read, notes = read_tool(
            folder / tool.path,
            scale=scale,
            facing=find_kind_direction(tool.kind),
            usual_size=2.0 * radius,
            tolerance=tool.tolerance,
        )
    except MeshError as error:
        return Problem(f"tools.{name}.path", error.fault, error.remedy, tool.path)
    for note in notes:
        logger.warning("tools.%s.path = %s: %s", name, tool.path, note)
    made = _move_and_cut(name, tool, read, folder)
    doubt = doubt_file(f"tools.{name}", tool, read.points, 2.0 * radius) if isinstance(made, Problem) else None
    if isinstance(made, Problem) and doubt is not None:
        return replace(made, expected=f"{made.expected}; {doubt}")
    return made


def _move_and_cut(name: str, tool: ToolFile, surface: Triangulation, folder: Path) -> Triangulation | Problem:
    """Return what is the tool of the surface in its file."""
    try:
        key: tuple[str, float | str] = "offset", tool.offset
        if tool.offset:
            surface = move_surface(surface, -tool.offset)
        if tool.cut is not None:
            key = "cut", tool.cut.shape
            line = draw_line(tool.cut, f"tools.{name}.cut", folder, CUT)
            if isinstance(line, Problem):
                return line
            surface = cut_surface(surface, line, inside=tool.cut.keep == "inside")
    except MeshError as error:
        return Problem(f"tools.{name}.{key[0]}", error.fault, error.remedy, key[1])
    return surface


def _place(
    name: str, tool: Tool, shape: Surface, case: StampingCase, mesh: Mesh
) -> tuple[float, float, float] | Problem:
    """Return where the tool's origin starts."""
    if tool.position is not None:
        return tool.position
    z = mesh.points[:, 2]
    if np.ptp(z) > 1e-6 * case.blank.thickest:
        remedy = f"give tools.{name}.position = [x, y, z]"
        return Problem(f"tools.{name}", "the blank is not flat, so the tool cannot be laid on it", remedy)
    side = -1.0 if tool.kind == "die" else 1.0
    height = float(z[0]) + side * 0.5 * case.blank.thickest - find_face(tool, shape)
    if tool.gap is not None:
        height += tool.gap - case.blank.thickest
    elif isinstance(shape, Triangulation):
        height -= side * _find_distance_to_blank(shape, height, side, mesh, case.blank.thickest)
    return (0.0, 0.0, height)


def _find_distance_to_blank(shape: Triangulation, height: float, side: float, mesh: Mesh, thickness: float) -> float:
    """Return how far a tool still goes until it touches the flat blank [mm], since its face may be curved.

    height: of its origin where the highest point of its whole face is level with the blank. side: 1 above it, -1 below.
    """
    surface, down = make_surface(shape), np.array([0.0, 0.0, -side])
    half = np.full(len(mesh.points), 0.5 * thickness)
    distance = find_touch(surface, mesh.points - [0.0, 0.0, height], half, down, float(np.ptp(shape.points[:, 2])))
    if distance is None or distance < LEVEL * thickness:
        return 0.0
    above = side * (shape.points[:, 2] + height - mesh.points[0, 2]) - half[0]
    near = np.flatnonzero(above < distance)
    inside = contains(mesh.points[mesh.boundary_edges[:, :2], :2], shape.points[near, :2])
    return float(above[near[inside]].min(initial=distance))


def find_face(tool: Tool, shape: Surface) -> float:
    """Return how high the working face lies over the tool's origin."""
    if not isinstance(tool, ToolFile):
        return 0.0
    assert isinstance(shape, Triangulation)
    z: FloatArray = shape.points[:, 2]
    return float(z.max() if tool.kind == "die" else z.min())
