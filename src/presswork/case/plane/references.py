# SPDX-License-Identifier: Apache-2.0
"""Checks of a case across its tables: names that must exist elsewhere, and values that must go together."""

from __future__ import annotations

from typing import Literal

from presswork import model
from presswork.case.errors import Problem, suggest
from presswork.case.heat.forming_checks import check_heat
from presswork.case.heat.series_checks import check_series
from presswork.case.held_stages import check_held_stages, releases
from presswork.case.material.library import find_material_problem
from presswork.case.plane import schema
from presswork.case.plane.bodies import check_bodies, list_bodies
from presswork.case.plane.die_body import check_rings
from presswork.case.plane.explicit_checks import check_procedure
from presswork.case.plane.law_checks import check_laws
from presswork.case.plane.remesh_builder import check_remesh
from presswork.case.plane.separation import check_separation
from presswork.case.plane.workpiece import MeshFile, Rectangle, Workpiece
from presswork.case.press.builder import check_timing
from presswork.case.settings import check_small_displacements
from presswork.case.tools.friction import list_friction_problems
from presswork.case.tools.wear import list_wear_problems
from presswork.case.units import LENGTH, unit_factor
from presswork.memory import available_memory, estimate_rectangle, explain_shortage
from presswork.mesh import fitting_patterns

MOST_CELLS = 20_000_000


def check_references(case: schema.Case) -> list[Problem]:
    """Return the problems that show without the mesh."""
    problems = [
        *check_bodies(case),
        *check_procedure(case),
        *check_remesh(case),
        *check_separation(case),
        *check_heat(case),
        *check_series(case),
    ]
    for key, body in list_bodies(case).values():
        problems += _check_body(case, key, body)
    if case.analysis == "axisymmetric" and case.depth != 1.0:
        problems.append(
            Problem(
                "depth",
                "an axisymmetric body has no depth: forces are those of the whole ring",
                "leave it out",
                case.depth,
            )
        )
    problems += _check_strain_measure(case)
    for name, entry in case.tools.items():
        problems += _check_unit(f"tools.{name}.unit", entry.unit or "mm")
        problems += check_rings(f"tools.{name}.body", entry.body, case.analysis)
    problems += list_wear_problems(case.tools, case.stages, heated=case.heat is not None)
    laws = {name: tool.contact for name, tool in case.tools.items()}
    problems += list_friction_problems(case.tools, heated=case.heat is not None, laws=laws)
    problems += check_laws(case) + _check_densities(case) + check_small_displacements(case.solver)
    if case.solver.control == "arc_length":
        fault = "arc length is for shells under loads alone"
        problems.append(Problem("solver.control", fault, 'take "load"', "arc_length"))
    names = [stage.name for stage in case.stages]
    problems += check_held_stages(case.boundary, names)
    unloads = case.gravity is not None or any(body.velocity is not None for _, body in list_bodies(case).values())
    for index, stage in enumerate(case.stages):
        key = f"stages.{index}"
        if stage.name in names[:index]:
            problems.append(Problem(f"{key}.name", "two stages have this name", "give each its own", stage.name))
        for tool in stage.tools:
            if tool not in case.tools:
                remedy = suggest(tool, case.tools, "tools")
                problems.append(Problem(f"{key}.tools.{tool}", "no such tool", remedy))
        problems += _check_forces(case, stage, key)
        problems += check_timing(stage.find_timing(index), case.presses)
        holds = stage.holds and (index > 0 or case.procedure == "implicit")
        holds |= releases(case.boundary, names, index)
        if not (_moves(stage) or unloads or holds or case.heat is not None):
            problems.append(
                Problem(
                    key,
                    f'the stage "{stage.name}" moves nothing at all: no tool, no displacement, no load',
                    f"add [stages.tools.NAME] with a stroke or move, or [[stages.displacement]], or give the duration "
                    f"for which the workpiece is held; "
                    f"tools: {', '.join(case.tools) or 'none'}",
                )
            )
        unloads = unloads or _is_loaded(stage) or bool(stage.displacement)
    return problems


def _check_strain_measure(case: schema.Case) -> list[Problem]:
    """Return the problem of a strain whose trace is not the change of volume."""
    elements = [body.element for _, body in list_bodies(case).values()]
    if case.solver.strain_measure != "small" or "quad4_fbar" not in elements:
        return []
    fault = "F-bar needs a strain whose trace is the change of volume, which the small strain's is not"
    return [Problem("solver.strain_measure", fault, 'take "log", or another element', "small")]


def _check_densities(case: schema.Case) -> list[Problem]:
    """Return the problems of materials without mass where inertia acts."""
    if case.solver.inertia == 0.0:
        return []
    problems = []
    for name in sorted({body.material for _, body in list_bodies(case).values()} & set(case.materials)):
        material = case.materials[name]
        if material.density is None:
            remedy = 'add it: solver.inertia needs it; steel has "7850 kg/m^3"'
            problems.append(Problem(f"materials.{name}.density", "missing key", remedy))
    return problems


def _check_forces(case: schema.Case, stage: schema.Stage, key: str) -> list[Problem]:
    """Return the problems of tools that a force pushes in a stage."""
    problems = []
    for name, motion in stage.tools.items():
        tool = case.tools.get(name)
        if motion.force is None or tool is None:
            continue
        if tool.spring is not None:
            remedy = "remove the spring, or move the tool with a stroke and let the spring give the force"
            problems.append(Problem(f"{key}.tools.{name}.force", "the tool rests on a spring", remedy, motion.force))
        assert motion.direction is not None
        if case.analysis == "axisymmetric" and motion.direction[0] != 0.0:
            fault = "in axisymmetry a rigid tool can move along y only"
            problems.append(Problem(f"{key}.tools.{name}.direction", fault, "take [0, 1] or [0, -1]", motion.direction))
    return problems


def _moves(stage: schema.Stage) -> bool:
    """Return whether a stage changes anything; a force or pressure of zero counts, as it may unload."""
    tools = any(motion.build() != model.ToolMotion() for motion in stage.tools.values())
    return tools or any(entry.value != 0.0 for entry in stage.displacement) or _is_loaded(stage)


def _is_loaded(stage: schema.Stage) -> bool:
    return bool(stage.force or stage.edge_force or stage.pressure)


def _check_unit(key: str, unit: str) -> list[Problem]:
    try:
        unit_factor(unit, LENGTH)
    except ValueError as error:
        return [Problem(key, f"expected a unit of length, but {error}", "e.g. mm, m, inch", unit)]
    return []


def _check_body(case: schema.Case, key: str, body: Workpiece) -> list[Problem]:
    problems = []
    cells = body.mesh.cells if isinstance(body.mesh, Rectangle) else None
    if cells and cells[0] * cells[1] > MOST_CELLS:
        remedy = f"take no more than {MOST_CELLS:,} in all"
        problems.append(Problem(f"{key}.mesh.cells", "more cells than memory will hold", remedy, list(cells)))
    elif isinstance(body.mesh, Rectangle):
        problems += check_cells(f"{key}.mesh", body.mesh, body.element, 0, explicit=case.procedure == "explicit")
    if fault := find_material_problem(key, body.material, case.materials):
        problems.append(fault)
    if isinstance(body.mesh, MeshFile):
        problems += _check_unit(f"{key}.mesh.unit", body.mesh.unit)
    elif body.mesh.pattern is not None:
        fitting = fitting_patterns(body.element)
        if body.mesh.pattern not in fitting:
            shape = "triangles" if body.mesh.pattern != "quad" else "quadrilaterals"
            problems.append(
                Problem(
                    f"{key}.mesh.pattern",
                    f"this makes {shape}, which do not fit element = {body.element}",
                    f"choose one of: {', '.join(fitting)}; or another element",
                    body.mesh.pattern,
                )
            )
    return problems


def check_cells(key: str, mesh: Rectangle, element: model.ElementName, layers: int, *, explicit: bool) -> list[Problem]:
    """Return a problem where the cells of a rectangle need more memory than there is. layers: of a shell, else 0."""
    along = mesh.cells or [sum(zone.cells for zone in zones or ()) for zones in (mesh.zones_x, mesh.zones_y)]
    cut = {"crossed": 4, "left": 2, "right": 2, "quad": 1}[mesh.pattern or fitting_patterns(element)[0]]
    needed, there = (
        estimate_rectangle(cut * along[0] * along[1], element, layers, explicit=explicit),
        available_memory(),
    )
    if needed <= there:
        return []
    name = "cells" if mesh.cells else "zones_x"
    fault, _, remedy = explain_shortage(needed, there).partition("; ")
    return [Problem(f"{key}.{name}", fault, remedy, list(along))]


def check_sets(case: schema.Case, mesh: model.Mesh) -> list[Problem]:
    """Return the problems of set names, once the mesh is known."""
    uses = [(f"boundary.{name}.set", entry.set, False) for name, entry in case.boundary.items()]
    for index, stage in enumerate(case.stages):
        key = f"stages.{index}"
        uses += [(f"{key}.displacement.{row}.set", entry.set, False) for row, entry in enumerate(stage.displacement)]
        uses += [(f"{key}.force.{row}.set", load.set, False) for row, load in enumerate(stage.force)]
        uses += [(f"{key}.edge_force.{row}.set", load.set, True) for row, load in enumerate(stage.edge_force)]
        uses += [(f"{key}.pressure.{row}.set", load.set, True) for row, load in enumerate(stage.pressure)]
        uses += [(f"{key}.convection.{row}.set", zone.set, True) for row, zone in enumerate(stage.convection)]
    return check_set_names(uses, mesh)


def check_set_names(
    uses: list[tuple[str, str, bool]], mesh: model.Mesh, *, sides: Literal["edge", "face"] = "edge"
) -> list[Problem]:
    """Return the problems of set names: uses are key, name and whether a set of sides, edges or faces, is meant."""
    known_sides = mesh.edge_sets if sides == "edge" else mesh.face_sets
    problems = []
    for key, name, is_of_sides in uses:
        what, known = (f"{sides} sets", known_sides) if is_of_sides else ("node sets", mesh.node_sets)
        if name not in known:
            problems.append(Problem(key, f"no such {what[:-1]}", suggest(name, known, what), name))
        elif len(known[name]) == 0:
            problems.append(Problem(key, f"the {what[:-1]} is empty", "choose another", name))
    return problems
