# SPDX-License-Identifier: Apache-2.0
"""Explicit bodies of tetrahedra in space whose meshes change in the run: what differs from the plane."""

from __future__ import annotations

import importlib.util
from collections.abc import Mapping, Sequence
from dataclasses import astuple, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.explicit.dynamics import SAFETY
from presswork.mesh.checks import MeshError
from presswork.model import FloatArray, Mesh, Model, Remeshing, change_mesh, list_bodies
from presswork.outcome import StartError
from presswork.process.explicit.contacts_of_rows import ContactsOfRows, find_touching
from presswork.process.explicit.remeshed_impact import NEAR, MadeMesh, RemeshedImpact
from presswork.process.explicit.space_impact import ExplicitSpaceImpact
from presswork.process.mesh_change.bodies_in_space import (
    Topologies,
    add_neighbours,
    join_bodies,
    mark_joints,
    remesh_beside,
    take_places,
)
from presswork.process.mesh_change.contacts_on_new_mesh import carry_tractions, find_depths, find_pushed
from presswork.process.mesh_change.joints import fit_joints
from presswork.process.mesh_change.mesh_reasons import LAST_CUT
from presswork.process.mesh_change.reasons_in_space import (
    LEFT,
    Left,
    draw_shape,
    find_breach,
    find_reason,
    list_sizes,
    measure_left,
)
from presswork.process.model_recording import NamedArrays
from presswork.ranks.world import World
from presswork.remesh.carrier import Carrier, Part
from presswork.remesh.space.body import NewBody, OldBody
from presswork.remesh.space.fill import REMEDY
from presswork.remesh.space.tetrahedra import measure_volumes
from presswork.remesh.space.triggers import find_cut_edge


class RemeshedSpaceImpact(RemeshedImpact, ExplicitSpaceImpact):
    """Bodies of tetrahedra in explicit dynamics, each meshed anew where its mesh would fail."""

    def __init__(self, model: Model, *, threads: int = 0, world: World | None = None) -> None:
        assert model.remeshing is not None
        self._obstacle = _find_obstacle(model)
        if self._obstacle and not model.remeshing.keeps_first:
            raise StartError(f"{self._obstacle}: leave out [remesh]")
        self._shapes = [draw_shape(tool, model, model.remeshing) for tool in model.space_tools]
        self._left = [Left() for _ in list_bodies(model)]
        """What was wrong with the present mesh of each body when it was made."""
        self._topologies = Topologies()
        super().__init__(model, threads=threads, world=world)

    def begin_log(self) -> str:
        """Name the procedure and what it starts with."""
        return super().begin_log() + (f"; no new meshes: {self._obstacle}" if self._obstacle else "")

    def _find_reason(self, row: int) -> tuple[str, set[int]] | None:
        if self._obstacle:
            return None
        self._present = self._find_bodies()
        return super()._find_reason(row)

    def _find_reason_of(self, number: int) -> str | None:
        body, left, settings = self._present[number], self._left[number], self._settings_of(number)
        if number in self._on_first:
            return find_cut_edge(body, deepest=LAST_CUT, sharp_counts=True)
        increment = self._increment[self._list_nodes()[number]]
        return find_reason(body, increment, settings, 1.0, left=left) or find_breach(body, self.model.limits, left=left)

    def _settings_of(self, number: int) -> Remeshing:
        """Return the sizes and triggers of a body."""
        return self._remeshing.of_body(list_bodies(self.model)[number].name)

    def _find_bodies(self) -> list[OldBody]:
        """Return the bodies where they are now."""
        model, position, held = self.model, self.solids.position, self._find_held()
        surfaces = [self._surface_of(t) for t in range(len(self.walls))]
        near = NEAR * self._remeshing.smallest_size
        on_tool = np.zeros((len(surfaces), len(position)), dtype=bool)
        outer = np.unique(model.mesh.boundary_faces)
        for t, surface in enumerate(surfaces):
            on_tool[t, outer] = np.abs(surface.nearest(position[outer], 2.0 * near)[0]) < near
        tools = [shape.place(surface, surface.pose) for surface, shape in zip(surfaces, self._shapes, strict=True)]
        found = []
        for number, own in enumerate(self._list_nodes()):
            topology, places = self._topologies.find(model, number)
            lost = self._find_loss(number)
            found.append(
                OldBody(
                    position[own], topology.cells, on_tool[:, own], held[own], places, tools, lost, topology=topology
                )
            )
        if not model.contacts:
            return found
        pushed = find_pushed(model, self.contacts.added)
        return add_neighbours(found, model, [pushed[own] for own in self._list_nodes()])

    def _remesh(self, reason: str, bodies: set[int] | None = None, *, failed: bool = False) -> bool:
        blocks = self.model.mesh.blocks
        is_new = not self._obstacle and super()._remesh(reason, bodies, failed=failed)
        if is_new:
            for number, body in enumerate(self._find_bodies()):
                if self.model.mesh.blocks[number] is not blocks[number]:
                    self._left[number] = measure_left(body, self._settings_of(number))
        return is_new

    def _epoch_arrays(self) -> NamedArrays:
        return super()._epoch_arrays() | {LEFT: np.array([astuple(left) for left in self._left])}

    def _load_epoch(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        super()._load_epoch(epoch)
        self._left = [Left(*left) for left in epoch[LEFT].tolist()]

    def _make_mesh(self, bodies: set[int]) -> MadeMesh:
        old, before = self._find_bodies(), self.model
        made: list[OldBody | NewBody] = list(old)
        faults: list[MeshError] = []
        for number in sorted(bodies):  # each beside the others as they are by then
            try:
                made[number] = remesh_beside(self._world, old, made, number, list_sizes(self._settings_of(number)))
            except MeshError as error:
                faults.append(error)
        if len(faults) == len(bodies):
            raise faults[0]
        lying, parts = join_bodies(before.mesh, list_bodies(before), made)
        mesh = _keep_first_places(before.mesh, lying, parts)
        if any(body.others for body in old):
            after = replace(change_mesh(before, mesh), mesh=lying)
            points = fit_joints(after, *mark_joints(old, made, parts), self._find_depths(after, parts))
            lying = replace(lying, points=points)
            if any(measure_volumes(points, block.connectivity.astype(np.intp)).min() <= 0.0 for block in lying.blocks):
                raise MeshError("new skins fitted to each other would turn a cell inside out", "smaller cells")
            mesh = _keep_first_places(before.mesh, lying, parts)
        return MadeMesh(mesh, lying.points, parts, faults=[str(fault) for fault in faults])

    def _find_depths(self, after: Model, parts: Sequence[Part]) -> list[FloatArray]:
        """Return how deep the nodes of slaves lie in other bodies where these press as before (n_points,) [mm].

        after: the model on the mesh of parts, of each of whose contacts it is.
        """
        position = self.solids.position
        carrier = Carrier(self.model.mesh, position, after.mesh, parts)
        tractions = carry_tractions((self.model, self.contacts.added, position), after, carrier)
        touching = find_touching(after)
        run = self._make_solids(after, self._density, touching)
        contacts, target = ContactsOfRows(after, touching, run), self.settings.target_step
        step = SAFETY * run.stable_step()
        if target is not None and step < target:
            run.scale_mass(target)
            step = target
        return find_depths(after, contacts.added, tractions, step)

    def _find_volumes(self) -> list[FloatArray]:
        position = self.solids.position
        return [measure_volumes(position, block.connectivity.astype(np.intp)) for block in self.model.mesh.blocks]


def _keep_first_places(before: Mesh, lying: Mesh, parts: Sequence[Part]) -> Mesh:
    """Return a mesh whose points are where those of each body were when its mesh began; lying: where they are now."""
    points = lying.points.copy()
    for part in parts:
        if part.surface is None:
            own = slice(part.new_points.start, part.new_points.stop)
            points[own] = before.points[part.old_points.start : part.old_points.stop]
    return replace(lying, points=points)


def _find_obstacle(model: Model) -> str:
    """Return why no new meshes can be made; empty: they can."""
    if importlib.util.find_spec("mmgpy") is None:
        return f"new meshes in space need mmgpy, which is not installed: {REMEDY}"
    bodies = list_bodies(model)
    if any(len(body.blocks) > 1 for body in bodies):
        return "cells of several materials in one body cannot be meshed anew together"
    try:
        for body in bodies:
            take_places(model, body)
    except MeshError as error:
        return str(error)
    return ""
