# SPDX-License-Identifier: Apache-2.0
"""Explicit bodies of tetrahedra in space whose mesh changes in the run: what differs from the plane."""

from __future__ import annotations

import importlib.util
from collections.abc import Mapping, Sequence
from dataclasses import astuple
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.explicit.space_solids import EQPS
from presswork.mesh.checks import MeshError
from presswork.model import FloatArray, Mesh, Model, list_bodies
from presswork.outcome import StartError
from presswork.process.bodies_in_space import join_bodies, take_places
from presswork.process.epochs import NamedArrays
from presswork.process.mesh_reasons import LAST_CUT
from presswork.process.new_epoch import make_on_lead
from presswork.process.remeshed_impact import NEAR, RemeshedImpact, keep_peaks
from presswork.process.remeshing_in_space import (
    LEFT,
    Left,
    draw_shape,
    find_breach,
    find_reason,
    list_sizes,
    measure_left,
)
from presswork.process.space_impact import ExplicitSpaceImpact
from presswork.ranks.world import World
from presswork.remesh.axes import straighten_axes
from presswork.remesh.carrier import Carrier, SkinPlaces
from presswork.remesh.space.body import OldBody
from presswork.remesh.space.fill import REMEDY
from presswork.remesh.space.remesh import remesh_body
from presswork.remesh.space.tetrahedra import measure_volumes
from presswork.remesh.space.triggers import find_cut_edge

POINTS = "block_0.points"
"""Name in a dump: stress, plastic strain and what the law keeps, of the one point of each cell."""


class RemeshedSpaceImpact(RemeshedImpact, ExplicitSpaceImpact):
    """A body of tetrahedra in explicit dynamics, meshed anew where its mesh would fail."""

    def __init__(self, model: Model, *, threads: int = 0, world: World | None = None) -> None:
        assert model.remeshing is not None
        self._obstacle = _find_obstacle(model)
        if self._obstacle and not model.remeshing.keeps_first:
            raise StartError(f"{self._obstacle}: leave out [remesh]")
        self._shapes = [draw_shape(tool, model, model.remeshing) for tool in model.space_tools]
        self._left = Left()
        """What was wrong with the present mesh when it was made."""
        super().__init__(model, threads=threads, world=world)

    def begin_log(self) -> str:
        """Name the procedure and what it starts with."""
        return super().begin_log() + (f"; no new meshes: {self._obstacle}" if self._obstacle else "")

    def _find_reason(self, row: int) -> str | None:
        return None if self._obstacle else super()._find_reason(row)

    def _find_body(self) -> OldBody:
        """Return the body where it is now."""
        mesh, position = self.model.mesh, self.solids.position
        surfaces = [self._surface_of(t) for t in range(len(self.walls))]
        near = NEAR * self._remeshing.smallest_size
        on_tool = np.zeros((len(surfaces), len(position)), dtype=bool)
        outer = np.unique(mesh.boundary_faces)
        for t, surface in enumerate(surfaces):
            on_tool[t, outer] = np.abs(surface.nearest(position[outer], 2.0 * near)[0]) < near
        tools = [shape.place(surface, surface.pose) for surface, shape in zip(surfaces, self._shapes, strict=True)]
        cells = mesh.blocks[0].connectivity.astype(np.intp)
        places = take_places(self.model, *list_bodies(self.model))
        return OldBody(position, cells, on_tool, self._find_held(), places, tools, self._find_loss())

    def _find_reason_to_leave_first(self) -> str | None:
        return find_cut_edge(self._find_body(), deepest=LAST_CUT, sharp_counts=True)

    def _find_wear(self) -> str | None:
        body = self._find_body()
        worn = find_reason(body, self._increment, self._remeshing, 1.0, left=self._left)
        return worn or find_breach(body, self.model.limits, left=self._left)

    def _remesh(self, reason: str, *, failed: bool = False) -> bool:
        is_new = super()._remesh(reason, failed=failed)
        if is_new:
            self._left = measure_left(self._find_body(), self._remeshing)
        return is_new

    def _epoch_arrays(self) -> NamedArrays:
        return super()._epoch_arrays() | {LEFT: np.array(astuple(self._left))}

    def _load_epoch(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        super()._load_epoch(epoch)
        self._left = Left(*epoch[LEFT].tolist())

    def _make_mesh(self) -> tuple[Mesh, SkinPlaces, Sequence[FloatArray]]:
        new = make_on_lead(self._world, remesh_body, self._find_body(), list_sizes(self._remeshing))
        mesh, (part,) = join_bodies(self.model.mesh, list_bodies(self.model), [new])
        assert isinstance(part.surface, SkinPlaces)
        return mesh, part.surface, part.seams

    def _mend(self, carrier: Carrier, dump: Mapping[str, FloatArray], found: dict[str, FloatArray]) -> None:
        points, peaks = found[POINTS], slice(EQPS, EQPS + 1)
        points[:, 0, peaks] = keep_peaks(
            carrier, "eqps", dump[POINTS][:, 0, peaks], np.ascontiguousarray(points[:, 0, peaks]), self._find_volumes()
        )
        material = self.model.materials[self.model.mesh.blocks[0].material]
        if points.shape[2] > EQPS + 1 and material.umat is None:  # the law's axes, the last six
            points[:, 0, -6:] = straighten_axes(points[:, 0, -6:])

    def _find_volumes(self) -> FloatArray:
        return measure_volumes(self.solids.position, self.model.mesh.blocks[0].connectivity.astype(np.intp))


def _find_obstacle(model: Model) -> str:
    """Return why no new meshes can be made; empty: they can."""
    if importlib.util.find_spec("mmgpy") is None:
        return f"new meshes in space need mmgpy, which is not installed: {REMEDY}"
    try:
        take_places(model, *list_bodies(model))
    except MeshError as error:
        return str(error)
    return ""
