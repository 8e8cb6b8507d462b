# SPDX-License-Identifier: Apache-2.0
"""Solids in the plane and in axisymmetry whose mesh changes in the run: when, and how the state goes along.

Each mesh is an epoch (process/epochs.py): its points are where the material was when it began, its displacements begin
at zero. The material's first place is carried from mesh to mesh, so that results tell displacements of the whole run.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.geometry.pose import ToolPose, place_segments, start_centre, start_profile
from presswork.implicit.epochs import new_epoch
from presswork.implicit.progress import Progress
from presswork.implicit.stepping import ImplicitProcedure, IncrementReport
from presswork.interaction.tool_arrays import ContactArrays, ToolArrays
from presswork.mesh.checks import MeshError
from presswork.model import FloatArray, Mesh, Model, Remeshing
from presswork.outcome import Failed, GaveUpError, StartError
from presswork.process.carrying import carry_state, carry_surface, find_undeclared
from presswork.process.implicit_recording import ImplicitRecording
from presswork.process.recording import Row
from presswork.remesh.carrier import Carrier, Part
from presswork.remesh.section import NewSection, OldSection, measure_sizes, remesh_section
from presswork.remesh.triggers import find_cut_edge, find_flat_cell, find_long_edge

MOST_JUMP = 0.02
"""Change of a tool's force, of the largest, from which on a finer mesh is tried."""
MOST_GIVEN_BACK = 1e-3
"""Part of the volume, lost by cells before, that one remesh gives back at most."""
FINER = 0.7
"""Of the size that is asked for, in such a mesh."""


class RemeshedForming(ImplicitRecording):
    """An implicit procedure at work on one body of quadrilaterals, meshed anew where its mesh would fail."""

    def __init__(self, model: Model, *, threads: int = 0) -> None:
        super().__init__(model, threads=threads)
        assert model.remeshing is not None
        undeclared = find_undeclared(self.procedure.state)
        if undeclared:
            raise StartError(f"nothing says how {', '.join(undeclared)} would pass to a new mesh: leave out [remesh]")
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
        ring = model.analysis == "axisymmetric"
        return OldSection(model.mesh, position, on_tool, np.asarray(fixed), profiles, ring, self._lost_volume())

    def _lost_volume(self) -> float:
        """Return the part of the volume that cells have lost beyond what their pressure explains."""
        cells, unloaded = self.procedure.state.cells, 0.0
        for block, stress, volume in zip(self.model.mesh.blocks, cells.stress, cells.volume, strict=True):
            material = self.model.materials[block.material]
            dilatation = stress[..., :3].sum(axis=-1) * (1.0 - 2.0 * material.poisson) / material.young
            unloaded += float((volume * np.exp(-dilatation)).sum())
        return float(np.clip(self.procedure.initial_volume / unloaded - 1.0, -MOST_GIVEN_BACK, MOST_GIVEN_BACK))

    def _remesh(self, reason: str) -> bool:
        """Make a new mesh and go on with it; the old one stays where that fails.

        Where a tool's force changes by more than MOST_JUMP a second, finer mesh is tried; the better one is taken.
        """
        old, found, faults = self._section(), [], []
        for part in (1.0, FINER):
            try:
                found.append(self._try_mesh(old, part))
            except (MeshError, GaveUpError) as error:
                faults.append(str(error))
                continue
            if found[-1].jump <= MOST_JUMP:
                break
        if not found:
            return self._stay(reason, faults[0])
        new = min(found, key=lambda mesh: mesh.jump)
        self._begin_on(new.procedure, new.origin)
        volume = new.procedure.volume() / new.procedure.initial_volume - 1.0
        self._notes.append(
            f"remesh {self.epoch} ({reason}): {len(self.model.mesh.blocks[0].connectivity)} cells, largest "
            f"force of a tool changes by {new.jump:.2%}, volume {volume:+.2e} of the first, {new.iterations} iterations"
            + (f"; none of {len(found)} meshes keeps the force within {MOST_JUMP:.0%}" if new.jump > MOST_JUMP else "")
        )
        return True

    def _try_mesh(self, old: OldSection, part: float) -> _NewEpoch:
        """Return equilibrium on a new mesh of a part of the size. Raises MeshError or GaveUpError."""
        before, new = self.procedure, remesh_section(old, self.settings, part=part)
        carrier = Carrier(old.mesh, old.position, new.mesh, [_whole(old.mesh, new)])
        after = new_epoch(before, new.mesh, lambda old, new: carry_state(old, new, carrier))
        carry_surface(before, after, carrier)
        outcome = after.balance_at_rest()
        if isinstance(outcome, Failed):
            raise GaveUpError(f"no equilibrium on the new mesh, {outcome.reason}")
        force, force_n = (p.state[ToolArrays].force[:, :2] for p in (after, before))
        jump = np.abs(force - force_n).max(initial=0.0) / max(np.abs(force_n).max(initial=0.0), 1e-300)
        origin = carrier.motion(self.mesh.points)
        if old.ring:
            origin[new.mesh.points[:, 0] == 0.0, 0] = 0.0
        return _NewEpoch(after, origin, float(jump), len(outcome.log))

    def _stay(self, reason: str, fault: str) -> bool:
        """Go on with the old mesh."""
        self._notes.append(f"not remeshed ({reason}): {fault}")
        self._made_at = self.number
        return False

    def summary(self, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return what the summary tells, and how many meshes there were."""
        return super().summary(history) | {"remeshes": self.epoch}


@dataclass(frozen=True)
class _NewEpoch:
    """Equilibrium on a new mesh, with the tools at rest."""

    procedure: ImplicitProcedure
    origin: FloatArray
    """First places of the material at its nodes (n_points, 2) [mm]."""
    jump: float
    """Largest change of a tool's force, of the largest force."""
    iterations: int


def _whole(old: Mesh, new: NewSection) -> Part:
    """Return the only body as a part."""
    return Part(range(len(old.points)), range(len(new.mesh.points)), 0, new.surface())
