# SPDX-License-Identifier: Apache-2.0
"""The Model's tools in space from a case's: drawn or read, directed to the workpiece, clear of it."""

from __future__ import annotations

import functools
import logging
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from presswork.case.errors import Problem
from presswork.case.space.tool_checks import check_facets, check_mirrors, look_inside_faces, mean_edge
from presswork.case.space.tools import (
    BoxTool,
    CylinderTool,
    PlaneTool,
    ProfileTool,
    SpaceTool,
    SphereTool,
    ToolFile,
    unit_vector3,
)
from presswork.case.tools.builder import find_centre, is_backwards
from presswork.case.tools.profile import ProfileError, draw_outline
from presswork.case.units import LENGTH, unit_factor
from presswork.geometry.crossing import find_crossing
from presswork.geometry.pose import SpacePose, find_axis, find_space_pose
from presswork.geometry.segments import TURN, X0, X1, reverse_segments, sample_arc
from presswork.geometry.swept_tool import draw_block
from presswork.geometry.tool_surface import list_extreme_points, make_surface
from presswork.geometry.touch_in_space import Nearest, find_touch_in_space
from presswork.mesh import MeshError
from presswork.mesh.files.tool_file import read_tool
from presswork.mesh.triangles import double_areas
from presswork.model import (
    FloatArray,
    Friction,
    Mesh,
    Plane,
    Spring,
    Surface,
    SweptProfile,
    Tool,
    Triangulation,
    find_direction,
)

if TYPE_CHECKING:
    from presswork.case.space.schema import SpaceCase

logger = logging.getLogger(__name__)

TOLERANCE = 1e-6
"""How deep a node may lie in a tool at the start, over the size of the workpiece."""
CHORD_OF_FACE = 0.05
"""Depth of a tool in a face whose nodes lie on it, as on a round of the tool, over the mean edge of cells."""
CHORD = 1e-4
"""How far the facets of a straight tool may lie off its arcs, over the size of the workpiece."""
FACING = 0.01
"""Share of an open surface's area, on balance, that must face against the tool's motion for it to be turned over."""
BEYOND = 5.0
"""Half the length of a straight tool, over the size of the workpiece."""


def build_tool(
    name: str, tool: SpaceTool, mesh: Mesh, mirrors: tuple[FloatArray, ...], folder: Path, direction: FloatArray
) -> Tool | Problem:
    """Build a tool, or return the problem that prevents it.

    mirrors: positions of the symmetry planes normal to x, y and z [mm]. folder: what the path of a file is relative to.
    direction: direction of the tool's first motion (3,), zero where it has none.
    """
    nodes = mesh.points[np.unique(mesh.boundary_faces)]
    size = float(np.linalg.norm(np.ptp(nodes, axis=0)))
    shape = _make_shape(name, tool, mesh, direction, folder)
    if isinstance(shape, Problem):
        return shape
    drawn = _place(name, tool, shape)
    if tool.position == "touch":
        for places in (nodes, np.concatenate([nodes, look_inside_faces(mesh)[0]])):
            position = _come_from_afar(drawn, places, direction)
            if position is None:
                return _explain_no_touch(name, direction)
            touching = replace(drawn, position=position)
            if _check_clear(name, mesh, size, _look_at(touching)) is None:  # else it is between the nodes of a face
                break
        drawn = touching
    start, nearest = find_space_pose(drawn, np.zeros(3)), _look_at(drawn)
    problem = _check_clear(name, mesh, size, nearest)
    if problem is not None:
        return _turn_plane_over(problem, tool, nearest(nodes, math.inf)[0], size)
    cut = _find_mirrors(drawn, start, mirrors, size)
    for axis in range(3):
        if tool.shape == "round" and cut[axis]:
            plane, along = f"{'xyz'[axis]} = {mirrors[axis][0]:g}", start.turn(np.eye(3)[2:])[0, axis]
            beside = abs(drawn.position[axis] - mirrors[axis][0]) > TOLERANCE * size or abs(along) > 1e-9
            if beside:
                return Problem(
                    f"tools.{name}.position",
                    f"the symmetry plane {plane} cuts this round tool beside its axis, so it has no mirror image of "
                    "itself",
                    f"put its axis on {plane}, or model the whole workpiece",
                    list(drawn.position),
                )
    return check_mirrors(name, drawn, start, mirrors, cut, nodes) or replace(drawn, mirrored_across=cut)


def list_arcs(tool: SpaceTool, shape: Surface) -> FloatArray:
    """Return the segments that a tool of a drawn shape is swept from (n, 7) [mm]; none of planes and facets."""
    if isinstance(tool, ProfileTool):
        return draw_outline(tool.profile, False).segments
    return shape.segments if isinstance(shape, SweptProfile) else np.zeros((0, 7))


def _place(name: str, tool: SpaceTool, shape: Surface) -> Tool:
    """Return a tool that stands as its keys place it, without what depends on the workpiece."""
    centre = tool.centre
    if centre is None and isinstance(tool, ProfileTool) and tool.shape == "straight":
        own = find_centre(draw_outline(tool.profile, False).segments)
        centre = (own[0], 0.0, own[1]) if own else None
    spring = None
    if tool.spring is not None:
        spring = Spring(tool.spring.stiffness, tool.spring.preload, unit_vector3(tool.spring.direction))
    return Tool(
        name,
        shape,
        (0.0, 0.0, 0.0) if tool.position == "touch" else tool.position,
        Friction(tool.contact, tool.m, tool.mu, None if tool.friction is None else tool.friction.build()),
        centre=centre or (0.0, 0.0, 0.0),
        axis=tool.turning_axis or (0.0, 0.0, 1.0),
        rotation=tool.rotation.build() if tool.rotation is not None else (0.0, 0.0, 0.0),
        spring=spring,
        wear=None if tool.wear is None else tool.wear.build(),
    )


def _look_at(tool: Tool) -> Nearest:
    """Return what gives gap and normal of a tool where it starts."""
    surface, pose = make_surface(tool.surface), find_space_pose(tool, np.zeros(3))

    def nearest(points: FloatArray, reach: float) -> tuple[FloatArray, FloatArray]:
        gap, normal, *_ = surface.nearest(np.ascontiguousarray(pose.to_frame(points)), reach)
        return gap, pose.turn(normal)

    return nearest


def _come_from_afar(tool: Tool, places: FloatArray, direction: FloatArray) -> tuple[float, float, float] | None:
    """Return the position at which a tool from afar, along `way`, first touches a place (n, 3);
    None: never."""
    if not direction.any():
        return None
    shape, pose = tool.surface, find_space_pose(tool, np.zeros(3))
    corners = np.zeros((1, 3)) if isinstance(shape, Plane) else pose.carry(list_extreme_points(shape))
    size = float(np.linalg.norm(np.ptp(places, axis=0)))
    afar = size + float(np.linalg.norm(corners, axis=1).max() + np.linalg.norm(places, axis=1).max())
    gone = find_touch_in_space(_look_at(tool), places + afar * direction, direction)
    if gone is None:
        return None
    x, y, z = (float(part) for part in (gone - afar) * direction)
    return x, y, z


def _explain_no_touch(name: str, direction: FloatArray) -> Problem:
    """Explain why a tool cannot be put where it touches the workpiece."""
    key = f"tools.{name}.position"
    if not direction.any():
        remedy = "give a stage in which the tool has a stroke, move or force, or position = [x, y, z]"
        return Problem(key, "no tool moves, so it is not known from where this one comes", remedy, "touch")
    x, y, z = direction
    fault = f"along its first motion, ({x:g}, {y:g}, {z:g}), the tool passes beside the workpiece"
    return Problem(key, fault, "draw it in line with the workpiece, or give position = [x, y, z]", "touch")


def _turn_plane_over(problem: Problem, tool: SpaceTool, gap: FloatArray, size: float) -> Problem:
    """Return the problem of a tool in the workpiece; of a plane whose back all of it is at, with the other normal."""
    if not isinstance(tool, PlaneTool) or gap.max() > TOLERANCE * size:
        return problem
    normal = ", ".join(f"{-x + 0.0:g}" for x in tool.normal)
    fault = "the whole workpiece lies behind the plane: the metal is on the side that its normal points to"
    return Problem(f"{problem.key}.normal", fault, f"write normal = [{normal}]", list(tool.normal))


def _check_clear(name: str, mesh: Mesh, size: float, nearest: Nearest) -> Problem | None:
    """Return a problem where the boundary lies in a tool at the start: a node, or a place on a face.

    nearest: gap and normal of places (n, 3) within a reach. Faces with nodes on the tool are chords of its rounds.
    """
    nodes = np.unique(mesh.boundary_faces)
    on_faces, face = look_inside_faces(mesh)
    own, places = len(nodes), np.concatenate([mesh.points[nodes], on_faces])
    gap, normal = nearest(places, size)
    touches = np.zeros(len(mesh.points), dtype=bool)
    touches[nodes] = np.abs(gap[:own]) <= TOLERANCE * size
    is_chord = touches[mesh.boundary_faces].sum(axis=1) >= 2
    allowed = np.full(len(places), TOLERANCE * size)
    allowed[own:][is_chord[face]] += CHORD_OF_FACE * mean_edge(mesh)
    is_inside = gap < -allowed
    if not is_inside.any():
        return None
    deepest = int(np.argmin(np.where(is_inside, gap, np.inf)))
    place = ", ".join(f"{x:.6g}" for x in places[deepest])
    away = ", ".join(f"{gap[deepest] * x if abs(x) > 1e-6 else 0.0:.6g}" for x in normal[deepest])
    return Problem(
        f"tools.{name}",
        f"the tool starts inside the workpiece: {int(is_inside[:own].sum())} boundary nodes lie in "
        f"it, the deepest {'' if deepest < own else 'place of a face '}{-gap[deepest]:.6g} mm at ({place})",
        f"move the tool by ({away}) mm, or turn its surface over if its metal is on the other side",
    )


def find_first_direction(case: SpaceCase, name: str) -> FloatArray:
    """Return the direction of a tool's first motion (3,), of length 1; zero where it has none.

    A tool that stands and is to touch the workpiece comes against the first motion of any other tool.
    """
    own = _find_first_motion(case, [name])
    if own.any() or case.tools[name].position != "touch":
        return own
    return np.asarray(0.0 - _find_first_motion(case, list(case.tools)))


def _find_first_motion(case: SpaceCase, names: Sequence[str]) -> FloatArray:
    """Return the direction of the first motion of any of the tools (3,), of length 1; zero where they have none."""
    for stage in case.stages:
        for name in names:
            motion = stage.tools[name].build() if name in stage.tools else None
            if motion is not None and (motion.push is not None or any(motion.move)):
                return find_direction(motion)
    return np.zeros(3)


def check_motions(case: SpaceCase, tools: Sequence[Tool]) -> list[Problem]:
    """Return the problems of motions that do not fit the tools."""
    problems = []
    for index, stage in enumerate(case.stages):
        for tool in tools:
            motion, key = stage.tools.get(tool.name), f"stages.{index}.tools.{tool.name}"
            if motion is None:
                continue
            if motion.turn and case.tools[tool.name].turning_axis is None:
                remedy = f"set tools.{tool.name}.axis = [x, y, z], and centre where it misses the origin"
                problems.append(
                    Problem(f"{key}.turn", "the tool turns, and its axis is not given", remedy, motion.turn)
                )
            axis, mirrors = np.abs(find_axis(tool)), np.array(tool.mirrored_across)
            if motion.turn and (axis[mirrors] < 1.0 - 1e-9).any():
                fault = (
                    "the tool and its mirror image cannot turn about an axis that their symmetry plane does not cross"
                )
                remedy = "model the whole workpiece, or turn about the normal of the symmetry plane"
                problems.append(Problem(f"{key}.turn", fault, remedy, motion.turn))
            push = motion.build().push
            if push is not None and np.array(push.direction)[mirrors].any():
                fault = "the tool and its mirror image cannot be pushed across their symmetry plane"
                remedy = "push along the symmetry plane, or model the whole workpiece"
                problems.append(Problem(f"{key}.direction", fault, remedy, list(push.direction)))
            if push is not None and tool.spring is not None:
                fault = "the tool rests on a spring, and a force pushes it"
                problems.append(Problem(f"{key}.force", fault, f"leave it or tools.{tool.name}.spring out"))
    return problems


def _draw_block(tool: CylinderTool | SphereTool | BoxTool) -> SweptProfile:
    """Draw a body of given dimensions."""
    if isinstance(tool, BoxTool):
        x, y, z = tool.size
        return draw_block((0.5 * x, 0.5 * y), tool.edge_radius, z, tool.edge_radius)
    r = tool.radius
    if isinstance(tool, SphereTool):
        return draw_block((r, r), r, 2.0 * r, r)
    return draw_block((r, r), r, tool.length, tool.edge_radius)


def _make_shape(name: str, tool: SpaceTool, mesh: Mesh, direction: FloatArray, folder: Path) -> Surface | Problem:
    nodes = mesh.points[np.unique(mesh.boundary_faces)]
    size = float(np.linalg.norm(np.ptp(nodes, axis=0)))
    if isinstance(tool, PlaneTool):
        x, y, z = (part / math.hypot(*tool.normal) + 0.0 for part in tool.normal)
        return Plane((x, y, z))
    if isinstance(tool, ProfileTool):
        return _draw(name, tool, nodes, size, direction)
    if isinstance(tool, CylinderTool | SphereTool | BoxTool):
        return _draw_block(tool)
    try:
        scale = unit_factor(tool.unit, LENGTH)
        read, notes = read_tool(folder / tool.path, scale=scale, usual_size=size, tolerance=tool.tolerance)
    except ValueError as error:
        return Problem(f"tools.{name}.unit", f"expected a unit of length, but {error}", "e.g. mm, m, inch", tool.unit)
    except MeshError as error:
        return Problem(f"tools.{name}.path", error.fault, error.remedy, tool.path)
    for note in notes:
        _warn_once(folder / tool.path, f"tools.{name}.path = {tool.path}: {note}")
    if tool.position == "touch":
        read = _face(name, tool, read, direction)
    return check_facets(name, tool.path, read, mean_edge(mesh)) or read


def _face(name: str, tool: ToolFile, shape: Triangulation, direction: FloatArray) -> Triangulation:
    """Return a tool's surface, turned over where it is open and faces against the tool's motion (3,)."""
    areas = find_space_pose(_place(name, tool, shape), np.zeros(3)).turn(double_areas(shape.points, shape.triangles))
    if shape.is_closed or areas.sum(axis=0) @ direction >= -FACING * float(np.linalg.norm(areas, axis=1).sum()):
        return shape
    logger.warning(
        "tools.%s.path = %s: the open surface faces against the tool's motion, into its metal: turned over",
        name,
        tool.path,
    )
    return replace(shape, triangles=np.ascontiguousarray(shape.triangles[:, ::-1]))


@functools.lru_cache(maxsize=1000)
def _warn_once(path: Path, note: str) -> None:
    """Log a note on the file of a tool once, however often its model is built."""
    logger.warning("%s", note, extra={"path": path})


def _draw(name: str, tool: ProfileTool, nodes: FloatArray, size: float, direction: FloatArray) -> Surface | Problem:
    """Draw a profile with the workpiece on its left, where it starts, and turn or draw it out."""
    try:
        segments = draw_outline(tool.profile, False).segments
    except ProfileError as error:
        value = list(tool.profile[error.point].to)
        return Problem(f"tools.{name}.profile.{error.point}", error.fault, error.remedy, value)
    crossing = find_crossing(segments)
    if crossing is not None:
        a, b = crossing.point
        fault = f"the profile crosses or touches itself at ({a:.6g}, {b:.6g})"
        return Problem(f"tools.{name}.profile", fault, "draw an outline without loops")
    pose = find_space_pose(_place(name, tool, Plane((0.0, 0.0, 1.0))), np.zeros(3))
    ahead = np.zeros(3)
    if tool.position == "touch":
        # drawn where it closes, it has the workpiece on both sides; where it comes from, all of it lies before the tool
        ends = np.insert(segments[:, 0:4].reshape(-1, 2), 1, 0.0, axis=1)
        if tool.shape == "round":
            ends = list_extreme_points(_turn(segments))
        ahead = (float((pose.carry(ends) @ direction).max() - (nodes @ direction).min()) + size) * direction
    seen = pose.to_frame(nodes + ahead)
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


def _find_mirrors(tool: Tool, pose: SpacePose, mirrors: tuple[FloatArray, ...], size: float) -> tuple[bool, bool, bool]:
    """Return for x, y and z whether a symmetry plane normal to it cuts a tool, which is then twice what is modelled.

    Between two planes a slice is modelled, and nothing is cut in half.
    """
    cut, shape = [], tool.surface
    for axis, planes in enumerate(mirrors):
        if len(planes) != 1:
            cut.append(False)
            continue
        if isinstance(shape, Plane):  # one across the plane leaves it whole
            cut.append(abs(pose.turn(np.array([shape.normal]))[0, axis]) < 1.0 - 1e-9)
            continue
        reach = pose.carry(list_extreme_points(shape))[:, axis]
        low, high = float(reach.min()), float(reach.max())
        cut.append(low < planes[0] + 1e-6 * size and high > planes[0] - 1e-6 * size)
    return cut[0], cut[1], cut[2]
