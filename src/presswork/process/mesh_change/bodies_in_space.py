# SPDX-License-Identifier: Apache-2.0
"""Bodies of tetrahedra as new meshes are made from them, and the mesh that their new meshes make together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from presswork.mesh.checks import MeshError
from presswork.model import (
    Body,
    BoolArray,
    CellBlock,
    FloatArray,
    IndexArray,
    IntArray,
    Mesh,
    Model,
    list_bodies,
    list_sets,
)
from presswork.process.mesh_change.new_epoch import make_on_lead
from presswork.ranks.world import World
from presswork.remesh.carrier import Part, SkinPlaces
from presswork.remesh.space.body import FLAT, NewBody, OldBody, Topology
from presswork.remesh.space.remesh import remesh_body
from presswork.remesh.space.size_field import EdgeSizes
from presswork.remesh.space.skins import draw_skin, find_outer, mean_edge
from presswork.remesh.space.tools import PlacedTool

TOUCHES = 0.1
"""Distance from another body's skin within which a node that contact pushes lies on it, over the mean edge of its own
skin."""


def add_neighbours(bodies: Sequence[OldBody], model: Model, is_pushed: Sequence[BoolArray]) -> list[OldBody]:
    """Return bodies that know the skins of those that they may touch, and which of their nodes lie on these.

    is_pushed: of each body the nodes that contact with others pushes (n,).
    """
    found = []
    for number, body in enumerate(bodies):
        others = {
            other: draw_skin(bodies[other].points, find_outer(bodies[other], bodies[other]))
            for other in sorted({i for c in model.contacts if number in c.between for i in c.between} - {number})
        }
        rows = [is_pushed[number] & _lies_on(skin, body.points, body.faces) for skin in others.values()]
        on_tool = np.concatenate([body.on_tool, np.array(rows, dtype=bool).reshape(-1, len(body.points))])
        found.append(replace(body, others=others, on_tool=on_tool))
    return found


def _lies_on(skin: PlacedTool, points: FloatArray, faces: IndexArray) -> BoolArray:
    near = TOUCHES * mean_edge(points, faces)
    gap, _ = skin.touch(points, near)
    return np.asarray(np.abs(gap) < near)


class Topologies:
    """What of bodies stays as long as the mesh does: their cells with their skin, and the faces in places."""

    def __init__(self) -> None:
        self._mesh: Mesh | None = None
        self._known: dict[int, tuple[Topology, dict[str, IndexArray]]] = {}

    def find(self, model: Model, number: int) -> tuple[Topology, dict[str, IndexArray]]:
        """Return that of a body on the model's mesh. Raises MeshError as take_places does."""
        if model.mesh is not self._mesh:
            self._mesh, self._known = model.mesh, {}
        if number not in self._known:
            body = list_bodies(model)[number]
            (block,) = body.blocks
            cells = model.mesh.blocks[block].connectivity.astype(np.intp) - body.points.start
            self._known[number] = Topology(cells), take_places(model, body)
        return self._known[number]


def remesh_beside(
    world: World | None,
    old: Sequence[OldBody],
    made: Sequence[OldBody | NewBody],
    number: int,
    sizes: EdgeSizes,
    *,
    part: float = 1.0,
) -> NewBody:
    """Return a new mesh of a body, which lies on the others as they are by now (made). Raises MeshError.

    world: ranks, the first of which makes it for all; part: of the edges that its sizes ask for.
    """
    others = {i: draw_skin(made[i].points, find_outer(old[i], made[i])) for i in old[number].others}
    return make_on_lead(world, remesh_body, replace(old[number], others=others), sizes, part=part)


def take_places(model: Model, body: Body) -> dict[str, IndexArray]:
    """Return the faces (m, 3) of a body, over its own nodes, in the places that a model names.

    Raises MeshError where one is not made of faces.
    """
    found: dict[str, IndexArray] = {}
    for _, name in list_sets(model):
        nodes, faces = model.mesh.node_sets.get(name), model.mesh.face_sets.get(name)
        if faces is None:
            faces = np.zeros((0, 3), dtype=np.int32)
        loose = np.setdiff1d(nodes, faces) if nodes is not None else np.zeros(0, dtype=np.int32)
        if len(loose):
            where = ", ".join(f"{c:.4g}" for c in model.mesh.points[loose[0]])
            raise MeshError(
                f"the set `{name}` has a node near ({where}) on none of its faces: new meshes keep places that are "
                "made of whole faces of the surface",
                "name a set of faces, or leave out [remesh]",
            )
        found[name] = faces[body.owns(faces)].astype(np.intp) - body.points.start
    return found


def join_bodies(mesh: Mesh, bodies: Sequence[Body], made: Sequence[OldBody | NewBody]) -> tuple[Mesh, list[Part]]:
    """Return the mesh of bodies with the materials that they had, and what becomes of each.

    made: of each its new mesh, or the old one where it stays.
    """
    parts: list[Part] = []
    first = 0
    for body, own in zip(bodies, made, strict=True):
        points = range(first, first + len(own.points))
        surface = None
        seams: tuple[FloatArray, ...] = ()
        if isinstance(own, NewBody):
            surface = SkinPlaces(own.skin + first, own.corners + body.points.start, own.share, own.on_tool[:, own.skin])
            seams = (own.seam,) if len(own.seam) else ()
        parts.append(Part(body.points, points, body.blocks.start, surface, seams))
        first = points.stop
    firsts = [part.new_points.start for part in parts]
    blocks = tuple(
        CellBlock(block.element, _to_int(own.cells + start), block.material)
        for block, own, start in zip(mesh.blocks, made, firsts, strict=True)
    )
    faces = {name: _join([own.sets[name] for own in made], firsts) for name in made[0].sets}
    faces["boundary"] = boundary = _join([own.faces for own in made], firsts)
    nodes = {name: np.unique(own) for name, own in faces.items()}
    nodes["all"] = np.arange(first, dtype=np.int32)
    places = np.concatenate([own.points for own in made])
    no_edges = np.zeros((0, 2), dtype=np.int32)
    return Mesh(places, blocks, nodes, {}, no_edges, face_sets=faces, boundary_faces=boundary), parts


def mark_joints(
    old: Sequence[OldBody], made: Sequence[OldBody | NewBody], parts: Sequence[Part]
) -> tuple[BoolArray, BoolArray]:
    """Return which nodes lie on another body (n_points,), and which coordinates may change to fit bodies (n_points, 3):
    of new meshes, where neither planes nor tools hold them.
    """
    touches, is_free = [], []
    for before, own, part in zip(old, made, parts, strict=True):
        n_tools = len(before.tools)
        touches.append(own.on_tool[n_tools:].any(axis=0))
        free = np.zeros(own.points.shape, dtype=bool)
        if part.surface is not None:
            free[np.unique(own.faces)] = True
            free[own.on_tool[:n_tools].any(axis=0)] = False
            for axis, level, _ in before.planes:
                flat = np.abs(own.points[:, axis] - level) < FLAT * float(np.ptp(before.points, axis=0).max())
                free[flat, axis] = False
        is_free.append(free)
    return np.concatenate(touches), np.concatenate(is_free)


def _join(faces: Sequence[IndexArray], firsts: Sequence[int]) -> IntArray:
    return _to_int(np.concatenate([own + first for own, first in zip(faces, firsts, strict=True)]))


def _to_int(values: IndexArray) -> IntArray:
    return np.ascontiguousarray(values, dtype=np.int32)
