# SPDX-License-Identifier: Apache-2.0
"""Bodies of tetrahedra in an implicit run: where they are, why one needs a new mesh, and that mesh."""

from __future__ import annotations

import importlib.util
from collections.abc import Mapping, Sequence
from dataclasses import astuple, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.bodies.body_surfaces import InterfaceArrays
from presswork.interaction.tool_arrays import SpaceToolArrays
from presswork.mesh.checks import MeshError
from presswork.model import FloatArray, Remeshing, change_mesh, list_bodies
from presswork.process.implicit.increments import IncrementRun
from presswork.process.implicit.lost_volume import LostVolume
from presswork.process.mesh_change.bodies_in_space import (
    Topologies,
    add_neighbours,
    join_bodies,
    mark_joints,
    remesh_beside,
)
from presswork.process.mesh_change.carrying import carry_to_mesh, find_undeclared
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
from presswork.remesh.carrier import Carrier
from presswork.remesh.space.body import NewBody, OldBody
from presswork.remesh.space.fill import REMEDY
from presswork.remesh.space.tools import PlacedTool
from presswork.remesh.space.triggers import find_cut_edge, find_flat_cell

PARTS = (1.0, 0.9, 0.8)
"""Factors on the requested size, in meshes tried one after the other; the last mesh has twice as many cells."""


class BodiesInSpace:
    """The bodies of a run in space, each of one block of tetrahedra."""

    parts: Sequence[float] = PARTS
    waits_first = True

    def __init__(self, run: IncrementRun, settings: Remeshing) -> None:
        self._run, self._settings = run, settings
        self._lost = LostVolume(run)
        self._shapes = [draw_shape(tool, run.model, settings) for tool in run.model.space_tools]
        self._topologies = Topologies()
        self._left = [Left() for _ in list_bodies(run.model)]
        """What was wrong with the present mesh of each body when it was made."""

    def find_obstacle(self) -> str:
        """Return what prevents any new mesh; empty if nothing does."""
        undeclared = find_undeclared(self._run.procedure.state)
        if undeclared:
            return f"no rule carries {', '.join(undeclared)} to a new mesh"
        if importlib.util.find_spec("mmgpy") is None:
            return f"new meshes in space need mmgpy, which is not installed: {REMEDY}"
        if any(len(body.blocks) > 1 for body in list_bodies(self._run.model)):
            return "cells of several materials in one body cannot be meshed anew together"
        try:
            self.find()
        except MeshError as error:
            return str(error)
        return ""

    def find(self) -> list[OldBody]:
        """Return the bodies where they are now."""
        run = self._run
        procedure, model, state = run.procedure, run.model, run.procedure.state
        fixed = np.asarray(procedure.interactions.supports.fixed(procedure.present_step().stage))[:, :3]
        on_tool = np.zeros((0, len(model.mesh.points)), dtype=bool)
        tools: list[PlacedTool] = []
        space_tools = procedure.interactions.space_tools
        if space_tools is not None:
            placed = state[SpaceToolArrays]
            on_tool = np.linalg.norm(placed.force, axis=2) > 0.0
            for t, shape in enumerate(self._shapes):
                surface = space_tools.contact.placed(t, placed)
                tools.append(shape.place(surface, surface.pose))
        position, found = model.mesh.points + state.nodes.moved, []
        for number, body in enumerate(list_bodies(model)):
            own = slice(body.points.start, body.points.stop)
            topology, places = self._topologies.find(model, number)
            lost, cells = self._lost.find(number), topology.cells
            found.append(
                OldBody(position[own], cells, on_tool[:, own], fixed[own], places, tools, lost, topology=topology)
            )
        if InterfaceArrays not in state:
            return found
        pushed = np.asarray((state[InterfaceArrays].force != 0.0).any(axis=1))
        return add_neighbours(found, model, [pushed[list(body.points)] for body in list_bodies(model)])

    def find_reason(self, number: int, old: OldBody, wait: float, *, is_first: bool) -> str | None:
        """Return why a body needs a new mesh. wait: factor on the triggers; is_first: it has its first mesh."""
        model, left, moves = self._run.model, self._left[number], self._last_moves(number)
        settings, own = self._settings_of(number), list_bodies(model)[number].points
        breach = find_breach(old, model.limits, left=left, start=model.mesh.points[own.start : own.stop])
        if is_first:
            flat = find_flat_cell(old, moves, settings.quality)
            return flat or find_cut_edge(old, deepest=LAST_CUT, sharp_counts=True) or breach
        return find_reason(old, moves, settings, wait, left=left) or breach

    def note_meshes(self, bodies: set[int] | None, *, is_new: bool, is_refused: bool) -> None:
        """Note what is wrong with the meshes of bodies (None: of all), which are new, or which stay for good."""
        for number, body in enumerate(self.find()):
            if bodies and number not in bodies:
                continue
            settings, moves = self._settings_of(number), self._last_moves(number)
            if is_new:
                self._left[number] = measure_left(body, settings)
            elif is_refused:  # none can be made: asked for again once this one has become worse
                self._left[number] = self._left[number].worsen(measure_left(body, settings, moves))

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return what is wrong with the present meshes."""
        return {LEFT: np.array([astuple(left) for left in self._left])}

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what `arrays` gave."""
        self._left = [Left(*left) for left in arrays[LEFT].tolist()]

    def _settings_of(self, number: int) -> Remeshing:
        """Return the sizes and triggers of a body."""
        bodies = self._run.model.bodies
        return self._settings.of_body(bodies[number].name) if bodies else self._settings

    def _last_moves(self, number: int) -> FloatArray:
        points = list_bodies(self._run.model)[number].points
        return self._run.procedure.state.nodes.increment[points.start : points.stop, :3]

    def make(self, old: Sequence[OldBody], own: set[int], part: float) -> tuple[ImplicitProcedure, Carrier]:
        """Return the procedure on new meshes of bodies, with the state carried to them. Raises MeshError."""
        before = self._run.procedure
        made: list[OldBody | NewBody] = list(old)
        for number in sorted(own):  # each beside the others as they are by then
            made[number] = remesh_beside(
                before.world, old, made, number, list_sizes(self._settings_of(number)), part=part
            )
        mesh, parts = join_bodies(before.model.mesh, list_bodies(before.model), made)
        if any(body.others for body in old):
            mesh = replace(mesh, points=fit_joints(change_mesh(before.model, mesh), *mark_joints(old, made, parts)))
        carrier = Carrier(before.model.mesh, np.concatenate([body.points for body in old]), mesh, parts)
        return carry_to_mesh(before, mesh, carrier), carrier
