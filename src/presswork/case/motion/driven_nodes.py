# SPDX-License-Identifier: Apache-2.0
"""Nodes that a case drives into a tool that stands: no equilibrium exists there, however small the increments."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from presswork import _core
from presswork.case.errors import Problem
from presswork.geometry.pose import find_space_pose, start_profile
from presswork.geometry.tool_surface import make_surface
from presswork.model import FloatArray, Mesh, Stage, Support, Tool

ROOM = 1e-4
"""Depth in a tool beyond which nodes are driven into it, over the size of the workpiece."""
ALONG = 0.05
"""Component of a tool's normal across the directions in which a node is driven, up to which it cannot slide out."""


def list_driven_nodes(
    tools: Sequence[Tool], stages: Sequence[Stage], supports: Sequence[Support], mesh: Mesh
) -> Iterator[Problem]:
    """Yield a problem for each tool that stands and into which prescribed displacements drive nodes.

    Only nodes count whose motion across the tool is known, stage after stage, by displacements and supports.
    """
    dimension = mesh.points.shape[1]
    tolerance = ROOM * float(np.linalg.norm(np.ptp(mesh.points, axis=0)))
    still = [tool for tool in tools if tool.spring is None and not any(_moves(tool, stage) for stage in stages)]
    fixed = np.zeros((len(mesh.points), dimension), dtype=bool)
    for support in supports:
        fixed[mesh.node_sets[support.node_set]] |= support.fix[:dimension]
    place, known = mesh.points.copy(), np.ones_like(fixed)
    outside = {tool.name: _find_gap(tool, place)[0] > -tolerance for tool in still}
    for index, stage in enumerate(stages):
        is_driven = np.zeros_like(fixed)
        for entry in stage.prescribed:
            if entry.component < dimension:
                nodes = mesh.node_sets[entry.node_set]
                place[nodes, entry.component] += entry.value
                is_driven[nodes, entry.component] = True
        known &= fixed | is_driven
        for tool in still if is_driven.any() else ():
            gap, normal = _find_gap(tool, place)
            across = np.linalg.norm(np.where(known, 0.0, normal), axis=1)
            inside = outside[tool.name] & is_driven.any(axis=1) & (across < ALONG) & (gap < -tolerance)
            if inside.any():
                deepest = int(np.argmin(np.where(inside, gap, np.inf)))
                yield _explain(tool, index, int(inside.sum()), mesh.points[deepest], -float(gap[deepest]))
                return


def _moves(tool: Tool, stage: Stage) -> bool:
    motion = stage.tool_motion.get(tool.name)
    return motion is not None and (motion.moves or motion.start is not None)


def _find_gap(tool: Tool, places: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the gap of places to a tool where it starts (n,) [mm], below 0 inside, and its normal (n, 2 | 3)."""
    if places.shape[1] == 2:
        gap, normal, *_ = _core.touch_profile(start_profile(tool), np.ascontiguousarray(places))
        return gap, normal
    pose = find_space_pose(tool, np.zeros(3))
    gap, normal, *_ = make_surface(tool.surface).nearest(np.ascontiguousarray(pose.to_frame(places)))
    return gap, pose.turn(normal)


def _explain(tool: Tool, stage: int, count: int, node: FloatArray, depth: float) -> Problem:
    at = ", ".join(f"{x:.4g}" for x in node)
    return Problem(
        f"stages.{stage}.displacement",
        f"drives {count} nodes into tools.{tool.name}, at most {depth:.4g} mm, the node that starts at ({at}) mm: no "
        "equilibrium exists",
        "drive another set, the other way, or less far",
    )
