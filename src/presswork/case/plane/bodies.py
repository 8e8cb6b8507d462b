# SPDX-License-Identifier: Apache-2.0
"""The Model's bodies from a case's: meshes, and how the bodies touch each other."""

from __future__ import annotations

import logging
from collections.abc import Collection, Container, Mapping
from pathlib import Path

import numpy as np

from presswork import model
from presswork.case.errors import CaseError, Problem, suggest
from presswork.case.plane import schema
from presswork.case.plane.contact import Contact
from presswork.case.plane.grid import grid_lines
from presswork.case.plane.workpiece import MeshFile, Rectangle, Workpiece
from presswork.case.units import LENGTH, unit_factor
from presswork.mesh import MeshError, mesh_rectangle, read_mesh
from presswork.mesh.joined import join_meshes

logger = logging.getLogger(__name__)

WORKPIECE = "workpiece"
OVERLAP = 0.01
"""Depth of a node in another body at the start over the mean boundary edge: as much lies between arcs of chords. The
node is pushed out in the first increment."""


def list_bodies(case: schema.Case) -> dict[str, tuple[str, Workpiece]]:
    """Return every body of the case by its name, the workpiece first, with the key that describes it."""
    others = {name: (f"bodies.{name}", body) for name, body in case.bodies.items()}
    return {WORKPIECE: ("workpiece", case.workpiece), **others}


def build_bodies(case: schema.Case) -> tuple[model.Mesh, tuple[model.Body, ...]]:
    """Mesh all bodies into one mesh; raises CaseError for a mesh file that cannot be read."""
    materials = list(case.materials)
    return join_meshes(
        {
            name: mesh_body(key, body.mesh, body.element, materials.index(body.material), case.source)
            for name, (key, body) in list_bodies(case).items()
        }
    )


def mesh_body(
    key: str, mesh: Rectangle | MeshFile, element: model.SolidElement, material: int, source: Path | None
) -> model.Mesh:
    """Mesh a body in the plane, or read its mesh; raises CaseError for a file that cannot be read.

    key: under which the case describes the body. material: its index. source: the case file, to which paths are
    relative.
    """
    if isinstance(mesh, Rectangle):
        x_lines, y_lines = grid_lines(mesh)
        return mesh_rectangle(x_lines, y_lines, element=element, pattern=mesh.pattern, material=material)
    folder = source.parent if source is not None else Path()
    scale = unit_factor(mesh.unit, LENGTH)
    try:
        found, notes = read_mesh(folder / mesh.path, element=element, scale=scale, material=material)
    except MeshError as error:
        raise CaseError([Problem(f"{key}.mesh.path", error.fault, error.remedy, mesh.path)], source) from error
    for note in notes:
        logger.warning("%s.mesh.path = %s: %s", key, mesh.path, note)
    return found


def check_bodies(case: schema.Case) -> list[Problem]:
    """Return the problems of bodies and contacts that show without their meshes."""
    bodies = list_bodies(case)
    problems = []
    quadratic = {name: model.cell_of(body.element).is_quadratic for name, (_, body) in bodies.items()}
    for name, (key, body) in bodies.items():
        if quadratic[name] != quadratic[WORKPIECE]:
            problems.append(
                Problem(
                    f"{key}.element",
                    f"linear and quadratic elements do not go together in one case: the workpiece has "
                    f"{case.workpiece.element}",
                    "take elements with as many nodes an edge for all bodies",
                    body.element,
                )
            )
    return problems + check_contacts(case.bodies, case.contacts, case.tools, rings=case.analysis == "axisymmetric")


def check_contacts(
    others: Collection[str], contacts: Mapping[str, Contact], tools: Container[str], *, rings: bool
) -> list[Problem]:
    """Return the problems of the names of bodies and contacts.

    others: the bodies beside the workpiece; rings: whether the analysis is axisymmetric.
    """
    bodies, problems = {WORKPIECE, *others}, []
    for name in others:
        if name == WORKPIECE or "." in name or name in tools:
            reason = "has a dot in it" if "." in name else "is taken already"
            problems.append(Problem(f"bodies.{name}", f"this name {reason}", "give the body another"))
    pairs: dict[frozenset[str], str] = {}
    for name, contact in contacts.items():
        key = f"contacts.{name}.between"
        unknown = [body for body in contact.between if body not in bodies]
        problems += [Problem(key, f"no such body: {body}", suggest(body, bodies, "bodies")) for body in unknown]
        if name in tools:
            problems.append(Problem(f"contacts.{name}", "a tool has this name", "give the contact another"))
        if contact.joint and (not rings or len(set(contact.between)) < 2):
            fault = "a joint is measured between two bodies in axisymmetry"
            problems.append(Problem(f"contacts.{name}.joint", fault, "leave it out", contact.joint))
        earlier = pairs.setdefault(frozenset(contact.between), name)
        if earlier != name:
            fault = f"the contact {earlier} is between the same bodies"
            problems.append(Problem(key, fault, "leave one of them out", list(contact.between)))
    touched = {body for contact in contacts.values() for body in contact.between}
    for name in others:
        if name not in touched:
            remedy = f'add [contacts.NAME] with between = ["workpiece", "{name}"], or leave the body out'
            problems.append(Problem(f"bodies.{name}", "no contact names this body: it would touch nothing", remedy))
    return problems


def build_contacts(
    case: schema.Case, mesh: model.Mesh, bodies: tuple[model.Body, ...], materials: tuple[model.Material, ...]
) -> tuple[tuple[model.BodyContact, ...], list[Problem]]:
    """Return the contacts between bodies, and the problems of bodies that overlap or can never meet."""
    contacts = make_contacts(case.contacts, mesh, bodies, materials)
    problems = []
    for contact in contacts:
        first, second = contact.between
        if first != second:
            problems += _check_apart(case, contact.name, mesh, bodies[first], bodies[second])
        for body in (bodies[i] for i in contact.between if contact.joint):
            radii = mesh.points[list(body.points), 0]
            if radii.min() > 1e-6 * radii.max():
                fault = f"{body.name} begins at a radius of {radii.min():.4g} mm, and a joint's bottom is on the axis"
                problems.append(Problem(f"contacts.{contact.name}.joint", fault, "leave it out", True))
    return contacts, problems


def make_contacts(
    contacts: Mapping[str, Contact],
    mesh: model.Mesh,
    bodies: tuple[model.Body, ...],
    materials: tuple[model.Material, ...],
) -> tuple[model.BodyContact, ...]:
    """Return the Model's contacts, each with its slave."""
    number, made = {body.name: i for i, body in enumerate(bodies)}, []
    for name, contact in contacts.items():
        first, second = (number[body] for body in contact.between)
        young = [materials[mesh.blocks[bodies[i].blocks.start].material].young for i in (first, second)]
        slave = number[contact.slave] if contact.slave else model.choose_slave(mesh, bodies, young, first, second)
        made.append(
            model.BodyContact(
                name, (first, second), slave, contact.contact, m=contact.m, mu=contact.mu,
                keeps_slave=contact.slave is not None, joint=contact.joint,
            )
        )  # fmt: skip
    return tuple(made)


def _check_apart(
    case: schema.Case, name: str, mesh: model.Mesh, first: model.Body, second: model.Body
) -> list[Problem]:
    """Return the problem of two bodies that overlap, or are too far from each other ever to meet."""
    key = f"contacts.{name}.between"
    edges = [mesh.boundary_edges[body.owns(mesh.boundary_edges)] for body in (first, second)]
    tolerance = OVERLAP * min(model.mean_edge(mesh, body) for body in (first, second))
    nearest = np.inf
    for own, other in ((edges[0], edges[1]), (edges[1], edges[0])):
        nodes = np.unique(own[:, :2])
        distance = measure_distance_to_body(mesh.points, nodes, other)
        deepest = int(np.argmin(distance))
        nearest = min(nearest, float(distance.min()))
        if distance[deepest] < -tolerance:
            x, y = mesh.points[nodes[deepest]]
            fault = f"{first.name} and {second.name} overlap at the start, by {-distance[deepest]:.6g} mm"
            return [Problem(key, f"{fault} at ({x:.6g}, {y:.6g})", "move one of them: they may touch, no more")]
    reach = _measure_travel(case) + float(np.ptp(mesh.points[list(first.points)], axis=0).max())
    if nearest > reach and not any(stage.force for stage in case.stages):
        fault = f"{first.name} and {second.name} are {nearest:.6g} mm apart, farther than anything moves in this case"
        return [Problem(key, fault, "bring them together, or leave the contact out")]
    return []


def _measure_travel(case: schema.Case) -> float:
    """Return the sum of all motions of the case [mm]."""
    tools = [motion.build().move[:2] for stage in case.stages for motion in stage.tools.values()]
    nodes = [abs(entry.value) for stage in case.stages for entry in stage.displacement]
    return float(sum(np.linalg.norm(move) for move in tools) + sum(nodes))


def measure_distance_to_body(
    points: model.FloatArray, nodes: model.IntArray, edges: model.IntArray
) -> model.FloatArray:
    """Return the distance of nodes from a closed boundary [mm], negative inside; edges have the body on the left."""
    a, b = points[edges[:, 0]], points[edges[:, 1]]
    along = b - a
    result = np.empty(len(nodes))
    for i, x in enumerate(points[nodes]):
        part = np.clip(((x - a) * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
        distance = np.linalg.norm(x - a - part[:, None] * along, axis=1)
        # inside when a ray to the right crosses the boundary an odd number of times
        above = (a[:, 1] > x[1]) != (b[:, 1] > x[1])
        crossing = a[above, 0] + (x[1] - a[above, 1]) / along[above, 1] * along[above, 0]
        inside = int((crossing > x[0]).sum()) % 2 == 1
        result[i] = -distance.min() if inside else distance.min()
    return result
