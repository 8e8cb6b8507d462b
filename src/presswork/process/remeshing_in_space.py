# SPDX-License-Identifier: Apache-2.0
"""Bodies of tetrahedra whose mesh changes in the run: when, and how the state goes along."""

from __future__ import annotations

import importlib.util
from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.body.solids import Mechanics
from presswork.geometry.tool_widths import find_widths
from presswork.implicit.epochs import Epoch, new_epoch
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.tool_arrays import SpaceToolArrays
from presswork.mesh.checks import MeshError
from presswork.model import (
    CellBlock,
    FloatArray,
    IndexArray,
    IntArray,
    Limits,
    Mesh,
    Model,
    Remeshing,
    Tool,
    Triangulation,
    list_sets,
)
from presswork.process.carrying import carry_state, carry_surface, find_undeclared
from presswork.process.epochs import NamedArrays
from presswork.process.mesh_reasons import LAST_CUT
from presswork.process.remeshing import RemeshedForming
from presswork.process.space_surfaces import draw_tool
from presswork.remesh.carrier import Carrier, Part, SkinPlaces
from presswork.remesh.space.body import NewBody, OldBody
from presswork.remesh.space.fill import REMEDY
from presswork.remesh.space.remesh import remesh_body
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

    def __init__(self, model: Model, *, threads: int = 0) -> None:
        assert model.remeshing is not None
        self._shapes = [draw_shape(tool, model.mesh.points, model.remeshing) for tool in model.space_tools]
        super().__init__(model, threads=threads)
        self._left = Left()
        """What was wrong with the present mesh when it was made."""

    def _find_obstacle(self) -> str:
        undeclared = find_undeclared(self.procedure.state)
        if undeclared:
            return f"nothing says how {', '.join(undeclared)} would pass to a new mesh"
        if importlib.util.find_spec("mmgpy") is None:
            return f"new meshes in space need mmgpy, which is not installed: {REMEDY}"
        try:
            self._sections()
        except MeshError as error:
            return str(error)
        return ""

    def _sections(self) -> list[OldBody]:
        """Return the body where it is now."""
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
        (body,) = self._bodies()
        return [
            OldBody(
                model.mesh.points + state.nodes.moved,
                model.mesh.blocks[0].connectivity.astype(np.intp),
                on_tool,
                fixed,
                take_places(model),
                tools,
                self._lost_volume(body, 0),
            )
        ]

    def _reason_of(self, number: int, old: OldBody, wait: float) -> str | None:
        breach = find_breach(old, self.model.limits, left=self._left)
        if number in self._on_first:
            flat = find_flat_cell(old, self._last_moves(), self.settings.quality)
            return flat or find_cut_edge(old, deepest=LAST_CUT, sharp_counts=True) or breach
        return find_reason(old, self._last_moves(), self.settings, wait, left=self._left) or breach

    def _remesh(self, reason: str, bodies: set[int] | None = None, *, must: bool = False, again: bool = False) -> bool:
        waited = self._waited
        is_new = super()._remesh(reason, bodies, must=must, again=again)
        (body,) = self._sections()
        if is_new:
            self._left = measure_left(body, self.settings)
        elif self._waited == waited:  # none can be made: asked for again once this one has become worse
            self._left = self._left.worsen(measure_left(body, self.settings, self._last_moves()))
        return is_new

    def _epoch_arrays(self) -> NamedArrays:
        return super()._epoch_arrays() | {LEFT: np.array(astuple(self._left))}

    def _load_epoch(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        super()._load_epoch(epoch)
        self._left = Left(*epoch[LEFT].tolist())

    def _last_moves(self) -> FloatArray:
        return self.procedure.state.nodes.increment[:, :3]

    def _make_epoch(self, old: Sequence[OldBody], own: set[int], part: float) -> tuple[ImplicitProcedure, Carrier]:
        """Return the procedure on a new mesh of the body, with the state carried to it. Raises MeshError."""
        before, (body,) = self.procedure, old
        new = remesh_body(body, list_sizes(self.settings), part=part)
        mesh = to_mesh(before.model.mesh, new)
        places = SkinPlaces(new.skin, new.corners, new.share)
        all_old, all_new = range(len(body.points)), range(len(new.points))
        carrier = Carrier(before.model.mesh, body.points, mesh, [Part(all_old, all_new, 0, places)])

        def fill(epoch: Epoch, next_epoch: Epoch) -> None:
            carry_state(epoch, next_epoch, carrier)
            nodes_n, nodes = epoch.state.nodes, next_epoch.state.nodes
            scale = _find_scale(epoch) / _find_scale(next_epoch)
            nodes.displacement[:, 3:] = scale * carrier.nodes(nodes_n.displacement[:, 3:])
            nodes.increment[:, 3:] *= scale

        after = new_epoch(before, mesh, fill)
        carry_surface(before, after, carrier)
        if SpaceToolArrays in after.state:
            hold_on_tools(after.state[SpaceToolArrays], new, body.tools)
        return after, carrier


def _find_scale(epoch: Epoch) -> float:
    """Return the pressure that counts as a length [MPa/mm], which depends on the mesh."""
    assert isinstance(epoch.run.mechanics, Mechanics)
    return epoch.run.mechanics.pressure_scale


def hold_on_tools(arrays: SpaceToolArrays, new: NewBody, tools: Sequence[PlacedTool]) -> None:
    """Let forces act at nodes on tools alone, pushes along the tools' normals and friction along them, in place."""
    for t, tool in enumerate(tools):
        nodes = np.flatnonzero(new.on_tool[t])
        push = np.linalg.norm(arrays.force[t] - arrays.friction[t], axis=1)
        _, normal = tool.touch(new.points[nodes], np.inf)
        drag = arrays.friction[t, nodes]
        drag -= np.einsum("ni,ni->n", drag, normal)[:, None] * normal
        arrays.force[t], arrays.friction[t] = 0.0, 0.0
        arrays.friction[t, nodes] = drag
        arrays.force[t, nodes] = push[nodes, None] * normal + drag


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

    def worsen(self, other: Left) -> Left:
        """Return the worse of both in each respect."""
        worse = [max(own, its) for own, its in zip(astuple(self), astuple(other), strict=True)]
        return replace(Left(*worse), quality=min(self.quality, other.quality))


def measure_left(body: OldBody, settings: Remeshing, moves: FloatArray | None = None) -> Left:
    """Return what is wrong with a new mesh, or with one that stays.

    moves: of the latter in an increment like the last (n, 3) [mm]: its cells after that and its long edges count, too.
    """
    cuts = measure_cut(body, settings.smallest_size), measure_cut(body, sharp_counts=True), measure_cut_face(body)
    then = [body.points] if moves is None else [body.points, body.points + moves]
    quality = min(float(measure_quality(points, body.cells).min()) for points in then)
    return Left(*cuts, quality, 0.0 if moves is None else measure_edge(body, list_sizes(settings)))


def find_reason(
    old: OldBody, moves: FloatArray, settings: Remeshing, wait: float, *, left: Left | None = None
) -> str | None:
    """Return why a body's mesh should not go on.

    wait: factor on the triggers. left: what was wrong with the mesh when it was made: only worse counts.
    """
    left = left or Left()
    return (
        find_flat_cell(old, moves, min(settings.quality, left.quality / WORSE) / wait)
        or find_cut_edge(old, deepest=wait * max(TOO_DEEP, WORSE * left.cut), smallest=settings.smallest_size)
        or find_cut_edge(old, deepest=wait * max(LAST_CUT, WORSE * left.any_cut), sharp_counts=True)
        or find_long_edge(old, list_sizes(settings), longest=wait * max(TOO_LONG, WORSE * left.edge))
    )


def find_breach(old: OldBody, limits: Limits, *, left: Left) -> str | None:
    """Say where a tool comes so deep that limits.penetration would stop the run soon."""
    limit = limits.penetration
    return find_cut_face(old, max(BEFORE_LIMIT * limit, min(WORSE * left.face, AT_LIMIT * limit)))


def draw_shape(tool: Tool, points: FloatArray, settings: Remeshing) -> ToolShape:
    """Return what new meshes must know of a tool that meets a body of points (n, 3) [mm]."""
    corners, triangles = draw_tool(tool, points, CHORD * settings.smallest_size)
    widest = settings.size / OF_WIDTH
    widths = find_widths(Triangulation(corners, triangles, False), widest, settings.smallest_size)
    return ToolShape(find_bends(corners, triangles), widths)


def list_sizes(settings: Remeshing) -> EdgeSizes:
    """Return the sizes that settings ask for."""
    return EdgeSizes(settings.size, settings.smallest_size, settings.max_cells)


def take_places(model: Model) -> dict[str, IndexArray]:
    """Return the faces (m, 3) of the places that a model names. Raises MeshError where one is not made of faces."""
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
        found[name] = faces.astype(np.intp)
    return found


def to_mesh(old: Mesh, new: NewBody) -> Mesh:
    """Return a new body as a mesh with the material of the old one."""
    block = old.blocks[0]
    faces = {name: _to_int(own) for name, own in new.sets.items()} | {"boundary": _to_int(new.faces)}
    nodes = {name: np.unique(own) for name, own in faces.items()}
    nodes["all"] = np.arange(len(new.points), dtype=np.int32)
    return Mesh(
        new.points,
        (CellBlock(block.element, _to_int(new.cells), block.material),),
        nodes,
        {},
        np.zeros((0, 2), dtype=np.int32),
        face_sets=faces,
        boundary_faces=_to_int(new.faces),
    )


def _to_int(values: IndexArray) -> IntArray:
    return np.ascontiguousarray(values, dtype=np.int32)
