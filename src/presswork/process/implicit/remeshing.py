# SPDX-License-Identifier: Apache-2.0
"""Solids in the plane and in axisymmetry whose mesh changes in the run: when, and how the state goes along.

Each mesh is an epoch (process/epochs.py): its points are where the material was when it began, its displacements begin
at zero. The material's first place is carried from mesh to mesh, so that results tell displacements of the whole run.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.fields.instant import Instant
from presswork.geometry.pose import ToolPose, place_segments, shift_segments, start_centre, start_profile
from presswork.implicit.progress import Progress
from presswork.implicit.stepping import ImplicitProcedure, IncrementReport
from presswork.interaction.bodies.body_surfaces import InterfaceArrays
from presswork.interaction.bodies.laps import LapArrays
from presswork.interaction.tool_arrays import ContactArrays, ToolArrays
from presswork.mesh.checks import MeshError
from presswork.mesh.joined import split_mesh
from presswork.model import Body, FloatArray, Model, Remeshing, find_cell, take_corners
from presswork.observe.contract import Row
from presswork.outcome import Failed, GaveUpError, StartError
from presswork.process.epochs import NamedArrays
from presswork.process.implicit.folding import FoldingRecording
from presswork.process.implicit.increments import find_position
from presswork.process.mesh_change.carrying import OnMesh, carry_peaks, carry_to_mesh, find_undeclared
from presswork.process.mesh_change.laps import find_laps, mark_laps, tell_laps
from presswork.process.mesh_change.mesh_reasons import (
    DUE,
    EARLY,
    FAILS,
    find_cause,
    find_reason,
    find_reason_to_leave_first,
    find_shares,
    find_tool_moves,
    will_land,
)
from presswork.process.mesh_change.new_balance import balance_new_mesh, measure_jump
from presswork.process.mesh_change.new_epoch import NewEpoch, join_sections, keep_held, make_on_lead
from presswork.process.mesh_change.seams import Seams
from presswork.ranks.world import World
from presswork.remesh.carrier import Carrier
from presswork.remesh.landing import find_closing
from presswork.remesh.section import OldSection, check_budget, draw_outlines, remesh_section
from presswork.remesh.size_field import measure_power

MOST_JUMP = 0.02
"""Change of a tool's force, of the largest, beyond which another mesh is tried, and none taken that can wait."""
WAIT = 1.5
"""Factor on all triggers, up to which the present mesh goes on rather than one that changes the force too much."""
MOST_WAITS = 3
"""Times that a mesh is put off because it changes the force: what waits longer only gets worse."""
WAITED, ON_FIRST = "waited", "on_first"
"""Names in a checkpoint."""
PARTS = (1.0, 0.7, 0.85, 0.6, 0.77)
"""Of the size that is asked for, in meshes tried one after the other."""
MOST_GIVEN_BACK = 1e-3
"""Part of the volume, lost by cells before, that one remesh gives back at most."""


class RemeshedForming(FoldingRecording):
    """An implicit procedure at work on bodies in the plane, each meshed anew where its mesh would fail."""

    parts: tuple[float, ...] = PARTS
    """Of the size that is asked for, in meshes tried one after the other."""
    waits_first = False
    """Whether a mesh that changes a force too much is rather put off than followed by another try."""

    def __init__(self, model: Model, *, threads: int = 0, world: World | None = None) -> None:
        """world: ranks that share the cells; rank 0 makes new meshes for all."""
        super().__init__(model, threads=threads, world=world)
        assert model.remeshing is not None
        self.settings: Remeshing = model.remeshing
        volume = self.procedure.state.cells.volume
        self._first_volumes = [sum(float(volume[i].sum()) for i in body.blocks) for body in self._bodies()]
        self._seams = Seams()
        self._stayed = False
        """Whether a new mesh was refused after the last increment."""
        self._cause = 0
        """Why the present mesh was made, until the first increment on it is told."""
        self._waited = 0
        """How often one was put off because it changes the force, on this mesh."""
        self._on_first = set(range(self._n_bodies)) if self.settings.keeps_first else set()
        """Bodies whose first mesh is to stay until it fails."""
        if not self.settings.keeps_first:
            self._made_at = -1  # the first mesh is looked at, too
        self._obstacle = self.settings.obstacle or self._find_obstacle()
        if self._obstacle and not self.settings.keeps_first:
            raise StartError(f"{self._obstacle}: leave out [remesh]")

    def _find_obstacle(self) -> str:
        """Say what prevents any other mesh; empty if nothing does."""
        undeclared = find_undeclared(self.procedure.state)
        if undeclared:
            return f"nothing says how {', '.join(undeclared)} would pass to a new mesh"
        try:
            for number, section in enumerate(self._sections()):
                if section.chains and not self.settings.keeps_first:
                    check_budget(section, self._settings_of(number))
        except MeshError as error:
            return str(error)
        return ""

    @property
    def columns(self) -> list[str]:
        """Of history.csv."""
        return [*super().columns, "cells", "remeshes", "remesh_cause"]

    def row(self, report: IncrementReport) -> Row:
        """Return the row of the history."""
        cells = sum(len(block.connectivity) for block in self.model.mesh.blocks)
        cause, self._cause = self._cause, 0
        return super().row(report) | {"cells": cells, "remeshes": self.epoch, "remesh_cause": cause}

    def _may_change_mesh(self, failure: str = "") -> bool:
        """Make another mesh if the present one should not go on, and go on with it; return whether there is one."""
        if not failure:
            self._watch_folds()
        if self._obstacle:
            return False
        if failure:
            again = self._made_at == self.number and not self._stayed
            return self._remesh(FAILS, must=True, again=again)
        found = self._reason()
        return found is not None and self._remesh(*found)

    def _reason(self, wait: float = 1.0) -> tuple[str, set[int]] | None:
        """Return why the present mesh should not go on, and of which bodies; wait: factor on the triggers."""
        if wait == 1.0 and self.number > 0 and self._passed_fraction():
            return DUE, set(range(self._n_bodies))
        found: dict[int, str] = {}
        for number, old in enumerate(self._sections()):
            reason = self._reason_of(number, old, wait)
            if reason is not None:
                found[number] = reason
        return ("; ".join(dict.fromkeys(found.values())), set(found)) if found else None

    def _reason_of(self, number: int, old: Any, wait: float) -> str | None:
        """Return why the mesh of a body, as _sections has it, should not go on; wait: factor on the triggers."""
        old = old if wait == 1.0 else replace(old, closing=None)  # small cells where nodes land can wait
        if number in self._on_first:
            return find_reason_to_leave_first(old)
        own = self.procedure.state.nodes.increment[old.points.start : old.points.stop]
        if wait == 1.0 and will_land(old, self.procedure.state, self.model):
            return find_reason(old, own, self._settings_of(number), wait, early=EARLY)
        return find_reason(old, own, self._settings_of(number), wait)

    def begin_log(self) -> str:
        """Name the linear solver, and what prevents new meshes."""
        return super().begin_log() + (f"; no new meshes: {self._obstacle}" if self._obstacle else "")

    def _find_hints(self) -> list[str]:
        """Return what may have made the increment fail, and what prevents new meshes."""
        hints = [f"no new mesh: {self._obstacle}"] if self._obstacle else []
        if self._on_first and not self._obstacle:
            hints = ["[remesh] in the case makes new meshes before the first one fails"]
        return [*super()._find_hints(), *hints]

    @property
    def _n_bodies(self) -> int:
        return max(len(self.model.bodies), 1)

    def _settings_of(self, body: int) -> Remeshing:
        """Return the sizes and triggers of a body."""
        return self.settings.of_body(self.model.bodies[body].name) if self.model.bodies else self.settings

    def _passed_fraction(self) -> bool:
        if self.settings.every == 0.0:
            return False
        progress = self.procedure.state[Progress]
        before = progress.fraction or 1.0
        last = before - progress.last_size if progress.fraction else 1.0 - self.settings.every
        every = self.settings.every * (1 - 1e-9)
        return bool(np.floor(before / every) > np.floor(last / every))

    def _sections(self) -> Sequence[Any]:
        """Return the bodies where they are now."""
        procedure, model, state = self.procedure, self.model, self.procedure.state
        n_points = len(model.mesh.points)
        on_tool = np.zeros((len(model.plane_tools), n_points), dtype=bool)
        profiles = []
        if ToolArrays in state:
            held, placed = state[ContactArrays].status > 0, state[ToolArrays]
            touching = held.reshape(len(model.plane_tools), 2, -1).any(axis=1)
            on_tool[:, procedure.interactions.tools.contact.nodes] = touching
            profiles = [
                place_segments(start_profile(t), ToolPose(start_centre(t), moved, float(angle)))
                for t, moved, angle in zip(model.plane_tools, placed.displacement, placed.angle, strict=True)
            ]
        if InterfaceArrays in state:
            on_others = (state[InterfaceArrays].force != 0.0).any(axis=1)
            for number, body in enumerate(self._bodies()):  # where it touches itself it has folded: a lap may be closed
                if all(number not in c.between or c.slave == c.master for c in model.contacts):
                    on_others[body.points.start : body.points.stop] = False
            on_tool = np.concatenate([on_tool, on_others[None]])
        fixed = np.asarray(procedure.interactions.supports.fixed(procedure.present_step().stage))
        share = find_shares(state, fixed) * on_tool[: len(model.plane_tools)].any(axis=0)
        position = model.mesh.points + state.nodes.moved
        bodies, moved = self._bodies(), state.nodes.increment[:, :2]
        before = [shift_segments(p, -move) for p, move in zip(profiles, find_tool_moves(state, model), strict=True)]
        outlines, outlines_then = (draw_outlines(model.mesh, bodies, at) for at in (position, position - moved))
        sections: list[OldSection] = []
        for number, (body, mesh) in enumerate(zip(bodies, split_mesh(model.mesh, bodies), strict=True)):
            own = slice(body.points.start, body.points.stop)
            ring, lost = model.analysis == "axisymmetric", self._lost_volume(body, number)
            touched = sorted({i for c in model.contacts for i in c.between if number in c.between and i != number})
            others, others_then = ([o for i in touched for o in of[i]] for of in (outlines, outlines_then))
            closing = find_closing(position[own], moved[own], [*profiles, *others], [*before, *others_then])
            sections.append(
                OldSection(
                    mesh, position[own], on_tool[:, own], fixed[own], profiles, ring, body.points, lost,
                    self._find_power(body) if self.settings.error else None,
                    others=others, closing=closing, share=share[own],
                )
            )  # fmt: skip
        return sections

    def _find_power(self, body: Body) -> FloatArray | None:
        """Return the stress power over volume in the last increment, in each cell of a body (n_cells,) [MPa]."""
        state, mesh = self.procedure.state, self.model.mesh
        if not state.nodes.increment.any():
            return None
        cells = mesh.blocks[body.blocks.start].connectivity
        corners = take_corners(cells)
        stress = state.cells.stress[body.blocks.start].mean(axis=1)
        position = mesh.points + state.nodes.moved
        ring = self.model.analysis == "axisymmetric"
        return measure_power(position[corners], state.nodes.increment[corners], stress, ring=ring)

    def _lost_volume(self, body: Body, number: int) -> float:
        """Return the part of a body's volume that cells have lost beyond what their pressure explains."""
        cells, unloaded = self.procedure.state.cells, 0.0
        for block in body.blocks:
            material = self.model.materials[self.model.mesh.blocks[block].material]
            if material.gtn is not None:  # its pores grow
                return 0.0
            stress, volume = cells.stress[block], cells.volume[block]
            dilatation = stress[..., :3].sum(axis=-1) * (1.0 - 2.0 * material.poisson) / material.young
            unloaded += float((volume * np.exp(-dilatation)).sum())
        if unloaded <= 0.0:  # products of its lengths vanish
            return 0.0
        lost = self._first_volumes[number] / unloaded - 1.0
        return float(np.clip(lost, -MOST_GIVEN_BACK, MOST_GIVEN_BACK))

    def _remesh(self, reason: str, bodies: set[int] | None = None, *, must: bool = False, again: bool = False) -> bool:
        """Make new meshes of bodies (None: of all), and go on with them; the old ones stay where that fails.

        Where a tool's force changes by more than MOST_JUMP, finer meshes are tried. The best one is taken if it keeps
        the force, or if there must be one. again: the last one has failed at once; now the metal may yield while the
        tools are at rest. Quadratic cells all give way at once: bodies have as many nodes on an edge.
        """
        old = self._sections()
        own = (
            bodies if bodies and not find_cell(1, self.model.mesh.boundary_edges).is_quadratic else set(range(len(old)))
        )
        found: list[NewEpoch] = []
        faults: list[str] = []
        self._stayed = False
        for part in self.parts:
            try:
                found.append(self._try_mesh(old, own, part, may_yield=again))
            except (MeshError, GaveUpError) as error:
                faults.append(str(error))
                if self.waits_first and not must and isinstance(error, MeshError):  # finer ones have been tried, too
                    break
                continue
            if found[-1].jump <= MOST_JUMP or (self.waits_first and not must and self._may_wait()):
                break
        if not found:
            return self._stay(reason, faults[0])
        new = min(found, key=lambda mesh: mesh.jump)
        if new.jump > MOST_JUMP and not must and self._may_wait():
            self._waited += 1
            return self._stay(reason, f"the largest force of a tool would change by {new.jump:.2%}")
        seams = self._seams.places(find_position(self.procedure))
        self._go_on(new)
        self._seams.go_on(self.model.mesh, seams, new.seams, self.procedure.state[Progress].time)
        self._waited, self._cause = 0, find_cause(reason)
        self._on_first -= own
        volume = new.procedure.volume() / new.procedure.initial_volume - 1.0
        cells = sum(len(block.connectivity) for block in self.model.mesh.blocks)
        self._notes.append(
            f"remesh {self.epoch} ({reason}): {cells} cells, largest "
            f"force of a tool changes by {new.jump:.2%}, volume {volume:+.2e} of the first, {new.iterations} iterations"
            + (f"; none of {len(found)} meshes keeps the force within {MOST_JUMP:.0%}" if new.jump > MOST_JUMP else "")
        )
        return True

    def _go_on(self, new: NewEpoch) -> None:
        """Go on with new meshes. Raises GaveUpError."""
        self._begin_on(new.procedure, new.origin, new.procedure.model.mesh.points)

    def _may_wait(self) -> bool:
        """Say whether the present mesh may go on for another increment."""
        return self._waited < MOST_WAITS and self._reason(WAIT) is None

    def _try_mesh(self, old: Sequence[Any], own: set[int], part: float, *, may_yield: bool) -> NewEpoch:
        """Return equilibrium on new meshes of bodies, of a part of the size. Raises MeshError or GaveUpError."""
        before = self.procedure
        after, carrier = self._make_epoch(old, own, part)
        carry_peaks(OnMesh.of(before), OnMesh.of(after), carrier)
        carried = after.state
        outcome = balance_new_mesh(after, may_yield=may_yield)
        if isinstance(outcome, Failed):
            raise GaveUpError(f"no equilibrium on the new mesh, {outcome.reason}")
        origin = carrier.material(self.mesh.points)
        keep_held(origin, after.model)
        seams = [seam for part_of in carrier.parts for seam in part_of.seams]
        jump = measure_jump(before.state, after.state)
        return NewEpoch(after, origin, jump, len(outcome.log), seams, carrier, carried, may_yield)

    def _make_epoch(self, old: Sequence[Any], own: set[int], part: float) -> tuple[ImplicitProcedure, Carrier]:
        """Return the procedure on new meshes of bodies, of a part of the size, with the state carried to them.

        Raises MeshError or GaveUpError.
        """
        before = self.procedure
        new = [
            make_on_lead(before.world, remesh_section, section, self._settings_of(i), part=part) if i in own else None
            for i, section in enumerate(old)
        ]
        position = before.model.mesh.points + before.state.nodes.displacement
        mesh, parts = join_sections(old, new)
        carrier = Carrier(before.model.mesh, position, mesh, parts)
        return carry_to_mesh(before, mesh, carrier), carrier

    def _epoch_arrays(self) -> NamedArrays:
        on_first = np.isin(np.arange(self._n_bodies), list(self._on_first))
        own = {WAITED: np.array([self._waited]), ON_FIRST: on_first}
        return super()._epoch_arrays() | own | self._seams.to_arrays()

    def _load_epoch(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        super()._load_epoch(epoch)
        self._seams.load_arrays(epoch)
        self._waited = int(epoch[WAITED][0])
        self._on_first = set(np.flatnonzero(epoch[ON_FIRST]).tolist())

    def _stay(self, reason: str, fault: str) -> bool:
        """Go on with the old mesh."""
        self._notes.append(f"not remeshed ({reason}): {fault}")
        self._made_at, self._stayed = self.number, True
        return False

    def show(self) -> Instant:
        """Return what the fields are computed from."""
        now = super().show()
        now.laps = mark_laps(self.procedure.state[LapArrays].mark, self._seams)
        now.initial_position = self.mesh.points
        return now

    def summary(self, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return what the summary tells, and how many meshes there were."""
        told = super().summary(history)
        procedure, marks = self.procedure, self.procedure.state[LapArrays]
        laps = find_laps(self.model.mesh, find_position(procedure), marks.mark, self._seams)
        warnings, places = tell_laps(laps, (marks.begun, self._seams.begun))
        told["warnings"] += warnings
        return told | {"remeshes": self.epoch, "laps": places}
