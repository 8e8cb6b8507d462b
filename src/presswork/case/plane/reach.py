# SPDX-License-Identifier: Apache-2.0
"""Whether the tools' motions bring them to the workpiece."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from presswork import _core
from presswork.case.errors import Problem
from presswork.geometry.pose import find_space_pose, start_profile
from presswork.geometry.tool_surface import make_surface
from presswork.model import FloatArray, Mesh, Profile, Stage, Support, Tool, ToolMotion

BoolArray = NDArray[np.bool_]

logger = logging.getLogger(__name__)

TOLERANCE = 1e-6
"""Distance up to which a tool counts as touching, over the size of the workpiece."""
ROOM = 1e-3
"""Room that must be left between a tool and held nodes, over the size of the workpiece."""
ALONG = 0.05
"""Component of a tool's normal, across the direction that is held, up to which a node cannot slide out of the tool's
path."""
_SAMPLES = 16
"""Places along each stage's motion where the distance to the workpiece is taken."""
_PLACES = 128
"""Places along it where nodes are sought that the tool meets."""


def check_reach(tools: Sequence[Tool], stages: Sequence[Stage], mesh: Mesh) -> list[Problem]:
    """Return a problem when nothing can ever happen: no tool that moves ever touches a node of the workpiece.

    That is certain only where nothing else moves or loads the workpiece. Where something does, a tool that never comes
    nearer than it starts is a warning in the log.
    """
    sides = mesh.boundary_edges if mesh.points.shape[1] == 2 else mesh.boundary_faces
    nodes = mesh.points[np.unique(sides)]
    tolerance = TOLERANCE * float(np.linalg.norm(np.ptp(nodes, axis=0)))
    moving = [tool for tool in tools if any(_moves(stage.tool_motion.get(tool.name)) for stage in stages)]
    approach = {tool.name: _approach(tool, stages, nodes) for tool in moving}
    leaving = [tool for tool in moving if _leaves(*approach[tool.name], tolerance)]
    loaded = any(s.prescribed or s.forces or s.pressures or s.face_forces or s.face_pressures for s in stages)
    loaded = loaded or any(tool.spring is not None for tool in tools)
    nearest = {name: min(gaps) for name, gaps in approach.items()}
    if moving and not loaded and all(tool in leaving or nearest[tool.name] > tolerance for tool in moving):
        first = min(moving, key=lambda tool: nearest[tool.name])
        stage = next(i for i, stage in enumerate(stages) if _moves(stage.tool_motion.get(first.name)))
        how = f"it comes no nearer to a node than {nearest[first.name]:.6g} mm"
        if first in leaving:
            how = "it only moves away from it"
        return [
            Problem(
                f"stages.{stage}.tools.{first.name}",
                f"the tool never reaches the workpiece: {how}, and nothing else moves",
                "lengthen the stroke, turn it round, mend the profile, or refine the mesh under a narrow tool",
            )
        ]
    for tool in leaving:
        logger.warning("tools.%s: the tool moves, but never comes nearer to the workpiece than it starts", tool.name)
    return []


def check_room(
    tools: Sequence[Tool], stages: Sequence[Stage], supports: Sequence[Support], mesh: Mesh
) -> list[Problem]:
    """Return a problem for each tool that is driven through nodes that supports hold: no metal fits between.

    A node gives way to the surface of the tool that meets it first, unless it is held across that surface. Only tools
    whose path is known, by strokes and moves, are checked.
    """
    held = np.zeros((len(mesh.points), 2), dtype=bool)
    for support in supports:
        held[mesh.node_sets[support.node_set]] |= support.fix[:2]
    for entry in (entry for stage in stages for entry in stage.prescribed):
        held[mesh.node_sets[entry.node_set], entry.component] = False
    chosen = np.flatnonzero(held.any(axis=1))
    if len(chosen) == 0:
        return []
    tolerance = ROOM * float(np.linalg.norm(np.ptp(mesh.points, axis=0)))
    problems = []
    for tool in tools:
        motions = [stage.tool_motion.get(tool.name, ToolMotion()) for stage in stages]
        if tool.spring is not None or any(m.turn or m.push is not None or m.start is not None for m in motions):
            continue
        place, ahead = np.zeros(2), chosen[_touch(tool, mesh.points[chosen], tolerance)[0] > 0.0]
        for index, move in enumerate(np.array(motion.move[:2]) for motion in motions):
            nodes = mesh.points[ahead]
            part, normal = _find_meetings(tool, nodes, place, move, tolerance)
            across = np.linalg.norm(np.where(held[ahead], 0.0, normal), axis=1)
            against = np.flatnonzero((part <= 1.0) & (across < ALONG))
            if len(against):
                first = against[np.argmin(part[against])]
                problems.append(_explain_room(tool, index, nodes[first], float(part[first]), move))
                break
            place, ahead = place + move, ahead[part > 1.0]
    return problems


def _touch(tool: Tool, nodes: FloatArray, tolerance: float) -> tuple[FloatArray, FloatArray]:
    """Return how far nodes are from touching a tool [mm], below 0 where they touch it, and its normal there (n, 2)."""
    gap, normal, *_ = _core.touch_profile(start_profile(tool), nodes)
    return gap - tolerance, normal


def _find_meetings(
    tool: Tool, nodes: FloatArray, place: FloatArray, move: FloatArray, tolerance: float
) -> tuple[FloatArray, FloatArray]:
    """Return the part of a tool's move at which it meets each node (n,), infinite where never, and its normal then."""
    before, after = np.zeros(len(nodes)), np.full(len(nodes), np.inf)
    for part in np.linspace(0.0, 1.0, _PLACES + 1)[1:] if move.any() else ():
        waiting = np.isinf(after)
        met = waiting & (_touch(tool, nodes - place - part * move, tolerance)[0] <= 0.0)
        after[met] = part
        before[waiting & ~met] = part
    normal = np.zeros_like(nodes)
    found = np.flatnonzero(np.isfinite(after))
    if len(found) == 0:
        return after, normal
    for _ in range(30):
        middle = 0.5 * (before[found] + after[found])
        met = _touch(tool, nodes[found] - place - middle[:, None] * move, tolerance)[0] <= 0.0
        after[found[met]], before[found[~met]] = middle[met], middle[~met]
    normal[found] = _touch(tool, nodes[found] - place - after[found, None] * move, tolerance)[1]
    return after, normal


def _explain_room(tool: Tool, stage: int, node: FloatArray, part: float, move: FloatArray) -> Problem:
    """Describe where a tool meets a held node, and its travel until then."""
    (x, y), stroke = node, float(np.linalg.norm(move))
    return Problem(
        f"stages.{stage}.tools.{tool.name}",
        f"after {part * stroke:.4g} of its {stroke:.4g} mm the tool meets nodes that are held against it, at "
        f"({x:.4g}, {y:.4g}): no metal fits between",
        "shorten the stroke, or release these nodes",
    )


def _moves(motion: ToolMotion | None) -> bool:
    return motion is not None and motion.moves


def _leaves(first: float, later: float, tolerance: float) -> bool:
    """Return whether a tool never comes nearer than it starts, and touches nothing once it has moved."""
    return later >= first - tolerance and later > tolerance


def _approach(tool: Tool, stages: Sequence[Stage], nodes: FloatArray) -> tuple[float, float]:
    """Return the least gap of a tool to the nodes at its start, and later on its path [mm].

    The path of a tool that turns, that a force pushes or that a stage places anew is not known: 0.
    """
    motions = [stage.tool_motion.get(tool.name, ToolMotion()) for stage in stages]
    place = np.zeros(nodes.shape[1])
    distance = _measure_in_plane(tool) if isinstance(tool.shape, Profile) else _measure_in_space(tool)
    first = distance(nodes)
    if any(m.turn != 0.0 or m.push is not None or m.start is not None for m in motions):
        return first, 0.0
    later = np.inf
    for motion in motions:
        move = np.array(motion.move[: len(place)])
        for fraction in np.linspace(0.0, 1.0, _SAMPLES + 1)[1:] if move.any() else ():
            later = min(later, distance(nodes - (place + fraction * move)))
        place = place + move
    return first, later


def _measure_in_plane(tool: Tool) -> Callable[[FloatArray], float]:
    """Return what gives the least gap of nodes to a tool where it starts [mm]; infinite if it faces none of them."""

    def measure(nodes: FloatArray) -> float:
        gap, _, second_gap, *_ = _core.touch_profile(start_profile(tool), nodes)
        return float(min(gap.min(), second_gap.min()))

    return measure


def _measure_in_space(tool: Tool) -> Callable[[FloatArray], float]:
    """Return the same of a tool in space."""
    surface, pose = make_surface(tool.surface), find_space_pose(tool, np.zeros(3))
    return lambda places: float(surface.nearest(np.ascontiguousarray(pose.to_frame(places)))[0].min())
