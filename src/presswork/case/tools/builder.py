# SPDX-License-Identifier: Apache-2.0
"""The Model's tools from a case's: the profile directed with the workpiece on its left, clear of the workpiece."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np

from presswork.case.errors import Problem
from presswork.case.plane import schema
from presswork.case.plane.tool import Tool as CaseTool
from presswork.case.plane.tool import unit_vector
from presswork.case.tools.profile import Outline, ProfileError, draw_outline
from presswork.case.tools.profile_file import read_outline
from presswork.geometry.asymmetry import HalfSpace, find_asymmetry
from presswork.geometry.chain import ProfileFileError
from presswork.geometry.crossing import find_crossing
from presswork.geometry.pose import shift_segments, start_profile
from presswork.geometry.segments import (
    CENTRE,
    TURN,
    X0,
    X1,
    find_touch,
    measure_distance,
    reverse_segments,
    sample_points,
)
from presswork.model import FloatArray, Friction, Mesh, Profile, Spring, Tool

UNLIKE, OVER = 1e-3, 0.1
"""How far two halves of a profile may differ, and how far a half profile may reach over the symmetry plane, over the
size of the workpiece."""
TOLERANCE = 1e-6
"""How deep a node may lie in a tool at the start, over the size of the workpiece."""


def build_tool(
    name: str,
    tool: CaseTool,
    mesh: Mesh,
    symmetry_planes: tuple[FloatArray, FloatArray],
    folder: Path,
    first_direction: tuple[float, float] = (0.0, 0.0),
    *,
    is_axisymmetric: bool = False,
) -> Tool | Problem:
    """Build a tool, or return the problem that prevents it.

    symmetry_planes: positions [mm] of the symmetry planes normal to x and to y; both empty in axisymmetry. folder: what
    the path of a profile file is relative to. first_direction: of the tool's first motion, zero where it has none.
    is_axisymmetric: of the section of a model in STEP the half r >= 0 counts.
    """
    outline = _draw(name, tool, folder, is_axisymmetric)
    if isinstance(outline, Problem):
        return outline
    problem = _check_crossing(name, tool, outline)
    if problem is not None:
        return problem
    nodes = mesh.points[np.unique(mesh.boundary_edges)]
    place = _find_place(name, tool, outline.segments, nodes, np.array(first_direction))
    if isinstance(place, Problem):
        return place
    segments = shift_segments(outline.segments, place)
    m, mu = np.where(np.isnan(outline.m), tool.m, outline.m), np.where(np.isnan(outline.mu), tool.mu, outline.mu)
    size = float(np.linalg.norm(np.ptp(nodes, axis=0)))
    drawn = outline.segments
    backwards = is_backwards(name, tool.free_side, nodes, segments)
    if isinstance(backwards, Problem):
        return backwards
    if backwards:
        drawn, m, mu = reverse_segments(drawn), m[::-1].copy(), mu[::-1].copy()
        segments = shift_segments(drawn, place)
    problem = _check_clear(_key(name, tool), nodes, segments, TOLERANCE * size)
    if problem is not None:
        return problem
    mirrored = _find_mirrors(segments, symmetry_planes, TOLERANCE * size)
    if tool.mirrored is not None:
        mirrored = ("x" in tool.mirrored, "y" in tool.mirrored)
    halves = {axis: symmetry_planes[axis] for axis in range(2) if mirrored[axis] and len(symmetry_planes[axis])}
    unlike = _check_mirrors(_key(name, tool), segments, nodes, {0: np.zeros(1)} if is_axisymmetric else halves)
    if unlike is not None:
        return unlike
    spring = None
    if tool.spring:
        direction = unit_vector(tool.spring.direction)
        spring = Spring(tool.spring.stiffness, tool.spring.preload, direction)
    return Tool(
        name,
        Profile(drawn),
        (float(place[0]), float(place[1]), 0.0),
        Friction(tool.contact, m, mu, None if tool.friction is None else tool.friction.build()),
        centre=tool.centre or find_centre(drawn) or (0.0, 0.0),
        spring=spring,
        mirrored_across=mirrored,
        wear=None if tool.wear is None else tool.wear.build(),
    )


def _find_place(
    name: str, tool: CaseTool, segments: FloatArray, nodes: FloatArray, direction: FloatArray
) -> FloatArray | Problem:
    """Return how far a tool is moved from where it is drawn to where it starts (2) [mm]."""
    if tool.position != "touch":
        return np.array(tool.position or (0.0, 0.0))
    key = f"tools.{name}.position"
    if not direction.any():
        remedy = "give a stage in which the tool has a stroke, move or force, or position = [x, y]"
        return Problem(key, "no tool moves, so it is not known from where this one comes", remedy, "touch")
    drawn = measure_distance(nodes, segments)
    sides = drawn.distance[drawn.beside]
    size = float(np.linalg.norm(np.ptp(nodes, axis=0)))
    back = 0.0
    if len(sides) and sides.min() < -TOLERANCE * size and sides.max() > TOLERANCE * size:
        # drawn where it closes, through the workpiece: it comes from where all of it lies before that
        back = max(float((segments[:, 0:4].reshape(-1, 2) @ direction).max() - (nodes @ direction).min()), 0.0) + size
    gone = find_touch(nodes, shift_segments(segments, -back * direction), direction)
    if gone is not None:
        return np.asarray((gone - back) * direction)
    x, y = direction
    fault = f"along its first motion, ({x:g}, {y:g}), the tool passes the workpiece or never touches it"
    return Problem(key, fault, "draw it on the side that it comes from, or give position = [x, y]", "touch")


def find_first_direction(case: schema.Case, name: str) -> tuple[float, float]:
    """Return the direction of a tool's first motion, of length 1; zero where it has none.

    A tool that stands and is to touch the workpiece comes against the first motion of any other tool.
    """
    x, y = _find_first_motion(case, [name])
    if x or y or case.tools[name].position != "touch":
        return x, y
    x, y = _find_first_motion(case, list(case.tools))
    return -x, -y


def _find_first_motion(case: schema.Case, names: Sequence[str]) -> tuple[float, float]:
    """Return the direction of the first motion of any of the tools, of length 1; zero where they have none."""
    for stage in case.stages:
        for name in names:
            motion = stage.tools[name].build() if name in stage.tools else None
            x, y = (motion.push.direction if motion.push else motion.move[:2]) if motion else (0.0, 0.0)
            if x or y:
                return unit_vector((x, y))
    return 0.0, 0.0


def check_motions(case: schema.Case, tools: Sequence[Tool]) -> list[Problem]:
    """Return the problems of motions that do not fit the tools."""
    problems = []
    for index, stage in enumerate(case.stages):
        for tool in tools:
            motion, key = stage.tools.get(tool.name), f"stages.{index}.tools.{tool.name}"
            if motion is None:
                continue
            if motion.turn and case.tools[tool.name].centre is None and find_centre(start_profile(tool)) is None:
                remedy = f"set tools.{tool.name}.centre = [x, y]"
                problems.append(
                    Problem(f"{key}.turn", "the tool turns, and its centre is not given", remedy, motion.turn)
                )
            if motion.turn and case.analysis == "axisymmetric":
                remedy = "leave turn out, or take plane strain"
                problems.append(Problem(f"{key}.turn", "a ring cannot turn in its plane", remedy, motion.turn))
            push = motion.build().push
            across = push.direction if push else (0.0, 0.0)
            if any(part and mirrored for part, mirrored in zip(across, tool.mirrored_across, strict=True)):
                remedy = "push along the symmetry plane, or set mirrored = []"
                fault = "the tool and its mirror image cannot be pushed across their symmetry plane"
                problems.append(Problem(f"{key}.direction", fault, remedy, list(across)))
    return problems


def find_centre(segments: FloatArray) -> tuple[float, float] | None:
    """Return the centre that all the arcs of a profile share; None if there is none."""
    centres = segments[segments[:, TURN] != 0.0][:, CENTRE]
    if len(centres) == 0 or np.ptp(centres, axis=0).max() > 1e-6 * float(np.abs(segments).max()):
        return None
    return float(centres[0, 0]), float(centres[0, 1])


def _key(name: str, tool: CaseTool) -> str:
    """Return the key that gives a tool's profile."""
    return f"tools.{name}.{'profile' if tool.profile_file is None else 'profile_file'}"


def _draw(name: str, tool: CaseTool, folder: Path, is_axisymmetric: bool) -> Outline | Problem:
    """Draw a tool's profile from its points or its file; of a section of a model the half that revolves."""
    if tool.profile_file is not None:
        try:
            return read_outline(folder / tool.profile_file, tool, is_half=is_axisymmetric)
        except ProfileFileError as error:
            return Problem(_key(name, tool), error.fault, error.remedy, tool.profile_file)
    assert tool.profile is not None
    try:
        return draw_outline(
            tool.profile,
            tool.closed,
            spline=tool.curve == "spline",
            corner_angle=tool.corner_angle,
            tolerance=tool.tolerance,
        )
    except ProfileError as error:
        value = tool.profile[error.point].to
        return Problem(f"tools.{name}.profile.{error.point}", error.fault, error.remedy, list(value))


def _check_crossing(name: str, tool: CaseTool, outline: Outline) -> Problem | None:
    """Return a problem when the profile crosses or touches itself."""
    crossing = find_crossing(outline.segments)
    if crossing is None:
        return None
    x, y = crossing.point
    first, second = outline.pieces[crossing.first], outline.pieces[crossing.second]
    return Problem(
        _key(name, tool),
        f"the profile crosses or touches itself at ({x:.6g}, {y:.6g}): {first} and {second} meet there",
        "draw an outline without loops",
    )


def is_backwards(
    name: str, free_side: Literal["auto", "left", "right"], nodes: FloatArray, segments: FloatArray
) -> bool | Problem:
    """Return whether a profile is drawn with its tool's metal on the left; auto: with the workpiece's nodes on the
    right.

    nodes (n, 2) [mm] of the workpiece and segments (n, 7) of the profile are in one frame.
    """
    if free_side != "auto":
        return free_side == "right"
    balance = _weigh_sides(nodes, segments)
    if abs(balance) < 1e-9 * float(np.linalg.norm(np.ptp(nodes, axis=0))):
        return Problem(
            f"tools.{name}.free_side",
            "the workpiece does not show which side of the profile is free",
            'set free_side = "left" or "right", seen along the profile as drawn',
            free_side,
        )
    return balance < 0.0


def _weigh_sides(nodes: FloatArray, segments: FloatArray) -> float:
    """Return the mean signed distance [mm] of the workpiece: positive when it lies left of the profile.

    Nodes nearest to an end of the profile count only when there are no others.
    """
    place = measure_distance(nodes, segments)
    chosen = place.beside & (np.abs(place.distance) > 0.0)
    return float(np.mean(place.distance[chosen] if chosen.any() else place.distance))


def _check_clear(key: str, nodes: FloatArray, segments: FloatArray, tolerance: float) -> Problem | None:
    """Return a problem when the tool starts inside the workpiece."""
    place = measure_distance(nodes, segments)
    inside = place.beside & (place.distance < -tolerance)
    if not inside.any():
        return None
    deepest = int(np.argmin(np.where(inside, place.distance, np.inf)))
    depth, (x, y) = -float(place.distance[deepest]), nodes[deepest]
    away_x, away_y = -depth * place.outwards[deepest] + 0.0
    return Problem(
        key,
        f"the tool starts inside the workpiece: {int(inside.sum())} boundary nodes lie in it, the deepest "
        f"{depth:.6g} mm at ({x:.6g}, {y:.6g})",
        f"move the tool by ({away_x:.6g}, {away_y:.6g}) mm, or set free_side if its metal is on the other side",
    )


def _check_mirrors(key: str, segments: FloatArray, nodes: FloatArray, planes: dict[int, FloatArray]) -> Problem | None:
    """Return a problem where a symmetry plane, or the axis, cuts a profile whose halves differ beside the workpiece.

    planes: positions [mm] by the axis that they are normal to. A profile that ends there, or a little beyond, or runs
    straight on to its end there, is one of a half.
    """
    size = float(np.linalg.norm(np.ptp(nodes, axis=0)))
    places = np.concatenate(
        [sample_points(segments), 0.5 * (segments[:, X0] + segments[:, X1])[segments[:, TURN] == 0.0]]
    )
    window = nodes.min(axis=0) - size, nodes.max(axis=0) + size
    for axis, levels in planes.items():
        half = HalfSpace(axis, float(levels[0]), 1.0 if nodes[:, axis].mean() > levels[0] else -1.0)
        if _runs_straight_on(segments, places, half, UNLIKE * size):
            continue
        found = find_asymmetry(
            places, lambda at: measure_distance(at, segments).distance, half, window, OVER * size, UNLIKE * size
        )
        if found is not None:
            plane = f"{'xy'[axis]} = {half.level:g}"
            remedy = f"let {plane} halve it, end it there, or model the whole workpiece"
            return Problem(key, f"the symmetry plane {plane} cuts this profile, but {found.describe()}", remedy)
    return None


def _runs_straight_on(segments: FloatArray, places: FloatArray, half: HalfSpace, tolerance: float) -> bool:
    """Return whether all of a profile that lies beyond a plane continues the straight line that crosses it."""
    start, end = half.depth(segments[:, X0]), half.depth(segments[:, X1])
    crossing = np.flatnonzero((start * end < 0.0) & (segments[:, TURN] == 0.0))
    beyond = half.depth(places) < 0.0
    if len(crossing) != 1 or not beyond.any():
        return False
    first, last = segments[crossing[0], X0], segments[crossing[0], X1]
    normal = np.array([first[1] - last[1], last[0] - first[0]]) / np.linalg.norm(last - first)
    return bool(np.abs((places[beyond] - first) @ normal).max() < tolerance)


def _find_mirrors(
    segments: FloatArray, symmetry_planes: tuple[FloatArray, FloatArray], tolerance: float
) -> tuple[bool, bool]:
    """Return for x and y whether the profile reaches a symmetry plane, so that the whole tool is twice as large."""
    samples = sample_points(segments)
    low, high = samples.min(axis=0) - tolerance, samples.max(axis=0) + tolerance
    reached = [
        bool(((planes >= low[axis]) & (planes <= high[axis])).any()) for axis, planes in enumerate(symmetry_planes)
    ]
    return reached[0], reached[1]
