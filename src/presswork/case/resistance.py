# SPDX-License-Identifier: Apache-2.0
"""Whether the tools of a Model can form anything: something resists their strokes, and they press, not only slide.

The checks need the Model alone, whatever kind of case it comes from. observe/doubts.py checks the rest after the run.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator

import numpy as np

from presswork.case.errors import Problem
from presswork.geometry.blocked_motion import blocks_motion, look_at
from presswork.mesh.forgotten_planes import find_forgotten_planes
from presswork.model import FloatArray, Model, Tool, find_direction

logger = logging.getLogger(__name__)

ACROSS = 0.1
"""Part of a unit vector from which on a support or a ring resists along it."""
TOLERANCE = 1e-6
"""Gap that counts as closed, over the size of the workpiece."""
SAMPLES = 16
"""Places along each motion."""


def check_resistance(model: Model) -> list[Problem]:
    """Return a problem where tools push a workpiece that nothing holds against them, which then moves along with them.

    Where inertia resists, that is a warning. So are a symmetry plane that looks forgotten, and tools that only slide.
    """
    for side in find_forgotten_planes(model):
        logger.warning("%s", explain_forgotten(model, side.describe(dict(model.mesh.node_sets))))
    if not _knows_all(model):
        return []
    if _only_slide(model):
        for tool in (tool for tool in model.tools if _moves(model, tool)):
            text = "tools.%s: the tool only slides along the workpiece, and no other presses it: mend its direction"
            logger.warning(text, tool.name)
    problem = _find_unresisted(model)
    if problem is None:
        return []
    if model.explicit is None and model.solver.inertia == 0.0:
        return [problem]
    logger.warning("%s: %s", problem.key, problem.expected)
    return []


def explain_forgotten(model: Model, place: str) -> str:
    """Explain that a side looks like a symmetry plane; place: what FlatSide.describe returns."""
    key = "blank.symmetry" if model.analysis == "stamping" else "[boundary]"
    return (
        f"nothing holds, loads or touches the workpiece on {place}, which looks like a symmetry plane: if it is one, "
        f"add it to {key}; if the workpiece ends there, move its origin off that plane"
    )


def _knows_all(model: Model) -> bool:
    """Return whether strokes alone drive the process: no load, flight, turning tool or spring, and no formed part."""
    stages = model.stages
    loaded = any(
        s.forces or s.pressures or s.edge_forces or s.face_forces or s.face_pressures or s.shell_pressures
        or s.body_forces or any(p.value for p in s.prescribed)
        for s in stages
    )  # fmt: skip
    turns = any(motion.turn for s in stages for motion in s.tool_motion.values())
    flies = model.explicit is not None and any(np.ravel(getattr(model.explicit, "velocity", ())))
    flies = flies or any(np.ravel(getattr(model.explicit, "velocity_of_others", ())))
    is_heat = model.heat is not None and model.heat.alone
    springs = any(tool.spring is not None for tool in model.tools)
    return not (
        model.gravity or loaded or turns or flies or is_heat or springs or model.formed or model.following
    ) and bool(model.tools)


def _moves(model: Model, tool: Tool) -> bool:
    motions = (stage.tool_motion.get(tool.name) for stage in model.stages)
    return any(motion is not None and motion.moves for motion in motions)


def _list_boundary(model: Model) -> FloatArray:
    """Return the places where tools touch the workpiece (n, d) [mm]."""
    mesh = model.mesh
    if model.analysis in ("shell", "stamping"):
        return mesh.points
    return mesh.points[np.unique(mesh.boundary_edges if mesh.points.shape[1] == 2 else mesh.boundary_faces)]


def _find_unresisted(model: Model) -> Problem | None:
    """Return a problem of the first tool that pushes the workpiece along, where nothing resists any tool that does."""
    points = _list_boundary(model)
    first: Problem | None = None
    for tool in model.tools:
        for number, stage in enumerate(model.stages):
            motion = stage.tool_motion.get(tool.name)
            if motion is None or not motion.moves:
                continue
            direction = find_direction(motion, points.shape[1])[: points.shape[1]]
            if not blocks_motion(tool, points, -direction):
                break
            if _is_resisted(model, tool, points, direction):
                return None
            first = first or _explain_unresisted(model, tool, number, direction)
            break
    return first


def _is_resisted(model: Model, tool: Tool, points: FloatArray, direction: FloatArray) -> bool:
    """Return whether anything but the tool itself can hold the workpiece back along a direction."""
    along = np.abs(direction) > ACROSS
    if model.analysis == "axisymmetric" and along[0]:
        return True
    for support in model.supports:
        if support.normal is not None and abs(np.dot(support.normal, direction)) > ACROSS:
            return True
        if support.normal is None and (np.array(support.fix[: len(direction)]) & along).any():
            return True
    if any(along[p.component] for stage in model.stages for p in stage.prescribed if p.component < len(along)):
        return True
    tolerance = TOLERANCE * float(np.linalg.norm(np.ptp(points, axis=0)))
    for other in (other for other in model.tools if other is not tool):
        motions = [stage.tool_motion.get(other.name) for stage in model.stages]
        if any(motion is not None and motion.start is not None for motion in motions):
            return True  # a stage places it, maybe in the way
        has_friction = (
            other.friction.law != "frictionless" and float(look_at(other)(points, np.inf)[0].min()) <= tolerance
        )
        if has_friction or blocks_motion(other, points, direction):
            return True
    return False


def _explain_unresisted(model: Model, tool: Tool, stage: int, direction: FloatArray) -> Problem:
    heights = model.mesh.points @ direction
    end = np.flatnonzero(heights >= heights.max() - TOLERANCE * float(np.ptp(heights)))
    sets = [name for name, nodes in model.mesh.node_sets.items() if np.array_equal(np.sort(nodes), end)]
    axis = int(np.argmax(np.abs(direction)))
    remedy = "add the tool that stands against it"
    if sets and abs(direction[axis]) > 1.0 - 1e-9 and model.analysis != "stamping":
        remedy += (
            f', or the symmetry plane where the workpiece ends: [boundary.NAME] with set = "{sets[0]}" and '
            f'fix = ["{"xyz"[axis]}"]'
        )
    arrow = ", ".join(f"{part:g}" for part in direction + 0.0)
    return Problem(
        f"stages.{stage}.tools.{tool.name}",
        f"the tool pushes the workpiece along ({arrow}), and nothing holds it against that, no other tool, support or "
        "load: it would move with the tool",
        f"{remedy}; limits.stop = false runs it anyway",
    )


def _only_slide(model: Model) -> bool:
    """Return whether tools that move touch the workpiece, and none ever comes nearer than it starts."""
    points = _list_boundary(model)
    tolerance = TOLERANCE * float(np.linalg.norm(np.ptp(points, axis=0)))
    touches = False
    for tool in (tool for tool in model.tools if _moves(model, tool)):
        motions = [stage.tool_motion.get(tool.name) for stage in model.stages]
        if any(motion is not None and (motion.push is not None or motion.start is not None) for motion in motions):
            return False
        gaps = list(_follow(model, tool, points))
        if min(gaps) < gaps[0] - tolerance:
            return False
        touches |= gaps[0] <= tolerance and min(gaps[1:]) <= tolerance
    return touches


def _follow(model: Model, tool: Tool, points: FloatArray) -> Iterator[float]:
    """Yield the least gap of a tool to the workpiece's points along its strokes [mm]."""
    nearest, place = look_at(tool), np.zeros(points.shape[1])
    yield float(nearest(points, np.inf)[0].min())
    for stage in model.stages:
        motion = stage.tool_motion.get(tool.name)
        if motion is None:
            continue
        move = np.array(motion.move[: len(place)])
        for part in np.linspace(0.0, 1.0, SAMPLES + 1)[1:] if move.any() else ():
            yield float(nearest(points - place - part * move, np.inf)[0].min())
        place = place + move
