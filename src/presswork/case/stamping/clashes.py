# SPDX-License-Identifier: Apache-2.0
"""Whether the tools of a stamping can do what the stages ask: hold the sheet, close on it, and miss each other."""

from __future__ import annotations

import itertools
import logging

import numpy as np

from presswork.case.errors import Problem
from presswork.case.material.umat import UmatMaterial
from presswork.case.stamping.binder import check_binders
from presswork.case.stamping.closing import check_pairs, is_pushed, list_strokes
from presswork.case.stamping.schema import StampingCase
from presswork.case.stamping.tools import RectangularTool, RoundTool, StripTool
from presswork.geometry.tool_surface import make_surface
from presswork.law.elastic_plastic import first_flow_stress
from presswork.mesh.make.flange import find_held_area
from presswork.mesh.simplices import list_simplices
from presswork.model import FloatArray, Mesh, Tool

logger = logging.getLogger(__name__)

LOOSE = 5e-4
"""Part of the sheet's yield stress as a holder's pressure: less than a tenth of what is usual, about 1 %."""
SAMPLES = 100_000
"""Places on the blank at which a tool is looked for that lies over none of its nodes."""


def check_clashes(case: StampingCase, mesh: Mesh, tools: tuple[Tool, ...]) -> list[Problem]:
    """Return the problems of placed tools with blank, forces, symmetry planes and each other."""
    problems = [problem for tool in tools if (problem := _check_laid(case, mesh, tool))]
    if problems:
        return problems
    problems = [*check_binders(case, tools), *_check_forces(case, mesh, tools)]
    problems += [p for tool in tools if (p := _check_pushed(case, mesh, tool))]
    problems += [p for tool in tools if (p := _check_reach(case, mesh, tool))]
    problems += check_pairs(case, tools)
    return problems


def _check_laid(case: StampingCase, mesh: Mesh, tool: Tool) -> Problem | None:
    """Return a problem where the blank lies in the opening of a die or holder, not on its face."""
    drawn = case.tools[tool.name]
    if not isinstance(drawn, RoundTool | RectangularTool | StripTool) or tool.kind == "punch":
        return None
    away = np.abs(mesh.points[:, :2] - np.array(tool.position[:2]))
    half = np.array(drawn.half_size())
    beyond = np.linalg.norm(away, axis=1) - half[0] if isinstance(drawn, RoundTool) else (away - half).max(axis=1)
    if beyond.max() > 0.0:
        return None
    verb = "falls through the opening of" if tool.kind == "die" else "is smaller than the opening of"
    fault = f"the blank {verb} {tool.name}, by {-float(beyond.max()):.4g} mm"
    size = {"round": "diameter", "rectangular": "size", "strip": "width"}[drawn.shape]
    return Problem(
        f"tools.{tool.name}.{size}", fault, "make the blank larger or the opening smaller", getattr(drawn, size)
    )


def _check_pushed(case: StampingCase, mesh: Mesh, tool: Tool) -> Problem | None:
    """Return a problem where a tool that is pushed starts away from the blank, and no stage before brings it there."""
    actions = [stage.tools[tool.name] for stage in case.stages if tool.name in stage.tools]
    before = list(itertools.takewhile(lambda action: action.force is None, actions))
    if len(before) == len(actions) or any(action.close for action in before):
        return None
    gap = _gap(case, mesh, tool) - sum(action.stroke or 0.0 for action in before)
    if gap <= case.blank.thickest:
        return None
    fault = f"the tool is pushed by a force, but starts {gap:.4g} mm off the blank, which it would hit"
    remedy = "leave position out: then it just touches the blank"
    position = case.tools[tool.name].position
    if position is None:
        fault = f"the tool is pushed by a force, but no part of it lies over the blank: the nearest is {gap:.4g} mm off"
        remedy = "make the blank larger, or check the unit and the place of the tool"
        return Problem(f"tools.{tool.name}", fault, remedy)
    return Problem(f"tools.{tool.name}.position", fault, remedy, list(position) if position is not None else None)


def _check_reach(case: StampingCase, mesh: Mesh, tool: Tool) -> Problem | None:
    """Return a problem where a tool placed off the blank never comes to it, whatever moves."""
    position = case.tools[tool.name].position
    if position is None or any(is_pushed(case, name) for name in (tool.name, *_names_of(case, "die"))):
        return None
    gap = _gap(case, mesh, tool)
    strokes = {name: max([0.0, *list_strokes(case, name)]) for name in case.tools}
    lifted = sum(abs(e.value) for s in case.stages for e in s.displacement if e.component == "z")
    if case.pressure:  # moves the blank to its tools, by no more than its own size
        lifted += float(np.ptp(mesh.points, axis=0).max())
    if gap <= sum(strokes.values()) + lifted:
        return None
    fault = (
        f"the {tool.kind} starts {gap:.4g} mm off the blank and moves {strokes[tool.name]:.4g} mm: it never touches it"
        if np.isfinite(gap)
        else f"no part of the {tool.kind} lies over the blank: it never touches it"
    )
    remedy = "leave position out: then it just touches the blank; or give it a longer stroke"
    return Problem(f"tools.{tool.name}.position", fault, remedy, list(position))


def _names_of(case: StampingCase, kind: str) -> list[str]:
    return [name for name, tool in case.tools.items() if tool.kind == kind]


def _gap(case: StampingCase, mesh: Mesh, tool: Tool) -> float:
    """Return what lies between a tool and the blank's surface at the start [mm], infinite if it lies beside it."""
    surface, place = make_surface(tool.surface), np.asarray(tool.position)
    gap = surface.nearest(mesh.points - place)[0]
    if not np.isfinite(gap).any():  # a tool may lie between the nodes
        gap = surface.nearest(_sample_cells(mesh) - place)[0]
    return float(gap.min()) - 0.5 * case.blank.thickest


def _sample_cells(mesh: Mesh) -> FloatArray:
    """Return places (n, 3) all over the cells of a sheet, the more in each the fewer there are [mm]."""
    corners = mesh.points[list_simplices(mesh)]
    parts = min(40, 2 + int(np.sqrt(SAMPLES / len(corners))))
    first, second = (k.ravel() / parts for k in np.mgrid[: parts + 1, : parts + 1])
    share = np.column_stack([1.0 - first - second, first, second])[first + second <= 1.0 + 1e-9]
    return np.asarray(share @ corners).reshape(-1, 3)


def _check_forces(case: StampingCase, mesh: Mesh, tools: tuple[Tool, ...]) -> list[Problem]:
    """Return the problems of holder forces that press nothing, or press the sheet flat."""
    problems = []
    sheet = case.materials[case.blank.material]
    if isinstance(sheet, UmatMaterial):
        strength = sheet.yield_stress or 0.0
    else:
        strength = first_flow_stress(sheet.to_model(case.blank.material))
    for holder in (t for t in tools if t.kind == "holder"):
        area = find_held_area(mesh, holder) * 2 ** len(set(case.blank.symmetry))
        for index, stage in enumerate(case.stages):
            action = stage.tools.get(holder.name)
            if action is None or action.force is None:
                continue
            forces = [row[1] for row in action.force] if isinstance(action.force, tuple) else [action.force]
            key = f"stages.{index}.tools.{holder.name}.force"
            if max(forces) == 0.0:
                fault = "the holder is pushed by no force: it cannot close on the sheet"
                problems.append(Problem(key, fault, "give a force, or a gap to the die", max(forces)))
            elif area > 0 and max(forces) / area > strength:
                fault = (
                    f"the holder would press the flange with {max(forces) / area:.4g} MPa; the sheet yields at "
                    f"{strength:.4g} MPa"
                )
                problems.append(Problem(key, fault, 'plain numbers are N; a few MPa are usual: "10 kN"', max(forces)))
            elif area > 0 and max(forces) / area < LOOSE * strength:
                text = "%s = %g: presses the flange with %.2g MPa: it will wrinkle unless the sheet is thick; "
                text += "1 to 3 MPa are usual for mild steel, and plain numbers are N"
                logger.warning(text, key, max(forces), max(forces) / area)
    return problems
