# SPDX-License-Identifier: Apache-2.0
"""Turns the case of a solid in space into the Model: names resolved, the body meshed, everything checked."""

from __future__ import annotations

import logging
from dataclasses import replace
from pathlib import Path

import numpy as np

from presswork import model
from presswork.case.errors import CaseError, Problem, suggest
from presswork.case.gravity import find_gravity
from presswork.case.heat.films import build_zones
from presswork.case.heat.forming_builder import start_hot
from presswork.case.held_stages import check_held_stages, list_released, releases
from presswork.case.marked_points import build_points
from presswork.case.material.law_needs import check_grain, check_needs
from presswork.case.material.library import find_material_problem
from presswork.case.material.umat import UmatMaterial
from presswork.case.motion.driven_nodes import list_driven_nodes
from presswork.case.plane.builder import build_materials
from presswork.case.plane.law_checks import check_friction_of_elastic, check_integrator, check_pores
from presswork.case.plane.reach import check_reach
from presswork.case.plane.references import check_set_names
from presswork.case.plane.schema import Material
from presswork.case.press.builder import build_drive, check_timing, find_halves, list_blows
from presswork.case.settings import RAMP, build_output, build_solver, check_small_displacements
from presswork.case.space.bodies import (
    build_space_bodies,
    build_space_contacts,
    check_space_bodies,
    list_space_bodies,
)
from presswork.case.space.close_fits import close_fits_in_space
from presswork.case.space.cyclic import check_cyclic, find_cyclic
from presswork.case.space.explicit_checks import check_space_procedure, choose_element
from presswork.case.space.heat import build_space_heat, check_space_heat
from presswork.case.space.remesh_builder import build_space_remeshing, check_space_remesh
from presswork.case.space.schema import AXES, FaceForce, SpaceCase, SpaceStage
from presswork.case.space.symmetry import Symmetry, build_supports, check_symmetry, find_symmetry
from presswork.case.space.tool_builder import build_tool, check_motions, find_first_direction, list_arcs
from presswork.case.space.tool_checks import mean_edge, warn_of_facets, warn_of_radius, warn_of_widths
from presswork.case.tool_sizes import warn_of_tools
from presswork.case.tools.friction import list_friction_problems
from presswork.case.tools.wear import list_wear_problems
from presswork.mesh.faces import face_areas

logger = logging.getLogger(__name__)


def build_space_model(case: SpaceCase, *, run_user_code: bool = True) -> model.Model:
    """Build the Model of a solid in space; raises CaseError with every problem of the first kind that is found.

    run_user_code: try the shared libraries that it names.
    """
    _stop_at(_check_names(case), case)
    mesh, bodies = build_space_bodies(case)
    _stop_at([*_check_sets(case, mesh), *check_space_remesh(case, mesh, bodies)], case)
    _stop_at(check_cyclic(case, mesh), case)
    points, problems = build_points(
        case.points, mesh, {*case.boundary, *(entry.set for stage in case.stages for entry in stage.displacement)}
    )
    _stop_at(problems, case)
    materials, problems = build_materials(case.materials, case.source, 6, run_user_code)
    materials = tuple(start_hot(material, case.heat) for material in materials)
    supports, wrong = build_supports(case, mesh)
    symmetry = find_symmetry(case, mesh, bodies, supports)
    contacts, apart = build_space_contacts(case, mesh, bodies, materials)
    remeshing = build_space_remeshing(case, mesh, bodies)
    tools, of_tools = _build_tools(case, mesh, symmetry, remeshing)
    stages, of_presses = _build_stages(case, mesh, symmetry)
    problems += [
        *wrong,
        *apart,
        *check_symmetry(case, mesh, bodies),
        *of_presses,
        *of_tools,
    ]
    problems = problems or check_motions(case, tools)
    problems = problems or ([] if case.gravity else check_reach(tools, stages, mesh))
    problems = problems or list(list_driven_nodes(tools, stages, supports, mesh))
    _stop_at(problems, case)
    tools, close = close_fits_in_space(tools, stages, mesh)
    for warning in close:
        logger.warning("%s", warning)
    return model.Model(
        title=case.title,
        analysis="solid",
        depth=1.0,
        mesh=mesh,
        materials=materials,
        tools=tools,
        supports=supports,
        cyclic=find_cyclic(case, mesh),
        stages=stages,
        solver=build_solver(case.solver, with_coulomb=_depends_on_pushes(case), with_body_contact=bool(contacts)),
        output=build_output(case.output),
        bodies=bodies,
        contacts=contacts,
        explicit=_build_explicit(case) if case.procedure == "explicit" else None,
        gravity=find_gravity(case.gravity),
        limits=case.limits.build(),
        points=points,
        heat=build_space_heat(case, bodies),
        remeshing=remeshing,
        case_text=case.text,
    )


def _build_tools(
    case: SpaceCase, mesh: model.Mesh, symmetry: Symmetry, remeshing: model.Remeshing | None
) -> tuple[tuple[model.Tool, ...], list[Problem]]:
    """Return the Model's tools, and the problems of others."""
    folder = case.source.parent if case.source is not None else Path()
    built = [
        build_tool(name, tool, mesh, symmetry.planes, folder, find_first_direction(case, name))
        for name, tool in case.tools.items()
    ]
    smallest = _find_smallest_cells(remeshing, mesh)
    for name, tool in zip(case.tools, built, strict=True):
        if isinstance(tool, model.Tool):
            warn_of_widths(name, tool, symmetry.planes, mesh, *smallest)
            warn_of_facets(name, tool, mesh, *smallest)
            warn_of_radius(name, list_arcs(case.tools[name], tool.surface), *smallest)
    tools = tuple(replace(tool, sectors=symmetry.sectors) for tool in built if isinstance(tool, model.Tool))
    for warning in warn_of_tools(case.tools, tools, float(np.linalg.norm(np.ptp(mesh.points, axis=0)))):
        logger.warning("%s", warning)
    return tools, [tool for tool in built if isinstance(tool, Problem)]


def _find_smallest_cells(remeshing: model.Remeshing | None, mesh: model.Mesh) -> tuple[float, str]:
    """Return the smallest edges that cells on tools will have [mm], and what they are."""
    if remeshing is None or remeshing.keeps_first:
        return mean_edge(mesh), "cells of the workpiece"
    return remeshing.smallest_size, "remesh.smallest_size"


def _depends_on_pushes(case: SpaceCase) -> bool:
    """Return whether friction follows the pushes of nodes so that the symmetric part of the tangent does not converge.

    Constant shear friction does so at nodes that hardly push, of which flash and new meshes have many.
    """
    is_meshed_anew = case.remesh is not None and case.remesh.enabled
    return any(
        tool.contact in model.BY_PRESSURE
        or tool.friction is not None
        or (is_meshed_anew and tool.contact == "shear" and tool.m > 0.0)
        for tool in case.tools.values()
    )


def _stop_at(problems: list[Problem], case: SpaceCase) -> None:
    if problems:
        raise CaseError(problems, case.source)


def _check_names(case: SpaceCase) -> list[Problem]:
    """Return the problems that show without the mesh."""
    problems = [*_check_materials(case), *_check_solver(case), *check_space_procedure(case), *check_space_bodies(case)]
    problems += check_held_stages(case.boundary, [stage.name for stage in case.stages])
    for key, body in list_space_bodies(case).values():
        if unknown := find_material_problem(key, body.material, case.materials):
            problems.append(unknown)
    names = [stage.name for stage in case.stages]
    held = False
    for index, stage in enumerate(case.stages):
        if stage.name in names[:index]:
            fault = "two stages have this name"
            problems.append(Problem(f"stages.{index}.name", fault, "give each its own", stage.name))
        is_loaded = bool(case.gravity or stage.force or stage.face_force or stage.pressure)
        moves = any(body.velocity is not None for _, body in list_space_bodies(case).values())
        moves = moves or any(motion.turn or motion.force or motion.position for motion in stage.tools.values())
        moves = moves or any(any(motion.build().move) for motion in stage.tools.values())
        problems += check_timing(stage.find_timing(index), case.presses)
        holds = stage.holds and (index > 0 or case.procedure == "implicit")
        holds |= releases(case.boundary, names, index)
        displaced = any(entry.value != 0.0 for entry in stage.displacement)
        if case.heat is None and not (is_loaded or held or moves or displaced or holds):
            remedy = (
                "add [stages.tools.NAME], [[stages.displacement]], [[stages.face_force]], [[stages.pressure]] or "
                "[[stages.force]], or give the duration for which the workpiece is held"
            )
            problems.append(Problem(f"stages.{index}", f'the stage "{stage.name}" changes nothing', remedy))
        held = is_loaded or displaced  # which the next stage may release
        for tool in stage.tools:
            if tool not in case.tools:
                remedy = suggest(tool, case.tools, "tools")
                problems.append(Problem(f"stages.{index}.tools.{tool}", "no such tool", remedy))
    return problems


def _check_materials(case: SpaceCase) -> list[Problem]:
    """Return the problems of laws that no solid in space takes."""
    heated = case.heat is not None
    used = {body.material for _, body in list_space_bodies(case).values()}
    problems = list(check_needs(case.materials, sorted(used), case.stages, heated=heated))
    problems += list_wear_problems(case.tools, case.stages, heated=heated)
    laws = {name: tool.contact for name, tool in case.tools.items()}
    problems += list_friction_problems(case.tools, heated=heated, laws=laws)
    problems += [*check_space_heat(case), *check_friction_of_elastic(case)]
    for name, material in case.materials.items():
        if isinstance(material, UmatMaterial):
            if case.solver.tangent == "thesis":
                fault = "its terms are for the laws of presswork; a UMAT brings its tangent with it"
                problems.append(Problem("solver.tangent", fault, 'take "consistent"', "thesis"))
        else:
            problems += check_pores(f"materials.{name}", material) + _check_pores_in(case, name, material)
            if material.grain is not None:
                key, knows = f"materials.{name}", heated or material.heating is not None
                problems += check_grain(key, material.grain, knows_temperature=knows, stages=case.stages)
            problems += material.check_in_solids(f"materials.{name}")
            if name in used:
                problems += check_integrator(name, material, case.solver)
        if case.solver.inertia and material.density is None and name in used:
            remedy = 'add it: solver.inertia needs it; steel has "7850 kg/m^3"'
            problems.append(Problem(f"materials.{name}.density", "missing key", remedy))
    return problems


def _check_pores_in(case: SpaceCase, name: str, material: Material) -> list[Problem]:
    """Return the problems of pores with what else the case has."""
    if material.gtn is None:
        return []
    problems, key = [], f"materials.{name}.gtn"
    if case.heat is not None:
        problems.append(Problem(key, "in space heat is not computed in a metal with pores", "leave [heat] out"))
    for place, body in list_space_bodies(case).values():
        if body.material == name and choose_element(case, body) == "tet4_mini":
            fault = "the pressure at its nodes knows the elastic change of volume alone, and pores add to it"
            problems.append(Problem(f"{place}.element", fault, "take tet10 or hex8_fbar", "tet4_mini"))
    return problems


def _check_solver(case: SpaceCase) -> list[Problem]:
    """Return the problems of settings that mean nothing here."""
    problems = check_small_displacements(case.solver)
    if case.solver.control == "arc_length":
        fault = "arc length is for shells under loads alone"
        problems.append(Problem("solver.control", fault, 'take "load"', "arc_length"))
    if case.solver.strain_measure == "small" and case.solver.displacements == "large":
        fault = "the small strain changes with a rotation, and is offered in the plane alone, for comparison"
        remedy = 'take "log", or displacements = "small"'
        problems.append(Problem("solver.strain_measure", fault, remedy, "small"))
    return problems


def _check_sets(case: SpaceCase, mesh: model.Mesh) -> list[Problem]:
    """Return the problems of set names, once the mesh is known."""
    uses = [(f"boundary.{name}.set", entry.set, False) for name, entry in case.boundary.items()]
    for index, stage in enumerate(case.stages):
        key = f"stages.{index}"
        uses += [(f"{key}.displacement.{row}.set", entry.set, False) for row, entry in enumerate(stage.displacement)]
        uses += [(f"{key}.force.{row}.set", load.set, False) for row, load in enumerate(stage.force)]
        uses += [(f"{key}.face_force.{row}.set", load.set, True) for row, load in enumerate(stage.face_force)]
        uses += [(f"{key}.pressure.{row}.set", load.set, True) for row, load in enumerate(stage.pressure)]
        uses += [(f"{key}.convection.{row}.set", zone.set, True) for row, zone in enumerate(stage.convection)]
    return check_set_names(uses, mesh, sides="face")


def _build_explicit(case: SpaceCase) -> model.ExplicitSolid:
    velocity, *others = (body.velocity or (0.0, 0.0, 0.0) for _, body in list_space_bodies(case).values())
    return model.ExplicitSolid(velocity=velocity, velocity_of_others=tuple(others), **case.explicit.model_dump())


def _build_stages(
    case: SpaceCase, mesh: model.Mesh, symmetry: Symmetry
) -> tuple[tuple[model.Stage, ...], list[Problem]]:
    """Return the Model's stages, several of one that strikes several blows, and the problems of presses."""
    stages: list[model.Stage] = []
    problems: list[Problem] = []
    blows: dict[str, int] = {}
    for number, stage_case in enumerate(case.stages):
        stage = _build_stage(stage_case, case, mesh)
        halves = find_halves(stage, symmetry.planes)
        halves = replace(halves, whole=halves.whole * symmetry.sectors)
        drive = build_drive(stage_case.find_timing(number), case.presses, halves)
        if isinstance(drive, Problem):
            problems.append(drive)
        elif drive is not None:
            stage = replace(stage, drive=drive, duration=drive.duration)
        struck = blows.get(stage_case.press.name, 0) if stage_case.press else 0
        stages += list_blows(stage, stage_case.press, struck + 1)
        if stage_case.press is not None:
            blows[stage_case.press.name] = struck + stage_case.press.blows
    return tuple(stages), problems


def _build_stage(stage: SpaceStage, case: SpaceCase, mesh: model.Mesh) -> model.Stage:
    """Turn a case's stage into the Model's."""
    ramp = RAMP * stage.duration if stage.ramp is None else stage.ramp
    return model.Stage(
        name=stage.name,
        duration=stage.duration,
        ramp=ramp if case.procedure == "explicit" else 0.0,
        released=list_released(case.boundary, stage.name),
        tool_motion={name: motion.build() for name, motion in stage.tools.items()},
        prescribed=tuple(
            model.PrescribedDisplacement(entry.set, AXES.index(entry.component), entry.value)  # type: ignore[arg-type]
            for entry in stage.displacement
        ),
        forces=tuple(model.PointForce(entry.set, entry.value) for entry in stage.force),
        face_forces=tuple(_build_face_force(entry, mesh) for entry in stage.face_force),
        face_pressures=tuple(model.FacePressure(entry.set, entry.value) for entry in stage.pressure),
        heat=build_zones(stage.convection),
    )


def _build_face_force(entry: FaceForce, mesh: model.Mesh) -> model.FaceForce:
    if entry.value is not None:
        return model.FaceForce(entry.set, entry.value)
    assert entry.total is not None
    area = float(face_areas(mesh.points, mesh.face_sets[entry.set]).sum())
    x, y, z = entry.total
    return model.FaceForce(entry.set, (x / area, y / area, z / area))
