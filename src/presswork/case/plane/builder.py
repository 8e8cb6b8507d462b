# SPDX-License-Identifier: Apache-2.0
"""Turns a case into the Model: names resolved, the workpiece meshed, tools directed, everything checked.

A boundary entry is a symmetry plane when its key states it, or when it fixes one component only on an outermost
straight side of the workpiece normal to that component. In plane strain a tool that reaches one is twice what is
modelled.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from presswork import model
from presswork.case.errors import CaseError, Problem
from presswork.case.gravity import find_gravity
from presswork.case.heat.films import build_zones
from presswork.case.heat.forming_builder import build_heat, start_hot
from presswork.case.held_stages import list_released
from presswork.case.marked_points import build_points
from presswork.case.material.umat import UmatMaterial, build_umat
from presswork.case.motion.driven_nodes import list_driven_nodes
from presswork.case.plane import schema
from presswork.case.plane.bodies import build_bodies, build_contacts, list_bodies
from presswork.case.plane.reach import check_reach, check_room
from presswork.case.plane.references import check_references, check_sets
from presswork.case.plane.remesh import OF_SMALLEST
from presswork.case.plane.remesh_builder import build_remeshing, check_places, check_sizes, check_tools
from presswork.case.plane.separation import add_separation
from presswork.case.press.builder import build_drive, find_halves, list_blows
from presswork.case.settings import RAMP, build_output, build_solver
from presswork.case.tool_sizes import warn_of_tools
from presswork.case.tools.builder import build_tool, check_motions, find_first_direction
from presswork.case.tools.close_fits import close_fits
from presswork.case.tools.die_mesh import build_dies
from presswork.case.tools.rounded import round_outer_corners
from presswork.mesh.edges import edge_areas

logger = logging.getLogger(__name__)

_AXES = ("x", "y")


def build_plane_model(case: schema.Case, *, run_user_code: bool = True) -> model.Model:
    """Build the Model of a solid's case; arguments and errors as in kinds.build_model."""
    _stop_at(check_references(case), case)
    mesh, bodies = build_bodies(case)
    problems = check_sets(case, mesh)
    _stop_at(problems, case)
    materials, problems = build_materials(case.materials, case.source, 4, run_user_code)
    materials = tuple(start_hot(material, case.heat) for material in materials)
    _stop_at(problems, case)
    contacts, problems = build_contacts(case, mesh, bodies, materials)
    planes, plane_problems = _find_symmetry_planes(case, mesh, bodies)
    problems += plane_problems
    if case.analysis == "axisymmetric":
        problems += _check_axis(case, mesh)
    tools, tool_problems = _build_tools(case, mesh, planes)
    stages, stage_problems = _build_stages(case, planes, mesh)
    problems += tool_problems + stage_problems
    if case.remesh is not None:
        problems += check_places(case, mesh, bodies) or check_sizes(case.remesh, mesh, bodies)
        problems += check_tools(case.remesh, mesh, tools)
    problems = problems or check_motions(case, tools)
    if not problems and case.gravity is None and all(body.velocity is None for _, body in list_bodies(case).values()):
        problems = check_reach(tools, stages, mesh)
    tools, close = (tools, []) if problems else close_fits(tools, stages, mesh)
    held = ((name, entry.set, ("x" in entry.fix, "y" in entry.fix)) for name, entry in case.boundary.items())
    supports = tuple(model.Support(node_set, fix, name) for name, node_set, fix in held)
    problems = problems or check_room(tools, stages, supports, mesh)
    problems = problems or list(list_driven_nodes(tools, stages, supports, mesh))
    points, point_problems = build_points(case.points, mesh, _list_taken(case, stages))
    problems += point_problems
    dies, die_problems = build_dies(case, tools, _folder(case))
    _stop_at(problems + die_problems, case)
    remeshing = build_remeshing(case, mesh, bodies, tools)
    if remeshing is not None and not remeshing.keeps_first:
        tools = round_outer_corners(tools, OF_SMALLEST * remeshing.smallest_size)
    for text in close:
        logger.warning("%s", text)
    built = model.Model(
        title=case.title,
        analysis=case.analysis,
        depth=case.depth,
        mesh=mesh,
        materials=materials,
        tools=tools,
        supports=supports,
        stages=stages,
        solver=build_solver(case.solver, with_coulomb=_depends_on_pressure(case), with_body_contact=bool(contacts)),
        output=build_output(case.output),
        bodies=bodies,
        contacts=contacts,
        explicit=_build_explicit(case) if case.procedure == "explicit" else None,
        heat=build_heat(case, bodies, dies),
        series=case.series.to_model() if case.series else None,
        gravity=find_gravity(case.gravity),
        limits=case.limits.build(),
        points=points,
        remeshing=remeshing,
        case_text=case.text,
    )
    return add_separation(case, built)


def _list_taken(case: schema.Case, stages: Sequence[model.Stage]) -> set[str]:
    """Return the names that columns of the history have."""
    return {*case.tools, *case.contacts, *case.boundary, *(p.node_set for stage in stages for p in stage.prescribed)}


def _depends_on_pressure(case: schema.Case) -> bool:
    """Return whether the friction of a tool depends on the pressure."""
    return any(tool.contact in model.BY_PRESSURE or tool.friction is not None for tool in case.tools.values())


def _stop_at(problems: list[Problem], case: schema.Case) -> None:
    if problems:
        raise CaseError(problems, case.source)


def _folder(case: schema.Case) -> Path:
    """Return what paths in a case are relative to."""
    return case.source.parent if case.source is not None else Path()


def build_materials(
    materials: Mapping[str, schema.Material | UmatMaterial],
    source: Path | None,
    components: int,
    run_user_code: bool,
) -> tuple[tuple[model.Material, ...], list[Problem]]:
    """Return the Model's materials of solids whose stress has so many components, and the problems of UMATs."""
    folder = source.parent if source is not None else Path()
    built = [
        build_umat(name, material, folder, components, run_user_code=run_user_code)
        if isinstance(material, UmatMaterial)
        else build_material(name, material)
        for name, material in materials.items()
    ]
    made = tuple(material for material in built if isinstance(material, model.Material))
    return made, [problem for problem in built if isinstance(problem, Problem)]


def build_material(name: str, material: schema.Material) -> model.Material:
    """Return the Model's material of a table that is no UMAT."""
    thermal = material.thermal.to_thermal(material.density) if material.thermal and material.density else None
    made = material.to_model(name)
    return replace(
        made if material.gtn is None else material.gtn.apply(made),
        density=material.density or 0.0,
        thermal=thermal,
        transformation=material.transformation.to_model() if material.transformation else None,
        rolling_direction=material.find_rolling_direction(),
        grain=material.grain.to_model() if material.grain else None,
    )


def _build_explicit(case: schema.Case) -> model.ExplicitSolid:
    velocity, *others = (body.velocity or (0.0, 0.0) for _, body in list_bodies(case).values())
    return model.ExplicitSolid(velocity=velocity, velocity_of_others=tuple(others), **case.explicit.model_dump())


def _find_symmetry_planes(
    case: schema.Case, mesh: model.Mesh, bodies: tuple[model.Body, ...]
) -> tuple[tuple[model.FloatArray, model.FloatArray], list[Problem]]:
    """Return the positions [mm] of the symmetry planes normal to x and y that count for tools, and problems."""
    planes: tuple[list[float], list[float]] = ([], [])
    problems = []
    tolerance = 1e-6 * float(np.linalg.norm(np.ptp(mesh.points, axis=0)))
    for name, entry in case.boundary.items():
        fixed = sorted(set(entry.fix))
        axis = _AXES.index(fixed[0])
        nodes = mesh.node_sets[entry.set]
        body = next(body for body in bodies if nodes[0] in body.points)
        points = mesh.points[body.points.start : body.points.stop]
        low, high = points.min(axis=0), points.max(axis=0)
        coordinate = mesh.points[nodes, axis]
        lasting = entry.stages is None
        outermost = min(coordinate.min() - low[axis], high[axis] - coordinate.max()) < tolerance
        on_line = np.abs(points[:, axis] - coordinate[0]) < tolerance
        is_whole_side = len(nodes) > 1 and on_line.sum() == len(nodes)
        if len(fixed) == 1 and np.ptp(coordinate) < tolerance and outermost and is_whole_side and lasting:
            if entry.symmetry is not False:
                planes[axis].append(float(coordinate.mean()))
        elif entry.symmetry:
            problems.append(
                Problem(
                    f"boundary.{name}.symmetry",
                    f"the set `{entry.set}` with fix = {fixed} is not a symmetry plane of the workpiece",
                    "fix one component in all stages, on the whole of an outermost straight side normal to it, or "
                    "leave symmetry out",
                    True,
                )
            )
    return (np.array(planes[0]), np.array(planes[1])), problems


def _check_axis(case: schema.Case, mesh: model.Mesh) -> list[Problem]:
    """Return the problems of a workpiece about the axis x = 0."""
    x = mesh.points[:, 0]
    tolerance = 1e-6 * float(np.linalg.norm(np.ptp(mesh.points, axis=0)))
    if x.min() < -tolerance:
        return [
            Problem(
                "workpiece.mesh",
                f"the workpiece reaches to x = {x.min():.6g} mm, but x is the radius in an axisymmetric analysis",
                "model the half at x >= 0, with the axis at x = 0",
            )
        ]
    fixed = [mesh.node_sets[entry.set] for entry in case.boundary.values() if "x" in entry.fix and entry.stages is None]
    on_axis = np.flatnonzero(x < tolerance)
    loose = np.setdiff1d(on_axis, np.concatenate(fixed)) if fixed else on_axis
    if len(loose) == 0:
        return []
    return [
        Problem(
            "boundary",
            f"{len(loose)} nodes on the axis of rotation (x = 0) are free to leave it",
            'add [boundary.axis] with set = "left" and fix = ["x"]',
        )
    ]


def _build_edge_force(entry: schema.EdgeForce, area: float) -> model.EdgeForce:
    """Return a force per area; area: of the set on the first mesh [mm2]."""
    if entry.value is not None:
        return model.EdgeForce(entry.set, entry.value, area)
    assert entry.total is not None
    return model.EdgeForce(entry.set, (entry.total[0] / area, entry.total[1] / area), area)


def _build_tools(
    case: schema.Case, mesh: model.Mesh, planes: tuple[model.FloatArray, model.FloatArray]
) -> tuple[tuple[model.Tool, ...], list[Problem]]:
    """Return the Model's tools, and the problems of others."""
    is_ring = case.analysis == "axisymmetric"
    of_tools = (np.zeros(0), np.zeros(0)) if is_ring else planes
    built = [
        build_tool(name, tool, mesh, of_tools, _folder(case), find_first_direction(case, name), is_axisymmetric=is_ring)
        for name, tool in case.tools.items()
    ]
    tools = tuple(tool for tool in built if isinstance(tool, model.Tool))
    for warning in warn_of_tools(case.tools, tools, float(np.linalg.norm(np.ptp(mesh.points, axis=0)))):
        logger.warning("%s", warning)
    return tools, [tool for tool in built if isinstance(tool, Problem)]


def _build_stages(
    case: schema.Case, planes: tuple[model.FloatArray, model.FloatArray], mesh: model.Mesh
) -> tuple[tuple[model.Stage, ...], list[Problem]]:
    """Return the Model's stages, several of one that strikes several blows, and the problems of presses."""
    stages: list[model.Stage] = []
    problems: list[Problem] = []
    blows: dict[str, int] = {}
    is_ring = case.analysis == "axisymmetric"
    mirrors = (planes[0][:0], planes[1]) if is_ring else planes

    def area_of(edge_set: str) -> float:
        return float(edge_areas(mesh.points, mesh.edge_sets[edge_set], None if is_ring else case.depth).sum())

    for number, stage_case in enumerate(case.stages):
        stage = _build_stage(stage_case, case, area_of)
        drive = build_drive(stage_case.find_timing(number), case.presses, find_halves(stage, mirrors))
        if isinstance(drive, Problem):
            problems.append(drive)
        elif drive is not None:
            stage = replace(stage, drive=drive, duration=drive.duration)
        struck = blows.get(stage_case.press.name, 0) if stage_case.press else 0
        listed = list_blows(stage, stage_case.press, struck + 1)
        if stage_case.press is not None:
            blows[stage_case.press.name] = struck + stage_case.press.blows
        stages += listed
    return tuple(stages), problems


def _build_stage(stage: schema.Stage, case: schema.Case, area_of: Callable[[str], float]) -> model.Stage:
    """Turn a case's stage into the Model's; area_of: gives the area of an edge set [mm2]."""
    ramp = RAMP * stage.duration if stage.ramp is None else stage.ramp
    return model.Stage(
        name=stage.name,
        duration=stage.duration,
        ramp=ramp if case.procedure == "explicit" else 0.0,
        released=list_released(case.boundary, stage.name),
        tool_motion={name: motion.build() for name, motion in stage.tools.items()},
        prescribed=tuple(
            model.PrescribedDisplacement(entry.set, 0 if entry.component == "x" else 1, entry.value)
            for entry in stage.displacement
        ),
        forces=tuple(model.PointForce(entry.set, entry.value) for entry in stage.force),
        pressures=tuple(model.Pressure(entry.set, entry.value) for entry in stage.pressure),
        heat=build_zones(stage.convection),
        edge_forces=tuple(_build_edge_force(entry, area_of(entry.set)) for entry in stage.edge_force),
    )
