# SPDX-License-Identifier: Apache-2.0
"""The same problem on another mesh: a model names places by sets of the mesh, and bodies by their blocks of cells."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from presswork.model.contact import Body, BodyContact
from presswork.model.mesh import Mesh
from presswork.model.model import Model

SAME_SIZE = 0.9
"""Mean edges that differ by less than this ratio count as equally fine: then the softer body is the slave."""


def change_mesh(model: Model, mesh: Mesh) -> Model:
    """Return the model with another mesh, and the points that its bodies have there.

    A body keeps its blocks of cells. Raises ValueError where the mesh lacks a set that the model names, or where the
    points of a body are not a run of their own.
    """
    for kind, name in list_sets(model):
        if name not in getattr(mesh, f"{kind}_sets"):
            raise ValueError(f"the new mesh has no {kind} set {name!r}, which the model names")
    bodies = _follow_bodies(model.bodies, mesh)
    contacts = tuple(_choose_anew(model, contact, mesh, bodies) for contact in model.contacts)
    return replace(model, mesh=mesh, bodies=bodies, contacts=contacts)


def choose_slave(mesh: Mesh, bodies: Sequence[Body], young: Sequence[float], first: int, second: int) -> int:
    """Return the body with the finer boundary, or the softer one of two that are alike, or the first.

    young: Young's modulus of the first and of the second [MPa].
    """
    sizes = [mean_edge(mesh, bodies[i]) for i in (first, second)]
    if min(sizes) < SAME_SIZE * max(sizes):
        return (first, second)[int(np.argmin(sizes))]
    return second if young[1] < young[0] else first


def mean_edge(mesh: Mesh, body: Body) -> float:
    """Return the mean length of the edges of a body's boundary, in space of the sides of its faces [mm]."""
    if mesh.points.shape[1] == 3:
        faces = mesh.boundary_faces[body.owns(mesh.boundary_faces)]
        return float(np.linalg.norm(mesh.points[np.roll(faces, -1, axis=1)] - mesh.points[faces], axis=2).mean())
    edges = mesh.boundary_edges[body.owns(mesh.boundary_edges)]
    return float(np.linalg.norm(mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]], axis=1).mean())


def _choose_anew(model: Model, contact: BodyContact, mesh: Mesh, bodies: tuple[Body, ...]) -> BodyContact:
    """Return a contact with the slave that fits a mesh, where the case does not name it."""
    if contact.keeps_slave:
        return contact
    young = [model.materials[mesh.blocks[bodies[i].blocks.start].material].young for i in contact.between]
    return replace(contact, slave=choose_slave(mesh, bodies, young, *contact.between))


def list_bodies(model: Model) -> tuple[Body, ...]:
    """Return the bodies of a model; of one that names none, the whole mesh."""
    mesh = model.mesh
    return model.bodies or (Body("workpiece", range(len(mesh.points)), range(len(mesh.blocks))),)


def list_sets(model: Model) -> Iterator[tuple[str, str]]:
    """Yield kind (node, edge, face) and name of every set of the mesh that a model names."""
    yield from (("node", support.node_set) for support in model.supports)
    yield from (("node", name) for name in ((model.cyclic.first, model.cyclic.last) if model.cyclic else ()))
    for stage in model.stages:
        yield from (("node", moved.node_set) for moved in stage.prescribed)
        yield from (("node", force.node_set) for force in stage.forces)
        yield from (("node", pressure.node_set) for pressure in stage.shell_pressures)
        yield from (("edge", pressure.edge_set) for pressure in stage.pressures)
        yield from (("edge", force.edge_set) for force in stage.edge_forces)
        yield from (("face", pressure.face_set) for pressure in stage.face_pressures)
        yield from (("face", force.face_set) for force in stage.face_forces)


def _follow_bodies(bodies: tuple[Body, ...], mesh: Mesh) -> tuple[Body, ...]:
    """Return the bodies with the points that their blocks have in a mesh."""
    if bodies and len(mesh.blocks) != bodies[-1].blocks.stop:
        raise ValueError(f"the new mesh has {len(mesh.blocks)} blocks of cells, the bodies {bodies[-1].blocks.stop}")
    followed: list[Body] = []
    for body in bodies:
        used = np.concatenate([mesh.blocks[block].connectivity.ravel() for block in body.blocks])
        first = followed[-1].points.stop if followed else 0
        if used.min() < first:
            raise ValueError(f"points of the body {body.name!r} lie among those of another in the new mesh")
        followed.append(Body(body.name, range(first, int(used.max()) + 1), body.blocks))
    return tuple(followed)
