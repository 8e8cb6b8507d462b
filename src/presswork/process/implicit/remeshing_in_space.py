# SPDX-License-Identifier: Apache-2.0
"""Bodies of tetrahedra whose mesh changes in the run: when, and how the state goes along."""

from __future__ import annotations

import importlib.util
from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.geometry.mirrored import WITHIN, complete_tool, find_mirrors
from presswork.geometry.tool_widths import find_widths
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.bodies.body_surfaces import InterfaceArrays
from presswork.interaction.tool_arrays import SpaceToolArrays
from presswork.mesh.checks import MeshError
from presswork.model import FloatArray, Limits, Model, Remeshing, Tool, Triangulation, change_mesh
from presswork.process.epochs import NamedArrays
from presswork.process.implicit.remeshing import RemeshedForming
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
from presswork.process.space_surfaces import draw_tool
from presswork.ranks.world import World
from presswork.remesh.carrier import Carrier
from presswork.remesh.space.body import NewBody, OldBody
from presswork.remesh.space.fill import REMEDY
from presswork.remesh.space.notches import SHARP, measure_notch
from presswork.remesh.space.size_field import OF_WIDTH, EdgeSizes
from presswork.remesh.space.tetrahedra import measure_quality
from presswork.remesh.space.tools import PlacedTool, ToolShape, find_bends
from presswork.remesh.space.triggers import (
    TOO_DEEP,
    TOO_LONG,
    WORSE,
    find_cut_edge,
    find_cut_face,
    find_flat_cell,
    find_long_edge,
    find_notch,
    find_stretched_cut,
    measure_cut,
    measure_cut_face,
    measure_edge,
)

PARTS = (1.0, 0.9, 0.8)
"""Of the size that is asked for, in meshes tried one after the other: the last has twice as many cells."""
BEFORE_LIMIT, AT_LIMIT = 0.6, 0.8
"""Of limits.penetration, beyond which a mesh gives way at once; where the last one has left as much, up to AT_LIMIT."""
LEFT = "left"
"""Name in a checkpoint."""
CHORD = 0.05
"""Of the smallest edge of cells, by which the triangles that stand for a tool may leave it."""


class RemeshedSpaceForming(RemeshedForming):
    """An implicit procedure at work on a body of tetrahedra, meshed anew where its mesh would fail."""

    parts = PARTS
    waits_first = True

    def __init__(self, model: Model, *, threads: int = 0, world: World | None = None) -> None:
        assert model.remeshing is not None
        self._shapes = [draw_shape(tool, model, model.remeshing) for tool in model.space_tools]
        self._topologies = Topologies()
        super().__init__(model, threads=threads, world=world)
        self._left = [Left() for _ in self._bodies()]
        """What was wrong with the present mesh of each body when it was made."""

    def _find_obstacle(self) -> str:
        undeclared = find_undeclared(self.procedure.state)
        if undeclared:
            return f"nothing says how {', '.join(undeclared)} would pass to a new mesh"
        if importlib.util.find_spec("mmgpy") is None:
            return f"new meshes in space need mmgpy, which is not installed: {REMEDY}"
        if any(len(body.blocks) > 1 for body in self._bodies()):
            return "cells of several materials in one body cannot be meshed anew together"
        try:
            self._sections()
        except MeshError as error:
            return str(error)
        return ""

    def _sections(self) -> list[OldBody]:
        """Return the bodies where they are now."""
        procedure, model, state = self.procedure, self.model, self.procedure.state
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
        for number, body in enumerate(self._bodies()):
            own = slice(body.points.start, body.points.stop)
            topology, places = self._topologies.find(model, number)
            lost, cells = self._lost_volume(body, number), topology.cells
            found.append(
                OldBody(position[own], cells, on_tool[:, own], fixed[own], places, tools, lost, topology=topology)
            )
        if InterfaceArrays not in state:
            return found
        pushed = np.asarray((state[InterfaceArrays].force != 0.0).any(axis=1))
        return add_neighbours(found, model, [pushed[list(body.points)] for body in self._bodies()])

    def _reason_of(self, number: int, old: OldBody, wait: float) -> str | None:
        left = self._left[number]
        own = self._bodies()[number].points
        start = self.model.mesh.points[own.start : own.stop]
        breach = find_breach(old, self.model.limits, left=left, start=start)
        if number in self._on_first:
            flat = find_flat_cell(old, self._last_moves(number), self._settings_of(number).quality)
            return flat or find_cut_edge(old, deepest=LAST_CUT, sharp_counts=True) or breach
        return find_reason(old, self._last_moves(number), self._settings_of(number), wait, left=left) or breach

    def _remesh(self, reason: str, bodies: set[int] | None = None, *, must: bool = False, again: bool = False) -> bool:
        waited = self._waited
        is_new = super()._remesh(reason, bodies, must=must, again=again)
        for number, body in enumerate(self._sections()):
            if bodies and number not in bodies:
                continue
            settings, moves = self._settings_of(number), self._last_moves(number)
            if is_new:
                self._left[number] = measure_left(body, settings)
            elif self._waited == waited:  # none can be made: asked for again once this one has become worse
                self._left[number] = self._left[number].worsen(measure_left(body, settings, moves))
        return is_new

    def _epoch_arrays(self) -> NamedArrays:
        return super()._epoch_arrays() | {LEFT: np.array([astuple(left) for left in self._left])}

    def _load_epoch(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        super()._load_epoch(epoch)
        self._left = [Left(*left) for left in epoch[LEFT].tolist()]

    def _last_moves(self, number: int) -> FloatArray:
        points = self._bodies()[number].points
        return self.procedure.state.nodes.increment[points.start : points.stop, :3]

    def _make_epoch(self, old: Sequence[OldBody], own: set[int], part: float) -> tuple[ImplicitProcedure, Carrier]:
        """Return the procedure on new meshes of bodies, with the state carried to them. Raises MeshError."""
        before = self.procedure
        made: list[OldBody | NewBody] = list(old)
        for number in sorted(own):  # each beside the others as they are by then
            made[number] = remesh_beside(
                before.world, old, made, number, list_sizes(self._settings_of(number)), part=part
            )
        mesh, parts = join_bodies(before.model.mesh, self._bodies(), made)
        if any(body.others for body in old):
            mesh = replace(mesh, points=fit_joints(change_mesh(before.model, mesh), *mark_joints(old, made, parts)))
        carrier = Carrier(before.model.mesh, np.concatenate([body.points for body in old]), mesh, parts)
        return carry_to_mesh(before, mesh, carrier), carrier


@dataclass(frozen=True)
class Left:
    """What a new mesh could not mend."""

    cut: float = 0.0
    """Depth of a tool in an edge, over its length."""
    any_cut: float = 0.0
    """The same, sharp edges of tools included."""
    face: float = 0.0
    """Depth of a tool in a face, over its longest side."""
    quality: float = 1.0
    """Of the worst cell."""
    edge: float = 0.0
    """Longest edge of the skin over the size wanted there, where another mesh was refused."""
    notch: float = 180.0
    """Sharpest void that a mesh would fill [degrees]."""

    def worsen(self, other: Left) -> Left:
        """Return the worse of both in each respect."""
        worse = [max(own, its) for own, its in zip(astuple(self), astuple(other), strict=True)]
        return replace(Left(*worse), quality=min(self.quality, other.quality), notch=min(self.notch, other.notch))


def measure_left(body: OldBody, settings: Remeshing, moves: FloatArray | None = None) -> Left:
    """Return what is wrong with a new mesh, or with one that stays.

    moves: of the latter in an increment like the last (n, 3) [mm]: its cells after that and its long edges count, too.
    """
    cuts = measure_cut(body, settings.smallest_size), measure_cut(body, sharp_counts=True), measure_cut_face(body)
    then = [body.points] if moves is None else [body.points, body.points + moves]
    quality = min(float(measure_quality(points, body.cells).min()) for points in then)
    longest = 0.0 if moves is None else measure_edge(body, list_sizes(settings))
    return Left(*cuts, quality, longest, measure_notch(body)[0])


def find_reason(
    old: OldBody, moves: FloatArray, settings: Remeshing, wait: float, *, left: Left | None = None
) -> str | None:
    """Return why a body's mesh should not go on.

    wait: factor on the triggers. left: what was wrong with the mesh when it was made: only worse counts.
    """
    left = left or Left()
    return (
        find_notch(old, min(SHARP, left.notch / WORSE) / wait)
        or find_flat_cell(old, moves, min(settings.quality, left.quality / WORSE) / wait)
        or find_cut_edge(old, deepest=wait * max(TOO_DEEP, WORSE * left.cut), smallest=settings.smallest_size)
        or find_cut_edge(old, deepest=wait * max(LAST_CUT, WORSE * left.any_cut), sharp_counts=True)
        or find_long_edge(old, list_sizes(settings), longest=wait * max(TOO_LONG, WORSE * left.edge))
    )


def find_breach(old: OldBody, limits: Limits, *, left: Left, start: FloatArray | None = None) -> str | None:
    """Say where a tool comes so deep that limits.penetration would stop the run soon.

    start: where the nodes were when the mesh was made (n, 3) [mm]; None: where they are.
    """

    def allow(part: float) -> float:
        return max(BEFORE_LIMIT * limits.penetration, min(WORSE * part, AT_LIMIT * limits.penetration))

    cut = find_cut_face(old, allow(left.face))
    return cut or find_stretched_cut(old, old.points if start is None else start, allow(left.any_cut))


def draw_shape(tool: Tool, model: Model, settings: Remeshing) -> ToolShape:
    """Return what new meshes must know of a tool; ridges and slots that symmetry planes halve are wide as they are."""
    corners, triangles = draw_tool(tool, model.mesh.points, CHORD * settings.smallest_size)
    widest = settings.size / OF_WIDTH
    shape = Triangulation(corners, triangles, False)
    if isinstance(tool.surface, Triangulation):
        shape = complete_tool(tool, find_mirrors(tool, model), WITHIN * settings.smallest_size)
    widths = find_widths(shape, widest, settings.smallest_size)
    return ToolShape(find_bends(corners, triangles), widths)


def list_sizes(settings: Remeshing) -> EdgeSizes:
    """Return the sizes that settings ask for."""
    return EdgeSizes(settings.size, settings.smallest_size, settings.max_cells)
