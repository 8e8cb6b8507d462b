# SPDX-License-Identifier: Apache-2.0
"""Bodies of tetrahedra in an explicit run: where they are, why one needs a new mesh, and that mesh."""

from __future__ import annotations

import importlib.util
from collections.abc import Mapping, Sequence
from dataclasses import astuple, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.mesh.checks import MeshError
from presswork.model import FloatArray, Mesh, Model, Remeshing, change_mesh, list_bodies
from presswork.process.explicit.contacts import ContactsOfRun, find_touching
from presswork.process.explicit.forming import ExplicitForming
from presswork.process.explicit.new_meshes import MadeMesh
from presswork.process.explicit.present_bodies import NEAR, PlasticVolumes, find_held, list_nodes
from presswork.process.explicit.solids_in_space import SolidsInSpace
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
from presswork.ranks.world import World
from presswork.remesh.carrier import Carrier, Part
from presswork.remesh.space.body import NewBody, OldBody
from presswork.remesh.space.fill import REMEDY
from presswork.remesh.space.tetrahedra import measure_volumes
from presswork.remesh.space.triggers import find_cut_edge


class MovingTetrahedra:
    """The bodies of a run in space, each of one block of tetrahedra."""

    def __init__(
        self, run: ExplicitForming, domain: SolidsInSpace, settings: Remeshing, world: World | None = None
    ) -> None:
        """world: ranks that share the run; the first of them makes new meshes."""
        self._run, self._domain, self._settings, self._world = run, domain, settings, world
        self._shapes = [draw_shape(tool, run.model, settings) for tool in run.model.space_tools]
        self._left = [Left() for _ in list_bodies(run.model)]
        """What was wrong with the present mesh of each body when it was made."""
        self._topologies = Topologies()
        self._volumes = PlasticVolumes(run, self.find_volumes)

    def find_obstacle(self) -> str:
        """Return what prevents any new mesh; empty if nothing does."""
        model = self._run.model
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

    def find(self, increment: FloatArray) -> list[OldBody]:
        """Return the bodies where they are now; the increment of the last row counts for nothing."""
        run = self._run
        model, position, held = run.model, run.solids.position, find_held(run)
        surfaces = [self._domain.surface_of(t) for t in range(len(run.walls))]
        near = NEAR * self._settings.smallest_size
        on_tool = np.zeros((len(surfaces), len(position)), dtype=bool)
        outer = np.unique(model.mesh.boundary_faces)
        for t, surface in enumerate(surfaces):
            on_tool[t, outer] = np.abs(surface.nearest(position[outer], 2.0 * near)[0]) < near
        tools = [shape.place(surface, surface.pose) for surface, shape in zip(surfaces, self._shapes, strict=True)]
        found = []
        for number, own in enumerate(list_nodes(run)):
            topology, places = self._topologies.find(model, number)
            lost = self._volumes.find_lost(number)
            found.append(
                OldBody(
                    position[own], topology.cells, on_tool[:, own], held[own], places, tools, lost, topology=topology
                )
            )
        if not model.contacts:
            return found
        pushed = find_pushed(model, run.contacts.added)
        return add_neighbours(found, model, [pushed[own] for own in list_nodes(run)])

    def find_reason(self, number: int, old: OldBody, increment: FloatArray, *, is_first: bool) -> str | None:
        """Return why a body needs a new mesh; is_first: it has its first mesh."""
        if is_first:
            return find_cut_edge(old, deepest=LAST_CUT, sharp_counts=True)
        left, own = self._left[number], increment[list_nodes(self._run)[number]]
        reason = find_reason(old, own, self._settings_of(number), 1.0, left=left)
        return reason or find_breach(old, self._run.model.limits, left=left)

    def _settings_of(self, number: int) -> Remeshing:
        """Return the sizes and triggers of a body."""
        return self._settings.of_body(list_bodies(self._run.model)[number].name)

    def note_meshes(self, is_new: Sequence[bool]) -> None:
        """Note what is wrong with the meshes of bodies that have new ones."""
        for number, body in enumerate(self.find(np.zeros(0))):
            if is_new[number]:
                self._left[number] = measure_left(body, self._settings_of(number))

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return what is wrong with the present meshes."""
        return {LEFT: np.array([astuple(left) for left in self._left])}

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what `arrays` gave."""
        self._left = [Left(*left) for left in arrays[LEFT].tolist()]

    def make(self, bodies: set[int], increment: FloatArray, density: FloatArray) -> MadeMesh:
        """Return a mesh on which bodies have new cells; density: factor on that of each. Raises MeshError."""
        old, before = self.find(increment), self._run.model
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
            points = fit_joints(after, *mark_joints(old, made, parts), self._find_depths(after, parts, density))
            lying = replace(lying, points=points)
            if any(measure_volumes(points, block.connectivity.astype(np.intp)).min() <= 0.0 for block in lying.blocks):
                raise MeshError("new skins fitted to each other would turn a cell inside out", "smaller cells")
            mesh = _keep_first_places(before.mesh, lying, parts)
        return MadeMesh(mesh, lying.points, parts, faults=[str(fault) for fault in faults])

    def _find_depths(self, after: Model, parts: Sequence[Part], density: FloatArray) -> list[FloatArray]:
        """Return how deep the nodes of slaves lie in other bodies where these press as before (n_points,) [mm].

        after: the model on the mesh of parts, of each of whose contacts it is.
        """
        run = self._run
        position = run.solids.position
        carrier = Carrier(run.model.mesh, position, after.mesh, parts)
        tractions = carry_tractions((run.model, run.contacts.added, position), after, carrier)
        touching = find_touching(after)
        solids = self._domain.make_solids(after, density, touching)
        solids.safety = run.settings.safety
        contacts, target = ContactsOfRun(after, touching, solids), run.settings.target_step
        step = solids.safety * solids.stable_step()
        if target is not None and step < target:
            solids.scale_mass(target)
            step = target
        return find_depths(after, contacts.added, tractions, step)

    def find_volumes(self) -> list[FloatArray]:
        """Return the volume of each cell of each block (n_cells,) [mm3]."""
        position, blocks = self._run.solids.position, self._run.model.mesh.blocks
        return [measure_volumes(position, block.connectivity.astype(np.intp)) for block in blocks]

    def measure(self) -> list[float]:
        """Return the volume of each body without its elastic part [mm3]."""
        return self._volumes.measure()


def _keep_first_places(before: Mesh, lying: Mesh, parts: Sequence[Part]) -> Mesh:
    """Return a mesh whose points are where those of each body were when its mesh began; lying: where they are now."""
    points = lying.points.copy()
    for part in parts:
        if part.surface is None:
            own = slice(part.new_points.start, part.new_points.stop)
            points[own] = before.points[part.old_points.start : part.old_points.stop]
    return replace(lying, points=points)
