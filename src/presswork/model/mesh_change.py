# SPDX-License-Identifier: Apache-2.0
"""The same problem on another mesh: a model names places by sets of the mesh, and bodies by their blocks of cells."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from presswork.model.contact import Body
from presswork.model.mesh import Mesh
from presswork.model.model import Model


def change_mesh(model: Model, mesh: Mesh) -> Model:
    """Return the model with another mesh, and the points that its bodies have there.

    A body keeps its blocks of cells. Raises ValueError where the mesh lacks a set that the model names, or where the
    points of a body are not a run of their own.
    """
    for kind, name in list_sets(model):
        if name not in getattr(mesh, f"{kind}_sets"):
            raise ValueError(f"the new mesh has no {kind} set {name!r}, which the model names")
    return replace(model, mesh=mesh, bodies=_follow_bodies(model.bodies, mesh))


def list_sets(model: Model) -> Iterator[tuple[str, str]]:
    """Yield kind (node, edge, face) and name of every set of the mesh that a model names."""
    yield from (("node", support.node_set) for support in model.supports)
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
