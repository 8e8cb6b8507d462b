# SPDX-License-Identifier: Apache-2.0
"""Turns a shell's case into the Model: names resolved, the sheet meshed, everything checked."""

from __future__ import annotations

import logging
from math import radians
from pathlib import Path

import numpy as np

from presswork import _core, model
from presswork.case.errors import CaseError, Problem
from presswork.case.gravity import find_gravity
from presswork.case.held_stages import check_held_stages, list_released, releases
from presswork.case.marked_points import build_points
from presswork.case.material.law_needs import check_grain, check_needs
from presswork.case.material.library import find_material_problem
from presswork.case.material.umat import UmatMaterial
from presswork.case.plane.grid import grid_lines
from presswork.case.plane.references import check_cells, check_set_names
from presswork.case.plane.workpiece import MeshFile
from presswork.case.settings import build_output, build_solver, check_small_displacements
from presswork.case.shell.schema import FREEDOMS, ShellCase, ShellRectangle, ShellStage
from presswork.case.units import LENGTH, unit_factor
from presswork.case.zones.build import draw_regions, lay_zones
from presswork.case.zones.materials import Sheets, build_zone_sheets, check_tables, plan_sheets
from presswork.mesh import MeshError
from presswork.mesh.directors import WARPED, Directors, find_directors
from presswork.mesh.shells import mesh_shell_rectangle, read_shell_mesh

logger = logging.getLogger(__name__)

_ALONG = 1e-6
"""Part of a moment, or sine of an axis, across the directors below which it does nothing."""


def build_shell_model(case: ShellCase, *, run_user_code: bool = True) -> model.Model:
    """Build the Model of a shell's case; raises CaseError with every problem of the first kind that is found.

    run_user_code: try the shared libraries that it names.
    """
    _stop_at(_check_names(case), case)
    planned = plan_sheets(case.materials, case.workpiece)
    mesh = _lay_zones(case, _build_mesh(case), planned)
    _stop_at(_check_sets(case, mesh), case)
    _stop_at(_check_freedoms(case, mesh), case)
    points, problems = build_points(
        case.points, mesh, {*case.boundary, *(entry.set for stage in case.stages for entry in stage.displacement)}
    )
    _stop_at(problems, case)
    solver = build_solver(case.solver, with_coulomb=False, is_shell=True)
    return model.Model(
        title=case.title,
        analysis="shell",
        depth=1.0,
        mesh=mesh,
        materials=build_zone_sheets(
            case.materials, case.workpiece, planned, case.source, run_user_code, "workpiece.section.thickness"
        ),
        zones=("", *(zone.name for zone in case.workpiece.zones)) if case.workpiece.zones else (),
        tools=(),
        supports=tuple(entry.build(name) for name, entry in case.boundary.items()),
        stages=tuple(_build_stage(stage, case) for stage in case.stages),
        solver=solver,
        output=build_output(case.output),
        gravity=find_gravity(case.gravity),
        limits=case.limits.build(),
        points=points,
        case_text=case.text,
    )


def _stop_at(problems: list[Problem], case: ShellCase) -> None:
    if problems:
        raise CaseError(problems, case.source)


def _check_names(case: ShellCase) -> list[Problem]:
    """Return the problems that show without the mesh."""
    problems = []
    piece = case.workpiece
    if unknown := find_material_problem("workpiece", piece.material, case.materials):
        problems.append(unknown)
    problems += check_tables(piece, case.materials, "workpiece")
    if piece.zones and case.gradients is not None:
        remedy = "leave them out, and vary the case by a study (sweep, optimise)"
        problems.append(Problem("gradients", "derivatives are not followed in a welded sheet", remedy))
    if isinstance(piece.mesh, MeshFile):
        try:
            unit_factor(piece.mesh.unit, LENGTH)
        except ValueError as error:
            fault = f"expected a unit of length, but {error}"
            problems.append(Problem("workpiece.mesh.unit", fault, "e.g. mm, m, inch", piece.mesh.unit))
    else:
        problems += check_cells("workpiece.mesh", piece.mesh, piece.element, piece.section.points, explicit=False)
        problems += _check_roll(piece.mesh)
    if "rows" in case.output.model_fields_set:
        fault = "shells are implicit: a row an increment"
        problems.append(Problem("output.rows", fault, "remove it", case.output.rows))
    problems += check_small_displacements(case.solver) + _check_inertia(case)
    if case.solver.control != "arc_length":
        problems += check_needs(case.materials, [piece.material], case.stages)
        for name, material in case.materials.items():
            if not isinstance(material, UmatMaterial) and material.grain is not None:
                knows, stages = material.heating is not None, case.stages
                problems += check_grain(f"materials.{name}", material.grain, knows_temperature=knows, stages=stages)
    if case.solver.control == "arc_length":
        for index, stage in enumerate(case.stages):
            if stage.displacement or stage.rotation:
                fault, remedy = "arc length follows loads, not prescribed displacements", 'take control = "load"'
                problems.append(Problem("solver.control", f"{fault} (stages.{index})", remedy, "arc_length"))
        for name, material in case.materials.items():
            key = None if isinstance(material, UmatMaterial) else material.needs_time()
            if not isinstance(material, UmatMaterial) and material.grain is not None:
                key = "grain"
            if key is not None:
                fault = f"along a path that arc length follows no time passes, which materials.{name}.{key} needs"
                remedy = 'take control = "load", or a material that does not depend on the rate'
                problems.append(Problem("solver.control", fault, remedy, "arc_length"))
    names = [stage.name for stage in case.stages]
    problems += check_held_stages(case.boundary, names)
    loaded = case.gravity is not None
    for index, stage in enumerate(case.stages):
        if stage.name in names[:index]:
            problems.append(
                Problem(f"stages.{index}.name", "two stages have this name", "give each its own", stage.name)
            )
        loads = stage.displacement + stage.rotation + stage.force + stage.edge_force + stage.pressure + stage.body_force
        loaded |= releases(case.boundary, names, index)
        if not (loads or loaded or "duration" in stage.model_fields_set):
            remedy = (
                "add [[stages.force]], [[stages.pressure]], [[stages.displacement]] or another load, or give the "
                "duration for which the sheet is held"
            )
            problems.append(Problem(f"stages.{index}", f'the stage "{stage.name}" changes nothing', remedy))
        loaded = bool(loads)
    return problems


def _check_inertia(case: ShellCase) -> list[Problem]:
    """Return the problems of inertia where no time passes or no mass is known."""
    if case.solver.inertia == 0.0:
        return []
    problems = []
    if case.solver.control == "arc_length":
        fault = "along a path that arc length follows no time passes, which inertia needs"
        problems.append(Problem("solver.inertia", fault, 'take control = "load"', case.solver.inertia))
    name = case.workpiece.material
    if name in case.materials and not case.materials[name].is_metal():
        remedy = 'add it: solver.inertia needs it, and no metal has this Young\'s modulus; steel has "7850 kg/m^3"'
        problems.append(Problem(f"materials.{name}.density", "missing key", remedy))
    return problems


def _check_sets(case: ShellCase, mesh: model.Mesh) -> list[Problem]:
    """Return the problems of set names, once the mesh is known."""
    uses = [(f"boundary.{name}.set", entry.set, False) for name, entry in case.boundary.items()]
    for index, stage in enumerate(case.stages):
        for kind in ("displacement", "rotation", "force", "pressure"):
            uses += [(f"stages.{index}.{kind}.{row}.set", e.set, False) for row, e in enumerate(getattr(stage, kind))]
        uses += [(f"stages.{index}.edge_force.{row}.set", e.set, True) for row, e in enumerate(stage.edge_force)]
    return check_set_names(uses, mesh)


def _check_freedoms(case: ShellCase, mesh: model.Mesh) -> list[Problem]:
    """Return the loads that find nothing to act on: pressure where no cell is, turning about the sheet's normal.

    The normal is that of the undeformed sheet, so turning is judged in the first stage alone.
    """
    problems = []
    for index, stage in enumerate(case.stages):
        for row, pressure in enumerate(stage.pressure):
            inside = np.zeros(len(mesh.points), dtype=bool)
            inside[mesh.node_sets[pressure.set]] = True
            if not any(inside[block.connectivity].all(axis=1).any() for block in mesh.blocks):
                fault, remedy = "no cell has all its nodes in the set", "name one that covers cells, for instance all"
                problems.append(Problem(f"stages.{index}.pressure.{row}.set", fault, remedy, pressure.set))
    first = case.stages[0]
    turns = [(f"force.{row}.moment", e.set, e.moment) for row, e in enumerate(first.force) if any(e.moment)]
    axes = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
    turns += [(f"rotation.{row}.axis", e.set, axes[e.axis]) for row, e in enumerate(first.rotation) if e.angle]
    if not turns:
        return problems
    directors = _find_directors(mesh)
    for key, name, turn in turns:
        own = np.isin(directors.node, mesh.node_sets[name]) & directors.smooth[directors.node]
        across = np.linalg.norm(np.cross(directors.vectors[own], turn), axis=1)
        if (
            own.any()
            and np.isin(mesh.node_sets[name], directors.node[own]).all()
            and (across < _ALONG * np.linalg.norm(turn)).all()
        ):
            fault = "acts about the normal of the sheet, and its nodes have no rotation about that"
            remedy = "turn the sheet by forces or displacements in its plane"
            value: object = list(turn) if key.endswith("moment") else first.rotation[int(key.split(".")[1])].axis
            problems.append(Problem(f"stages.0.{key}", fault, remedy, value))
    return problems


def _lay_zones(case: ShellCase, mesh: model.Mesh, planned: Sheets) -> model.Mesh:
    """Return the mesh with the zones of a welded sheet."""
    piece, folder = case.workpiece, case.source.parent if case.source is not None else Path()
    if not piece.zones:
        return mesh
    size = 2.0 * float(np.abs(mesh.points[:, :2]).max())
    regions, problems = draw_regions(piece, folder, size, "workpiece")
    _stop_at(problems, case)
    mesh, problems = lay_zones(mesh, piece, regions, planned.of_zone, "workpiece")
    _stop_at(problems, case)
    return mesh


def _build_mesh(case: ShellCase) -> model.Mesh:
    """Mesh the sheet, or read its mesh."""
    piece = case.workpiece
    material = list(case.materials).index(piece.material)
    section = model.Section(piece.section.thickness, piece.section.points, piece.section.rule)
    if isinstance(piece.mesh, ShellRectangle):
        rectangle = mesh_shell_rectangle(
            *grid_lines(piece.mesh),
            element=piece.element,
            section=section,
            pattern=piece.mesh.pattern,
            roll_radius=piece.mesh.roll_radius,
            material=material,
        )
        _check_normals(rectangle, case)
        return rectangle
    folder = case.source.parent if case.source is not None else Path()
    scale = unit_factor(piece.mesh.unit, LENGTH)
    try:
        mesh, notes = read_shell_mesh(
            folder / piece.mesh.path, element=piece.element, section=section, scale=scale, material=material
        )
    except MeshError as error:
        problem = Problem("workpiece.mesh.path", error.fault, error.remedy, piece.mesh.path)
        raise CaseError([problem], case.source) from error
    for note in notes:
        logger.warning("workpiece.mesh.path = %s: %s", piece.mesh.path, note)
    return mesh


def _check_roll(rectangle: ShellRectangle) -> list[Problem]:
    """Return a problem where a rectangle goes round its cylinder more than once, or its cells are too long for it."""
    if (radius := rectangle.roll_radius) is None:
        return []
    y = grid_lines(rectangle)[1]
    least = float(np.ptp(y)) / 2.0 / np.pi
    fault = f"{np.ptp(y):g} mm along y go round a cylinder of this radius more than once"
    if radius * (1.0 + 1e-9) > least:
        least = float(np.diff(y).max()) / 2.0 / WARPED
        fault = f"a cell spans more than {2.0 * np.degrees(WARPED):.0f} degrees of the cylinder"
    if radius * (1.0 + 1e-9) > least:
        return []
    return [
        Problem("workpiece.mesh.roll_radius", fault, f"give at least {least:.4g} mm, or more cells along y", radius)
    ]


def _check_normals(mesh: model.Mesh, case: ShellCase) -> None:
    """Raise CaseError for a rectangle with cells without a normal."""
    try:
        _find_directors(mesh)
    except MeshError as error:
        remedy = "change size, cells, zones or roll_radius so that cells are less long and thin, and nearly flat"
        _stop_at([Problem("workpiece.mesh", error.fault, remedy)], case)


def _find_directors(mesh: model.Mesh) -> Directors:
    slopes = [_core.shell_shape(block.element)[3] for block in mesh.blocks]
    return find_directors(mesh.points, mesh.blocks, slopes, mesh.normals)


def _build_stage(stage: ShellStage, case: ShellCase) -> model.Stage:
    """Turn a case's stage into the Model's."""
    moved = [(e.set, FREEDOMS.index(e.component), e.value) for e in stage.displacement]
    moved += [(e.set, 3 + FREEDOMS.index(e.axis), radians(e.angle)) for e in stage.rotation]
    return model.Stage(
        name=stage.name,
        duration=stage.duration,
        released=list_released(case.boundary, stage.name),
        prescribed=tuple(model.PrescribedDisplacement(*entry) for entry in moved),  # type: ignore[arg-type]
        forces=tuple(model.PointForce(e.set, (*e.value, *e.moment)) for e in stage.force),
        shell_pressures=tuple(model.ShellPressure(e.set, e.value) for e in stage.pressure),
        edge_forces=tuple(model.EdgeForce(e.set, e.value) for e in stage.edge_force),
        body_forces=tuple(model.BodyForce(e.value) for e in stage.body_force),
    )
