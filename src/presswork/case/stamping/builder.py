# SPDX-License-Identifier: Apache-2.0
"""Turns a stamping's case into its Model: names resolved, the blank meshed, tools drawn and placed, all checked."""

from __future__ import annotations

import logging
from dataclasses import replace
from math import cos, radians, sin
from pathlib import Path
from typing import Any

import numpy as np

from presswork import model
from presswork.case.errors import CaseError, Problem
from presswork.case.gravity import find_gravity
from presswork.case.held_stages import check_held_stages
from presswork.case.marked_points import build_points
from presswork.case.material.umat import UmatMaterial
from presswork.case.plane.references import check_set_names
from presswork.case.shell.schema import FREEDOMS, HOLDS
from presswork.case.stamping.bead_strip import refuse_unknown
from presswork.case.stamping.beads import build_beads, check_bead_stages, check_closing
from presswork.case.stamping.binder import resolve_closings
from presswork.case.stamping.blank import BlankFile, CircularBlank, OutlinedBlank, TubeBlank
from presswork.case.stamping.checks import (
    MOST_CELLS,
    check_fit,
    check_names,
    check_speeds,
    check_target_step,
    check_tools,
    check_travel,
    explain_too_many,
)
from presswork.case.stamping.clashes import check_clashes
from presswork.case.stamping.heat_builder import add_heat, build_sheet_heat, check_sheet_heat
from presswork.case.stamping.line import (
    build_operation,
    check_closings,
    check_operations,
    name_operation,
    name_parts,
    view_operation,
)
from presswork.case.stamping.place import build_tools
from presswork.case.stamping.plan_line import LineFile, draw_line
from presswork.case.stamping.pressure_builder import build_courses, build_pressures, check_pressures
from presswork.case.stamping.schema import StampingCase
from presswork.case.stamping.stage_builder import build_stages
from presswork.case.stamping.symmetry import check_line_symmetry, check_tool_symmetry
from presswork.case.tool_sizes import check_thickness
from presswork.case.units import LENGTH, unit_factor
from presswork.case.zones.build import check_table, divide_blank, draw_regions, find_weld_lines, is_made, lay_zones
from presswork.case.zones.materials import Sheets, build_zone_sheets, check_zones, plan_sheets
from presswork.geometry.polygon import polygon_area
from presswork.mesh import MeshError
from presswork.mesh.cut import check_meets
from presswork.mesh.files.dynain import is_dynain, read_dynain
from presswork.mesh.files.readers import read_raw
from presswork.mesh.make.blanks import assign_section, mesh_circular_blank, mesh_rectangular_blank
from presswork.mesh.make.outlined_blank import mesh_outlined_blank
from presswork.mesh.make.tubes import mesh_tube
from presswork.mesh.outer_edge import find_outer_edge
from presswork.mesh.shells import read_shell_mesh
from presswork.mesh.topology import find_boundary_edges, find_parts

logger = logging.getLogger(__name__)

IMPLICIT_ELEMENTS: dict[str, model.ElementName] = {"tri3": "shell3_mitc_plus", "quad4": "shell4_mitc"}
"""Elements by number of nodes."""
SYMMETRY_SETS = ("symmetry_x", "symmetry_y")


def build_stamping_model(case: StampingCase, *, run_user_code: bool = True) -> model.Model:
    """Build the Model of a stamping; raises CaseError with every problem of the first kind that is found.

    run_user_code: try the shared libraries that it names. Without it beads may be described by their geometry alone.
    """
    if run_user_code:
        refuse_unknown(case)
    if not case.operations:
        return _build_first(case, _check_first(case), run_user_code)
    _stop_at(check_operations(case), case)
    views = [view_operation(case, number) for number in range(len(case.operations))]
    checked = []
    for number, view in enumerate(views):
        with name_operation(number):
            checked.append(_check_first(view))
    with name_operation(0):
        first = _build_first(views[0], checked[0], run_user_code)
    following, before = [], _sum_strokes(views[0])
    for number in range(1, len(views)):
        view, operation = views[number], case.operations[number]
        with name_operation(number):
            parts = _build_parts(view, checked[number], first.mesh, before, is_moved=operation.place is not None)
        following.append(build_operation(operation, name_parts(replace(first, **parts), operation.name)))
        before += _sum_strokes(view)
    return replace(name_parts(first, case.operations[0].name), following=tuple(following))


def _sum_strokes(case: StampingCase) -> float:
    return sum(abs(action.stroke) for stage in case.stages for action in stage.tools.values() if action.stroke)


def _check_first(case: StampingCase) -> tuple[model.Stage, ...]:
    """Raise CaseError for what shows without geometry; return the stages."""
    _stop_at(check_names(case) + check_bead_stages(case) + check_pressures(case), case)
    _stop_at(check_sheet_heat(case) + check_zones(case), case)
    _stop_at(check_tools(case) + check_travel(case) + check_closings(case), case)
    stages, problems = build_stages(case)
    _stop_at(problems, case)
    _stop_at(check_target_step(case, stages) + check_speeds(case, stages), case)
    return stages


def _build_parts(
    case: StampingCase, stages: tuple[model.Stage, ...], mesh: model.Mesh, before: float | None, *, is_moved: bool
) -> dict[str, Any]:
    """Return what an operation has of its own, as fields of a Model; before: as of build_tools."""
    uses = [(f"boundary.{name}.set", entry.set, False) for name, entry in case.boundary.items()]
    for index, stage in enumerate(case.stages):
        uses += [(f"stages.{index}.displacement.{i}.set", e.set, False) for i, e in enumerate(stage.displacement)]
    names = [stage.name for stage in case.stages]
    _stop_at(check_set_names(uses, mesh) + check_held_stages(case.boundary, names), case)
    thin = check_thickness(case.blank.thickest, float(np.linalg.norm(np.ptp(mesh.points, axis=0))))
    _stop_at([thin] if thin is not None else [], case)
    tools, problems = build_tools(case, mesh, before)
    _stop_at(problems, case)
    _stop_at(check_tool_symmetry(case, mesh, tools), case)
    if before is None and any(action.close for stage in case.stages for action in stage.tools.values()):
        case, problems = resolve_closings(case, tools)
        _stop_at(problems, case)
        stages, _ = build_stages(case)
        _stop_at(check_target_step(case, stages) + check_speeds(case, stages), case)
    is_flat = not isinstance(case.blank, BlankFile) or not is_dynain(case.blank.path)
    if before is None and is_flat:  # how a formed part lies in its tools shows when it begins
        _stop_at(check_fit(case, mesh, tools), case)
        _stop_at(check_clashes(case, mesh, tools), case)
    stages, problems = build_courses(case, stages)
    _stop_at(problems, case)
    pressures, problems = build_pressures(case, mesh, tools, is_flat=before is None and is_flat)
    _stop_at(problems, case)
    beads, problems = build_beads(case, mesh, tools)
    _stop_at(problems, case)
    _stop_at(check_closing(case, beads, 2 ** len(set(case.blank.symmetry))), case)
    if case.trim and case.self_contact and find_parts([b.connectivity for b in mesh.blocks], len(mesh.points))[0] > 1:
        fault = "a blank of several sheets that lie on each other is not trimmed"
        _stop_at([Problem("trim", fault, "cut the sheets in their file")], case)
    trim, problems = _build_trim(case, None if is_moved else mesh)
    _stop_at(problems + check_line_symmetry(case, mesh, trim), case)
    symmetry = ("x" in case.blank.symmetry, "y" in case.blank.symmetry)
    supports = [
        model.Support(name, tuple(freedom in HOLDS[name] for freedom in FREEDOMS), name)
        for name, is_cut in zip(SYMMETRY_SETS, symmetry, strict=True)
        if is_cut
    ]
    return {
        "tools": tools,
        "supports": (*supports, *(entry.build(name) for name, entry in case.boundary.items())),
        "stages": stages,
        "beads": beads,
        "sheet_pressures": pressures,
        "trim": trim,
        "springback": case.springback.build() if case.springback else None,
        "hem": case.hem.build() if case.hem else None,
    }


def _build_first(case: StampingCase, stages: tuple[model.Stage, ...], run_user_code: bool) -> model.Model:
    """Build the Model of one operation."""
    planned = plan_sheets(case.materials, case.blank)
    mesh = _build_mesh(case, planned)
    parts = _build_parts(case, stages, mesh, None, is_moved=False)
    taken = {*case.tools, *SYMMETRY_SETS, *case.boundary, *(e.set for stage in case.stages for e in stage.displacement)}
    points, problems = build_points(case.points, mesh, taken)
    _stop_at(problems + _check_draw_in(case, mesh), case)
    blank = case.blank
    sheets = build_zone_sheets(case.materials, blank, planned, case.source, run_user_code)
    angle = radians(blank.rolling_direction)
    return model.Model(
        title=case.title,
        analysis="stamping",
        mesh=mesh,
        rolling_direction=(cos(angle), sin(angle), 0.0),
        materials=tuple(add_heat(sheet, case) if case.heat else sheet for sheet in sheets),
        zones=("", *(zone.name for zone in blank.zones)) if blank.zones else (),
        is_relieved=blank.relief,
        symmetry=("x" in case.blank.symmetry, "y" in case.blank.symmetry),
        explicit=model.ExplicitSheet(**case.explicit.model_dump()) if case.procedure == "explicit" else None,
        solver=case.implicit.build(),
        output=model.OutputSettings(**case.output.model_dump()),
        refinement=model.Refinement(blank.refine.levels, radians(blank.refine.angle)) if blank.refine else None,
        formed=_read_formed(case),
        self_contact=model.SheetSelfContact(case.self_contact.mu) if case.self_contact else None,
        heat=build_sheet_heat(case),
        gravity=find_gravity(case.gravity),
        limits=case.limits.build(),
        points=points,
        draw_in=tuple(model.DrawInDirection(name, radians(angle)) for name, angle in case.draw_in.items()),
        one_step_thinning=case.one_step_thinning,
        case_text=case.text,
        **parts,
    )


def _check_draw_in(case: StampingCase, mesh: model.Mesh) -> list[Problem]:
    """Return the problems of directions in which no edge of a flat blank lies."""
    if case.draw_in and isinstance(case.blank, BlankFile) and is_dynain(case.blank.path):
        fault = "a formed blank has been drawn in before the run begins"
        return [Problem("draw_in", fault, "leave it out; [points] follow places of the edge")]
    remedy = "take an angle at which a part of the blank lies that is computed (blank.symmetry)"
    return [
        Problem(f"draw_in.{name}", "no edge of the blank lies in this direction", remedy, angle)
        for name, angle in case.draw_in.items()
        if find_outer_edge(mesh, radians(angle)) is None
    ]


def _stop_at(problems: list[Problem], case: StampingCase) -> None:
    if problems:
        raise CaseError(problems, case.source)


def _build_mesh(case: StampingCase, planned: Sheets) -> model.Mesh:
    """Mesh the blank, or read its mesh, and give its cells what zones and tables have."""
    blank = case.blank
    folder = case.source.parent if case.source is not None else Path()
    symmetry = ["x" in blank.symmetry, "y" in blank.symmetry]
    mesh = _mesh_sheet(case, planned.of_zone[0], symmetry)
    if blank.is_uniform:
        return mesh
    regions, problems = draw_regions(blank, folder, 2.0 * float(np.abs(mesh.points[:, :2]).max()))
    _stop_at(problems + check_table(blank, mesh), case)
    if is_made(blank) and any(regions):
        section = mesh.blocks[0].section
        assert section is not None
        mesh = assign_section(divide_blank(mesh, regions, symmetry), _elements(case), section, planned.of_zone[0])
    mesh, problems = lay_zones(mesh, blank, regions, planned.of_zone)
    _stop_at(problems, case)
    return mesh


def _mesh_sheet(case: StampingCase, material: int, symmetry: list[bool]) -> model.Mesh:
    """Mesh the blank, or read its mesh, as one sheet."""
    blank = case.blank
    section = model.Section(blank.mean_thickness, blank.points, blank.rule)
    if isinstance(blank, BlankFile):
        return _read_mesh(case, blank, section, material, symmetry)
    if isinstance(blank, OutlinedBlank):
        mesh = _mesh_outline(case, blank, symmetry)
    elif isinstance(blank, TubeBlank):
        radius, triangles = 0.5 * (blank.diameter - blank.thickest), blank.cells == "triangles"
        mesh = mesh_tube(radius, blank.length, blank.element_size, symmetry, triangles=triangles)
    elif isinstance(blank, CircularBlank):
        mesh = mesh_circular_blank(blank.diameter, blank.element_size, symmetry, triangles=blank.cells == "triangles")
    else:
        welds, triangles = find_weld_lines(blank), blank.cells == "triangles"
        mesh = mesh_rectangular_blank(blank.size, blank.element_size, symmetry, triangles=triangles, welds=welds)
    return assign_section(mesh, _elements(case), section, material)


def _elements(case: StampingCase) -> dict[str, model.ElementName]:
    """Return the elements that the case takes, by their kind of cell."""
    return {"tri3": "shell3_1pt", "quad4": case.explicit.element} if case.procedure == "explicit" else IMPLICIT_ELEMENTS


def _mesh_outline(case: StampingCase, blank: OutlinedBlank, symmetry: list[bool]) -> model.Mesh:
    """Read the outline of a blank, and mesh what lies in it."""
    folder = case.source.parent if case.source is not None else Path()
    file = LineFile(shape="file", path=blank.path, unit=blank.unit, layer=blank.layer)
    line = draw_line(file, "blank", folder)
    if isinstance(line, Problem):
        raise CaseError([line], case.source)
    n_cells = abs(polygon_area(line)) / blank.element_size**2 / 2 ** sum(symmetry)
    if n_cells > MOST_CELLS:
        raise CaseError([explain_too_many(n_cells, blank.element_size)], case.source)
    try:
        return mesh_outlined_blank(line, blank.element_size, symmetry, triangles=blank.cells == "triangles")
    except MeshError as error:
        raise CaseError([Problem("blank.path", error.fault, error.remedy, blank.path)], case.source) from error


def _build_trim(case: StampingCase, mesh: model.Mesh | None) -> tuple[tuple[model.TrimLine, ...], list[Problem]]:
    """Draw or read the trim lines, and compare them with the blank, beyond which no part reaches.

    mesh: of the blank; None of a part that is placed elsewhere.
    """
    folder = case.source.parent if case.source is not None else Path()
    lines, problems = [], []
    for name, trim in case.trim.items():
        polygon = draw_line(trim, f"trim.{name}", folder)
        if isinstance(polygon, Problem):
            problems.append(polygon)
            continue
        try:
            if mesh is not None:
                check_meets(mesh.points, polygon, trim.keep)
        except MeshError as error:
            problems.append(Problem(f"trim.{name}", error.fault.replace("the sheet", "the blank"), error.remedy))
        lines.append(model.TrimLine(name, polygon, trim.keep))
    return tuple(lines), problems


def _read_mesh(
    case: StampingCase, blank: BlankFile, section: model.Section, material: int, symmetry: list[bool]
) -> model.Mesh:
    """Read the mesh of a blank, and find its nodes in the symmetry planes."""
    path = (case.source.parent if case.source is not None else Path()) / blank.path
    if is_dynain(path):
        return _mesh_formed(case, blank, section, material, symmetry)
    try:
        kinds = sorted(read_raw(path).cells)
        if len(kinds) != 1 or kinds[0] not in IMPLICIT_ELEMENTS:
            raise MeshError(
                f"the cells are neither quadrilaterals alone nor triangles alone: {', '.join(kinds)}",
                "mesh with 4-node cells, or with 3-node cells",
            )
        element = IMPLICIT_ELEMENTS[kinds[0]]
        scale = unit_factor(blank.unit, LENGTH)
        mesh, notes = read_shell_mesh(
            path, element=element, section=section, scale=scale, material=material, in_parts=bool(case.self_contact)
        )
    except MeshError as error:
        remedy = error.remedy
        if "share no node" in error.fault:
            remedy += "; sheets that lie on each other and touch need [self_contact]"
        raise CaseError([Problem("blank.path", error.fault, remedy, blank.path)], case.source) from error
    for note in notes:
        logger.warning("blank.path = %s: %s", blank.path, note)
    return assign_section(_name_nodes(case, blank, mesh, symmetry), _elements(case), section, material)


def _read_formed(case: StampingCase) -> model.FormedSheet | None:
    """Read the formed sheet that takes the blank's place; None: it is a blank."""
    if not isinstance(case.blank, BlankFile) or not is_dynain(case.blank.path):
        return None
    table = case.materials[case.blank.material]
    if not isinstance(table, UmatMaterial) and table.kinematic is not None:
        fault = "back stresses of a formed sheet are not in its file"
        remedy = "take a law without kinematic, or compute the operations in one case ([[operations]])"
        raise CaseError([Problem(f"materials.{case.blank.material}.kinematic", fault, remedy)], case.source)
    if not case.blank.is_uniform:
        fault = "a formed sheet has the thickness of each element in its file, and one material"
        remedy = "give one thickness and no zones; form a welded blank in one case ([[operations]])"
        key = "blank.zones" if case.blank.zones else "blank.thickness"
        raise CaseError([Problem(key, fault, remedy)], case.source)
    if case.operations or case.blank.refine is not None:
        key = "operations" if case.operations else "blank.refine"
        raise CaseError([Problem(key, "not with a formed sheet", "give it as a case of one operation")], case.source)
    try:
        return read_dynain((case.source.parent if case.source is not None else Path()) / case.blank.path)
    except MeshError as error:
        raise CaseError([Problem("blank.path", error.fault, error.remedy, case.blank.path)], case.source) from error


def _mesh_formed(
    case: StampingCase, blank: BlankFile, section: model.Section, material: int, symmetry: list[bool]
) -> model.Mesh:
    """Return the mesh of a formed sheet: quadrilaterals, then triangles."""
    sheet = _read_formed(case)
    assert sheet is not None
    is_triangle = sheet.cells[:, 2] == sheet.cells[:, 3]
    if (np.diff(is_triangle.astype(int)) < 0).any():
        fault = "a triangle stands before a quadrilateral"
        raise CaseError([Problem("blank.path", fault, "write quadrilaterals first", blank.path)], case.source)
    kinds = [cells for cells in (sheet.cells[~is_triangle], sheet.cells[is_triangle, :3]) if len(cells)]
    elements = _elements(case)
    blocks = tuple(
        model.CellBlock(elements[model.find_cell(2, cells).name], cells, material, section) for cells in kinds
    )
    boundary = find_boundary_edges(kinds)
    mesh = model.Mesh(sheet.points, blocks, {}, {}, boundary)
    return _name_nodes(case, blank, mesh, symmetry)


def _name_nodes(case: StampingCase, blank: BlankFile, mesh: model.Mesh, symmetry: list[bool]) -> model.Mesh:
    """Return the mesh of a file with its nodes in the symmetry planes and on its edge."""
    tolerance = 1e-6 * float(np.ptp(mesh.points, axis=0).max())
    node_sets = dict(mesh.node_sets)
    outline = mesh.boundary_edges
    for axis, name in enumerate(SYMMETRY_SETS):
        if not symmetry[axis]:
            continue
        at = mesh.points[:, axis]
        node_sets[name] = np.flatnonzero(np.abs(at) <= tolerance).astype(np.int32)
        if at.min() < -tolerance or len(node_sets[name]) < 2:
            fault = f"the mesh does not end at the symmetry plane {'xy'[axis]} = 0: it reaches from {at.min():g} mm"
            raise CaseError([Problem("blank.symmetry", fault, "cut the mesh there", blank.symmetry)], case.source)
        outline = outline[~np.isin(outline, node_sets[name]).all(axis=1)]
    node_sets.setdefault("edge", np.unique(outline).astype(np.int32))
    return replace(mesh, node_sets=node_sets)
