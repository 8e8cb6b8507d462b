# SPDX-License-Identifier: Apache-2.0
"""What makes a run doubtful: nothing was formed, tools that never touched, symmetry planes that look forgotten."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.law.elastic_plastic import first_flow_stress, is_hot
from presswork.mesh.forgotten_planes import find_forgotten_planes
from presswork.model import ExplicitSolid, Material, Model, Tool, Triangulation
from presswork.observe.wall_load import warn_of_wall_load

NOTHING = 1e-11
"""Force that counts as none (round-off), over Young's modulus times the smallest face of the workpiece."""
OF_METAL = 0.05
"""First flow stress over Young's modulus above which a body is meant to stay elastic."""
ELASTIC = 1e-9
"""Equivalent plastic strain up to which nothing has yielded."""


@dataclass(frozen=True)
class Doubts:
    """What makes a run doubtful, the worst first."""

    worst: str
    """Why what was computed means nothing; empty where it may mean something."""
    warnings: tuple[str, ...]
    """All of it, the worst first."""


def find_doubts(
    model: Model, history: Mapping[str, NDArray[Any]], extremes: Mapping[str, Sequence[float]], *, is_over: bool
) -> Doubts:
    """Return what makes a run doubtful, by its history, its extremes and its Model; the same for every procedure.

    extremes: least and largest value of fields at the end, by name. is_over: whether the whole process was computed;
    else tools that have not touched yet are all that is named, once anything was computed.
    """
    if not is_over and not len(history["time"]):
        return Doubts("", ())
    moving, standing = _find_idle(model, history, is_over=is_over)
    if not is_over:
        return Doubts("", (*moving, *standing))
    doubts = [_explain_plane(side.describe(dict(model.mesh.node_sets))) for side in find_forgotten_planes(model)]
    all_moving = [name for n in range(len(model.operations)) for name in _list_moving(model.of_operation(n))]
    strikes = isinstance(model.explicit, ExplicitSolid) and np.any(model.explicit.velocity)
    elastic = _find_elastic(model, extremes) if all_moving or strikes else []
    if elastic or (all_moving and len(moving) == len(all_moving)):
        worst = f"nothing was formed: {'; '.join([*moving, *elastic])}"
        return Doubts(worst, (worst, *doubts, *standing))
    return Doubts("", (*moving, *doubts, *warn_of_wall_load(model, history), *standing))


def find_never_touched(model: Model, tools: Sequence[Tool], history: Mapping[str, NDArray[Any]]) -> list[str]:
    """Return the tools that the workpiece has never pressed on, by more than round-off."""
    least = _negligible_force(model)
    pressed = [history[name] for name in history if name.startswith("pressure.") and name.endswith(".contact")]
    is_touched = any(np.any(column > 0.0) for column in pressed)
    return [
        tool.name
        for tool in tools
        if _largest_force(tool.name, history) <= least and not (is_touched and _surrounds(tool, model))
    ]


def _surrounds(tool: Tool, model: Model) -> bool:
    """Return whether a tool goes all round the blank, so that its forces cancel, as those of a die round a tube do."""
    if not isinstance(tool.shape, Triangulation):
        return False
    points, blank = tool.shape.points + np.array(tool.position), model.mesh.points
    return bool((points.min(axis=0) <= blank.min(axis=0)).all() and (points.max(axis=0) >= blank.max(axis=0)).all())


def _negligible_force(model: Model) -> float:
    """Return a force that is none [N]."""
    extent = np.sort(np.ptp(model.mesh.points, axis=0))
    if model.analysis == "axisymmetric":
        face = np.pi * float(np.abs(model.mesh.points[:, 0]).max()) ** 2
    elif model.dimension == 2:
        face = float(extent[0]) * model.depth
    elif model.analysis in ("shell", "stamping"):
        face = float(extent[-1]) * model.thickest
    else:
        face = float(extent[0] * extent[1])
    return NOTHING * min((material.young for material in model.materials), default=0.0) * face


def _largest_force(name: str, history: Mapping[str, NDArray[Any]]) -> float:
    """Return the largest component of the force that a tool has ever had [N]; 0 without a history."""
    columns = [history[key] for axis in "xyz" if (key := f"{name}.force_{axis}") in history]
    return max((float(np.abs(column).max(initial=0.0)) for column in columns), default=0.0)


def _find_idle(model: Model, history: Mapping[str, NDArray[Any]], *, is_over: bool) -> tuple[list[str], list[str]]:
    """Return a warning for each tool that never pressed: first for tools that move, then for the others."""
    moving: list[str] = []
    standing: list[str] = []
    what = "blank" if model.analysis == "stamping" else "workpiece"
    for number, name in enumerate(model.operations):
        own = model.of_operation(number)
        has_begun = is_over or not model.following or any(_has_moved(tool.name, history) for tool in own.tools)
        movers = _list_moving(own)
        for tool in find_never_touched(model, own.tools, history) if has_begun else ():
            text = f"{name}: the tool" if model.following else "the tool"
            if tool in movers:
                moving.append(f"{text} {tool} moves, but never touched the {what}, or met no resistance there")
            else:
                standing.append(f"{text} {tool} never touched the {what}")
    return moving, standing


def _list_moving(model: Model) -> list[str]:
    """Return the tools that some stage of an operation moves."""
    motions = [stage.tool_motion for stage in model.stages]
    return [t.name for t in model.tools if any(t.name in each and each[t.name].moves for each in motions)]


def _has_moved(name: str, history: Mapping[str, NDArray[Any]]) -> bool:
    return bool(np.any(history.get(f"{name}.stroke", 0.0)))


def _find_elastic(model: Model, extremes: Mapping[str, Sequence[float]]) -> list[str]:
    """Report that nothing has yielded in a workpiece that could."""
    strain = extremes.get("equivalent_plastic_strain")
    could = any(_can_yield(material) for material in model.materials)
    if strain is None or not could or strain[1] > ELASTIC:
        return []
    stress = extremes.get("effective_stress")
    reached = f": its effective stress reaches {stress[1]:.3g} MPa at the end" if stress else ""
    return [f"nothing of the workpiece has yielded{reached}"]


def _can_yield(material: Material) -> bool:
    """Return whether a material is meant to yield: its first flow stress is far below Young's modulus."""
    if material.hardening is None:
        return False
    return is_hot(material) or first_flow_stress(material) < OF_METAL * material.young


def _explain_plane(place: str) -> str:
    """Report that a side looks like a symmetry plane that was forgotten."""
    return f"nothing held, loaded or touched the workpiece on {place}, which looks like a symmetry plane"
