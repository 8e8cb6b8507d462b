# SPDX-License-Identifier: Apache-2.0
"""Turns a case of heat alone into the Model: names resolved, bodies meshed, everything checked."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from presswork import model
from presswork.case.errors import CaseError, Problem, suggest
from presswork.case.heat.schema import HeatBody, HeatCase, HeatStage
from presswork.case.plane.bodies import WORKPIECE, mesh_body
from presswork.case.plane.references import check_set_names
from presswork.case.plane.workpiece import MeshFile, Rectangle
from presswork.case.settings import build_output
from presswork.case.space.mesh import MadeMesh
from presswork.case.space.mesh_builder import check_space_mesh, mesh_space_body
from presswork.case.units import LENGTH, unit_factor
from presswork.mesh import fitting_patterns
from presswork.mesh.facing import find_touching_faces
from presswork.mesh.joined import join_meshes

_FAMILY = {"plane": "plane", "axisymmetric": "plane", "solid": "space"}
_ANALYSIS: dict[str, model.Analysis] = {"plane": "plane_strain", "axisymmetric": "axisymmetric", "solid": "solid"}


def build_heat_model(case: HeatCase) -> model.Model:
    """Build the Model of a case of heat alone; raises CaseError with every problem of the first kind that is found."""
    _stop_at([*_check_bodies(case), *_check_contacts(case), *_check_stages(case)], case)
    mesh, bodies = _build_meshes(case)
    _stop_at([*_check_sets(case, mesh), *_check_axis(case, mesh)], case)
    heat = model.Heat(
        initial=tuple(
            case.initial_temperature if body.initial_temperature is None else body.initial_temperature
            for _, body in _list_bodies(case).values()
        ),
        contacts=_build_contacts(case, bodies),
        **case.solver.model_dump(),
    )
    built = model.Model(
        title=case.title,
        analysis=_ANALYSIS[case.geometry],
        depth=case.depth if case.geometry == "plane" else 1.0,
        mesh=mesh,
        materials=tuple(material.to_model(name) for name, material in case.materials.items()),
        tools=(),
        supports=(),
        stages=tuple(_build_stage(stage) for stage in case.stages),
        solver=model.SolverSettings(),
        output=build_output(case.output),
        bodies=bodies,
        heat=heat,
        case_text=case.text,
    )
    _stop_at(list(_check_touching(case, built)), case)
    return built


def _stop_at(problems: list[Problem], case: HeatCase) -> None:
    if problems:
        raise CaseError(problems, case.source)


def _list_bodies(case: HeatCase) -> dict[str, tuple[str, HeatBody]]:
    """Return every body by its name, the workpiece first, with the key that describes it."""
    return {
        WORKPIECE: ("workpiece", case.workpiece),
        **{name: (f"bodies.{name}", body) for name, body in case.bodies.items()},
    }


def _element(case: HeatCase, body: HeatBody) -> str:
    return body.element or ("hex8" if case.geometry == "solid" else "quad4")


def _check_bodies(case: HeatCase) -> Iterator[Problem]:
    """Yield the problems of bodies that show without their meshes."""
    if case.geometry != "plane" and "depth" in case.model_fields_set:
        yield Problem("depth", "has a meaning in the plane alone", "remove it", case.depth)
    if "rows" in case.output.model_fields_set:
        yield Problem("output.rows", "the history has a row a time step", "remove it", case.output.rows)
    for name, (key, body) in _list_bodies(case).items():
        element = _element(case, body)
        family = model.ELEMENTS[element].family.name
        if name == WORKPIECE and key != "workpiece":
            yield Problem(key, "this name is taken already", "give the body another")
        if body.material not in case.materials:
            remedy = suggest(body.material, case.materials, "materials")
            yield Problem(f"{key}.material", "no such material", remedy, body.material)
        if element == "tet10":
            fault = "tetrahedra of 10 nodes conduct no heat: their corners would have to store less than nothing"
            yield Problem(f"{key}.element", fault, "take tet4_mini or hex8", element)
        if family != _FAMILY[case.geometry]:
            remedy = "take hex8" if case.geometry == "solid" else 'take quad4, or geometry = "solid"'
            yield Problem(f"{key}.element", f"no element of geometry = {case.geometry}", remedy, element)
        elif isinstance(body.mesh, MadeMesh) != (case.geometry == "solid") and not isinstance(body.mesh, MeshFile):
            what = f"a {body.mesh.kind}"
            remedy = "give size = [x, y, z] and cells of three" if case.geometry == "solid" else "give size = [x, y]"
            yield Problem(f"{key}.mesh", f"{what} does not go with geometry = {case.geometry}", remedy)
        elif isinstance(body.mesh, Rectangle) and body.mesh.pattern is not None:
            fitting = fitting_patterns(element)
            if body.mesh.pattern not in fitting:
                remedy = f"choose one of: {', '.join(fitting)}; or another element"
                yield Problem(f"{key}.mesh.pattern", f"does not fit element = {element}", remedy, body.mesh.pattern)
        elif isinstance(body.mesh, MadeMesh):
            yield from check_space_mesh(f"{key}.mesh", body.mesh, element)
        if isinstance(body.mesh, MeshFile):
            try:
                unit_factor(body.mesh.unit, LENGTH)
            except ValueError as error:
                fault = f"expected a unit of length, but {error}"
                yield Problem(f"{key}.mesh.unit", fault, "e.g. mm, m, inch", body.mesh.unit)
        if case.contacts and case.geometry != "solid" and model.cell_of(element).is_quadratic:
            fault = "heat flows between bodies with straight edges of two nodes only"
            yield Problem(f"{key}.element", fault, "take quad4 or tri3", element)
        elif case.bodies and model.ELEMENTS[element].cell != model.ELEMENTS[_element(case, case.workpiece)].cell:
            fault = "hexahedra and tetrahedra do not go together in one case"
            if case.geometry == "solid":
                yield Problem(f"{key}.element", fault, "take cells of one kind for all bodies", element)


def _check_contacts(case: HeatCase) -> Iterator[Problem]:
    bodies = _list_bodies(case)
    for name, contact in case.contacts.items():
        key = f"contacts.{name}.between"
        for body in contact.between:
            if body not in bodies:
                yield Problem(key, f"no such body: {body}", suggest(body, bodies, "bodies"))
        if contact.between[0] == contact.between[1]:
            yield Problem(key, "a body gives no heat to itself", "name two bodies", list(contact.between))
    touched = {body for contact in case.contacts.values() for body in contact.between}
    for name in case.bodies:
        if name not in touched:
            remedy = f'add [contacts.NAME] with between = ["workpiece", "{name}"], or leave the body out'
            yield Problem(f"bodies.{name}", "no contact names this body: no heat would reach it", remedy)


def _check_stages(case: HeatCase) -> Iterator[Problem]:
    names = [stage.name for stage in case.stages]
    for index, stage in enumerate(case.stages):
        if stage.name in names[:index]:
            yield Problem(f"stages.{index}.name", "two stages have this name", "give each its own", stage.name)
        held = [entry.set for entry in stage.temperature]
        for row, name in enumerate(held):
            if name in held[:row]:
                key = f"stages.{index}.temperature.{row}.set"
                yield Problem(key, "two temperatures are prescribed on this set", "leave one of them", name)
    if not case.contacts and not any(
        stage.temperature or stage.flux or stage.convection or stage.radiation for stage in case.stages
    ):
        remedy = "add [[stages.convection]], [[stages.radiation]], [[stages.flux]] or [[stages.temperature]]"
        yield Problem("stages.0", "nothing heats or cools the body in any stage", remedy)


def _check_sets(case: HeatCase, mesh: model.Mesh) -> list[Problem]:
    uses = []
    for index, stage in enumerate(case.stages):
        for kind in ("temperature", "flux", "convection", "radiation"):
            for row, entry in enumerate(getattr(stage, kind)):
                uses.append((f"stages.{index}.{kind}.{row}.set", entry.set, kind != "temperature"))
    return check_set_names(uses, mesh, sides="face" if case.geometry == "solid" else "edge")


def _check_axis(case: HeatCase, mesh: model.Mesh) -> Iterator[Problem]:
    if case.geometry == "axisymmetric" and mesh.points[:, 0].min() < -1e-9 * float(np.ptp(mesh.points[:, 0])):
        remedy = "x is the radius: move the mesh to x >= 0"
        yield Problem("workpiece.mesh", f"x reaches {mesh.points[:, 0].min():g} mm, beyond the axis", remedy)


def _build_meshes(case: HeatCase) -> tuple[model.Mesh, tuple[model.Body, ...]]:
    materials = list(case.materials)
    parts = {}
    for name, (key, body) in _list_bodies(case).items():
        material, element = materials.index(body.material), _element(case, body)
        if isinstance(body.mesh, MadeMesh) or case.geometry == "solid":
            assert not isinstance(body.mesh, Rectangle)
            parts[name] = mesh_space_body(key, body.mesh, element, material, case.source)
        else:
            parts[name] = mesh_body(key, body.mesh, element, material, case.source)
    if case.geometry == "solid" and not case.bodies:
        return parts[WORKPIECE], ()
    mesh, bodies = join_meshes(parts)
    return mesh, bodies


def _build_contacts(case: HeatCase, bodies: tuple[model.Body, ...]) -> tuple[model.HeatContact, ...]:
    number = {body.name: i for i, body in enumerate(bodies)}
    return tuple(
        model.HeatContact(
            name, (number[entry.between[0]], number[entry.between[1]]), np.array([[0.0, entry.conductance]])
        )
        for name, entry in case.contacts.items()
    )


def _check_touching(case: HeatCase, built: model.Model) -> Iterator[Problem]:
    """Yield the problems of bodies that name a contact and lie apart."""
    edges = built.mesh.boundary_faces if case.geometry == "solid" else built.mesh.boundary_edges
    for name, entry in case.contacts.items():
        own, other = (edges[body.owns(edges)] for body in built.bodies if body.name in entry.between)
        if not len(find_touching_faces(built.mesh.points, own, other, 1.0).area):
            fault = f"{entry.between[0]} and {entry.between[1]} do not lie on each other"
            yield Problem(
                f"contacts.{name}.between", fault, "move one of them: straight edges, in space faces, must coincide"
            )


def _build_stage(stage: HeatStage) -> model.Stage:
    return model.Stage(
        name=stage.name,
        duration=stage.duration,
        heat=model.HeatStage(
            temperatures=tuple(entry.to_model() for entry in stage.temperature),
            fluxes=tuple(entry.to_model() for entry in stage.flux),
            convections=tuple(entry.to_model() for entry in stage.convection),
            radiations=tuple(entry.to_model() for entry in stage.radiation),
        ),
    )
