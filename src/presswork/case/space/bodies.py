# SPDX-License-Identifier: Apache-2.0
"""The bodies of a case in space: one mesh of all, and how they touch each other."""

from __future__ import annotations

import math

import numpy as np

from presswork import model
from presswork.case.errors import Problem
from presswork.case.plane.bodies import OVERLAP, WORKPIECE, check_contacts, make_contacts
from presswork.case.space.explicit_checks import choose_element
from presswork.case.space.mesh_builder import check_space_mesh, mesh_space_body
from presswork.case.space.schema import SpaceCase, SpaceWorkpiece
from presswork.geometry.tool_surface import make_surface
from presswork.mesh.faces import split_faces
from presswork.mesh.joined import join_meshes
from presswork.model import ELEMENTS, FloatArray


def list_space_bodies(case: SpaceCase) -> dict[str, tuple[str, SpaceWorkpiece]]:
    """Return every body of the case by its name, the workpiece first, with the key that describes it."""
    others = {name: (f"bodies.{name}", body) for name, body in case.bodies.items()}
    return {WORKPIECE: ("workpiece", case.workpiece), **others}


def check_space_bodies(case: SpaceCase) -> list[Problem]:
    """Return the problems of bodies and contacts that show without their meshes."""
    bodies, problems = list_space_bodies(case), []
    for key, body in bodies.values():
        element = choose_element(case, body)
        problems += check_space_mesh(f"{key}.mesh", body.mesh, element)
        if ELEMENTS[element].cell != ELEMENTS[choose_element(case)].cell:
            fault = (
                f"hexahedra and tetrahedra do not go together in one case: the workpiece has {case.workpiece.element}"
            )
            problems.append(Problem(f"{key}.element", fault, "take cells of one kind for all bodies", body.element))
    if (case.bodies or case.contacts) and model.cell_of(choose_element(case)).is_quadratic:
        fault = "bodies of tetrahedra of 10 nodes cannot touch each other"
        problems.append(Problem("workpiece.element", fault, "take tet4_mini", choose_element(case)))
    return problems + check_contacts(case.bodies, case.contacts, case.tools, rings=False)


def build_space_bodies(case: SpaceCase) -> tuple[model.Mesh, tuple[model.Body, ...]]:
    """Mesh all bodies into one mesh; raises CaseError for a mesh file that cannot be read.

    A case of one body that does not touch itself has no list of bodies.
    """
    materials = list(case.materials)
    meshes = {
        name: mesh_space_body(key, body.mesh, choose_element(case, body), materials.index(body.material), case.source)
        for name, (key, body) in list_space_bodies(case).items()
    }
    if not case.bodies and not case.contacts:
        return meshes[WORKPIECE], ()
    return join_meshes(meshes)


def build_space_contacts(
    case: SpaceCase, mesh: model.Mesh, bodies: tuple[model.Body, ...], materials: tuple[model.Material, ...]
) -> tuple[tuple[model.BodyContact, ...], list[Problem]]:
    """Return the contacts between bodies, and the problems of bodies that overlap or can never meet."""
    contacts, problems = make_contacts(case.contacts, mesh, bodies, materials), []
    for contact in contacts:
        first, second = contact.between
        if first != second:
            problems += _check_apart(case, contact.name, mesh, bodies[first], bodies[second])
    return contacts, problems


def _check_apart(case: SpaceCase, name: str, mesh: model.Mesh, first: model.Body, second: model.Body) -> list[Problem]:
    """Return the problem of two bodies that overlap, or are too far from each other ever to meet."""
    key, both = f"contacts.{name}.between", f"{first.name} and {second.name}"
    tolerance = OVERLAP * min(model.mean_edge(mesh, body) for body in (first, second))
    nearest = math.inf
    for own, other in ((first, second), (second, first)):
        nodes = np.unique(mesh.boundary_faces[own.owns(mesh.boundary_faces)])
        distance = measure_distance_in_space(mesh, mesh.points[nodes], other)
        deepest = int(np.argmin(distance))
        nearest = min(nearest, float(distance.min()))
        if distance[deepest] < -tolerance:
            at = ", ".join(f"{value:.6g}" for value in mesh.points[nodes[deepest]])
            fault = f"{both} overlap at the start, by {-distance[deepest]:.6g} mm at ({at})"
            return [Problem(key, fault, "move one of them: they may touch, no more")]
    reach = _measure_travel(case) + float(np.ptp(mesh.points[list(first.points)], axis=0).max())
    if nearest > reach and not any(stage.force or stage.face_force for stage in case.stages):
        fault = f"{both} are {nearest:.6g} mm apart, farther than anything moves in this case"
        return [Problem(key, fault, "bring them together, or leave the contact out")]
    return []


def _measure_travel(case: SpaceCase) -> float:
    """Return the sum of all motions of the case [mm]."""
    tools = [motion.build().move for stage in case.stages for motion in stage.tools.values()]
    nodes = [abs(entry.value) for stage in case.stages for entry in stage.displacement]
    return float(sum(np.linalg.norm(move) for move in tools) + sum(nodes))


def measure_distance_in_space(mesh: model.Mesh, points: FloatArray, body: model.Body) -> FloatArray:
    """Return the distance of points (n, 3) from the surface of a body [mm], negative inside."""
    faces = mesh.boundary_faces[body.owns(mesh.boundary_faces)]
    used, triangles = np.unique(split_faces(faces), return_inverse=True)
    shape = model.Triangulation(
        np.ascontiguousarray(mesh.points[used]), triangles.reshape(-1, 3).astype(np.int32), is_closed=True
    )
    gap, _, _, _ = make_surface(shape).nearest(np.ascontiguousarray(points), math.inf)
    return np.asarray(gap)
