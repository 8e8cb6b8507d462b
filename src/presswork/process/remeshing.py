# SPDX-License-Identifier: Apache-2.0
"""Solids in the plane and in axisymmetry whose mesh changes in the run: when, and how the state goes along.

Each mesh is an epoch (process/epochs.py): its points are where the material was when it began, its displacements begin
at zero. The material's first place is carried from mesh to mesh, so that results tell displacements of the whole run.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.body.solids import Mechanics
from presswork.geometry.pose import ToolPose, place_segments, start_centre, start_profile
from presswork.implicit.epochs import Epoch, new_epoch
from presswork.implicit.progress import Progress
from presswork.implicit.stepping import ImplicitProcedure, IncrementReport
from presswork.interaction.tool_arrays import ContactArrays, ToolArrays
from presswork.mesh.checks import MeshError
from presswork.mesh.edges import edge_areas
from presswork.model import BoolArray, FloatArray, IndexArray, Model, Remeshing
from presswork.outcome import Failed, GaveUpError, StartError
from presswork.process.implicit_recording import ImplicitRecording
from presswork.process.recording import Row
from presswork.remesh.section import NewSection, OldSection, measure_sizes, remesh_section
from presswork.remesh.transfer import Places, find_transfer, locate, place_points
from presswork.remesh.triggers import find_cut_edge, find_flat_cell, find_long_edge


class RemeshedForming(ImplicitRecording):
    """An implicit procedure at work on one body of quadrilaterals, meshed anew where its mesh would fail."""

    def __init__(self, model: Model, *, threads: int = 0) -> None:
        super().__init__(model, threads=threads)
        assert model.remeshing is not None
        try:
            self._section().chain()
        except MeshError as error:
            raise StartError(f"{error}: leave out [remesh]") from error
        self.settings: Remeshing = model.remeshing

    @property
    def columns(self) -> list[str]:
        """Of history.csv."""
        return [*super().columns, "cells", "remeshes"]

    def row(self, report: IncrementReport) -> Row:
        """Return the row of the history."""
        cells = sum(len(block.connectivity) for block in self.model.mesh.blocks)
        return super().row(report) | {"cells": cells, "remeshes": self.epoch}

    def _may_change_mesh(self, failure: str = "") -> bool:
        """Make another mesh if the present one should not go on, and go on with it; return whether there is one."""
        if failure:
            return not self._made_at == self.number > 0 and self._remesh("the next increment fails")
        reason = self._reason()
        return reason is not None and self._remesh(reason)

    def _reason(self) -> str | None:
        """Return why the present mesh should not go on."""
        state, mesh = self.procedure.state, self.model.mesh
        position = mesh.points + state.nodes.displacement
        if self.settings.every > 0.0 and self._passed_fraction():
            return "due"
        cells = np.concatenate([block.connectivity for block in mesh.blocks]).astype(np.intp)
        flat = find_flat_cell(position, state.nodes.increment, cells, self.settings.quality)
        if flat is not None:
            return flat
        old = self._section()
        chain = old.chain()
        cut = find_cut_edge(position[chain], old.profiles)
        return cut or find_long_edge(position[chain], measure_sizes(old, chain, self.settings))

    def _passed_fraction(self) -> bool:
        progress = self.procedure.state[Progress]
        before = progress.fraction or 1.0
        last = before - progress.last_size if progress.fraction else 1.0 - self.settings.every
        every = self.settings.every * (1 - 1e-9)
        return bool(np.floor(before / every) > np.floor(last / every))

    def _section(self) -> OldSection:
        procedure, model, state = self.procedure, self.model, self.procedure.state
        contact = procedure.interactions.tools.contact
        on_tool = np.zeros((len(model.plane_tools), len(model.mesh.points)), dtype=bool)
        profiles = []
        if ToolArrays in state:
            held, placed = state[ContactArrays].status > 0, state[ToolArrays]
            on_tool[:, contact.nodes] = held.reshape(len(model.plane_tools), 2, -1).any(axis=1)
            profiles = [
                place_segments(start_profile(t), ToolPose(start_centre(t), moved, float(angle)))
                for t, moved, angle in zip(model.plane_tools, placed.displacement, placed.angle, strict=True)
            ]
        fixed = procedure.interactions.supports.fixed(procedure.present_step().stage)
        position = model.mesh.points + state.nodes.displacement
        return OldSection(model.mesh, position, on_tool, np.asarray(fixed), profiles, model.analysis == "axisymmetric")

    def _remesh(self, reason: str) -> bool:
        """Make a new mesh and go on with it; the old one stays where that fails."""
        old = self._section()
        try:
            new = remesh_section(old, self.settings)
        except MeshError as error:
            return self._stay(reason, str(error))
        before = self.procedure
        transfer = _Transfer(old, new)
        try:
            after = new_epoch(before, new.mesh, transfer)
        except GaveUpError as error:
            return self._stay(reason, str(error))
        _return_to_yield(after)
        _carry_friction(before, after, new)
        outcome = after.balance_at_rest()
        if isinstance(outcome, Failed):
            return self._stay(reason, f"no equilibrium on the new mesh, {outcome.reason}")
        force, force_n = (p.state[ToolArrays].force[:, :2] for p in (after, before))
        jump = np.abs(force - force_n).max(initial=0.0) / max(np.abs(force_n).max(initial=0.0), 1e-300)
        origin = transfer.places.interpolate(self.mesh.points)
        if old.ring:
            origin[new.mesh.points[:, 0] == 0.0, 0] = 0.0
        self._begin_on(after, origin)
        volume = after.volume() / after.initial_volume - 1.0
        self._notes.append(
            f"remesh {self.epoch} ({reason}): {len(new.mesh.blocks[0].connectivity)} cells, largest "
            f"force of a tool changes by {jump:.2%}, volume {volume:+.2e} of the first, {len(outcome.log)} iterations"
        )
        return True

    def _stay(self, reason: str, fault: str) -> bool:
        """Go on with the old mesh."""
        self._notes.append(f"not remeshed ({reason}): {fault}")
        self._made_at = self.number
        return False

    def summary(self, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return what the summary tells, and how many meshes there were."""
        return super().summary(history) | {"remeshes": self.epoch}


class _Transfer:
    """What nodes and integration points of a new mesh take from the old one."""

    def __init__(self, old: OldSection, new: NewSection) -> None:
        cells = old.mesh.blocks[0].connectivity.astype(np.intp)
        self._old, self._cells, self._new_cells = old, cells, new.mesh.blocks[0].connectivity.astype(np.intp)
        self.places: Places = locate(old.position, cells, new.mesh.points)

    def __call__(self, before: Epoch, after: Epoch) -> None:
        """Fill the State on the new mesh."""
        state_n, state = before.state, after.state
        state.nodes.increment = self.places.interpolate(state_n.nodes.increment)
        n_points, shape = state_n.cells.eqps[0].shape[1], state.cells.eqps[0].shape
        start = place_points(self._old.position, self._cells, n_points).reshape(-1, 2)
        end = place_points(after.mesh.points, self._new_cells, n_points).reshape(-1, 2)
        home = locate(self._old.position, self._cells, end).cell
        transfer = find_transfer(start, end, self._cells, home, np.repeat(np.arange(len(self._cells)), n_points))

        def carry(values: FloatArray) -> FloatArray:
            return transfer.apply(values.reshape(len(start), -1)).reshape(*shape, *values.shape[2:])

        state.cells.stress = [carry(state_n.cells.stress[0])]
        state.cells.eqps = [np.maximum(carry(state_n.cells.eqps[0]), 0.0)]
        state.cells.history = [carry(state_n.cells.history[0])]
        if state_n.cells.temperature[0].size:
            state.cells.temperature = [carry(state_n.cells.temperature[0])]


def _return_to_yield(procedure: ImplicitProcedure) -> None:
    """Bring what was fitted back to what a law can have.

    Deviators beyond the flow stress are scaled to it, of laws with isotropic hardening alone. The directions of other
    laws' axes, their last two values, get their length back.
    """
    state, mechanics = procedure.state, procedure.mechanics
    assert isinstance(mechanics, Mechanics)
    history, stress = state.cells.history[0], state.cells.stress[0]
    if history.shape[2] > 0:
        if procedure.model.materials[procedure.model.mesh.blocks[0].material].umat is None:
            length = np.linalg.norm(history[..., -2:], axis=-1, keepdims=True)
            history[..., -2:] /= np.where(length > 0.0, length, 1.0)
        return
    flow = mechanics.flow_stress(0, state)
    mean = stress[..., :3].mean(axis=-1)
    deviator = stress.copy()
    deviator[..., :3] -= mean[..., None]
    effective = np.sqrt(1.5 * ((deviator[..., :3] ** 2).sum(axis=-1) + 2.0 * deviator[..., 3] ** 2))
    factor = np.minimum(1.0, flow / np.maximum(effective, 1e-300))
    stress[...] = deviator * factor[..., None]
    stress[..., :3] += mean[..., None]


def _carry_friction(before: ImplicitProcedure, after: ImplicitProcedure, new: NewSection) -> None:
    """Carry the friction per area along the boundary."""
    state_n, state = before.state, after.state
    if ContactArrays not in state:
        return
    contact_n, contact = before.interactions.tools.contact, after.interactions.tools.contact
    area_n, area = (_boundary_areas(p) for p in (before, after))
    shear_n = np.zeros(len(before.model.mesh.points))
    shear_n[contact_n.nodes] = state_n[ContactArrays].drag / np.maximum(area_n[contact_n.nodes], 1e-300)
    first = new.line.place.astype(int)
    part = new.line.place - first
    along = shear_n[new.chain]
    shear = np.zeros(len(after.model.mesh.points))
    shear[: len(first)] = (1.0 - part) * along[first] + part * np.roll(along, -1)[first]
    held: BoolArray = np.asarray((state[ContactArrays].status > 0).any(axis=0))
    nodes: IndexArray = contact.nodes.astype(np.intp)
    state[ContactArrays].drag = np.where(held, shear[nodes] * area[nodes], 0.0)


def _boundary_areas(procedure: ImplicitProcedure) -> FloatArray:
    """Return the area of the boundary round each node (n_points,) [mm2]."""
    model = procedure.model
    thickness = None if model.analysis == "axisymmetric" else model.depth
    edges = model.mesh.boundary_edges
    areas = edge_areas(model.mesh.points + procedure.state.nodes.displacement, edges, thickness)
    return np.asarray(np.bincount(edges.ravel(), areas.ravel(), minlength=len(model.mesh.points)), dtype=float)
