# SPDX-License-Identifier: Apache-2.0
"""Bodies in the plane in an implicit run: their sections where they are, why one needs a new mesh, and that mesh."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.geometry.pose import ToolPose, place_segments, shift_segments, start_centre, start_profile
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.bodies.body_surfaces import InterfaceArrays
from presswork.interaction.tool_arrays import ContactArrays, ToolArrays
from presswork.mesh.checks import MeshError
from presswork.mesh.joined import split_mesh
from presswork.model import Body, FloatArray, Remeshing, list_bodies, take_corners
from presswork.process.implicit.increments import IncrementRun
from presswork.process.implicit.lost_volume import LostVolume
from presswork.process.mesh_change.carrying import carry_to_mesh, find_undeclared
from presswork.process.mesh_change.mesh_reasons import (
    EARLY,
    find_reason,
    find_reason_to_leave_first,
    find_shares,
    find_tool_moves,
    will_land,
)
from presswork.process.mesh_change.new_epoch import join_sections, make_on_lead
from presswork.remesh.carrier import Carrier
from presswork.remesh.landing import find_closing
from presswork.remesh.old_section import OldSection, draw_outlines
from presswork.remesh.section import remesh_section
from presswork.remesh.section_sizes import check_budget
from presswork.remesh.size_field import measure_power

PARTS = (1.0, 0.7, 0.85, 0.6, 0.77)
"""Factors on the requested size, in meshes tried one after the other."""


class BodiesInPlane:
    """The bodies of a run in the plane or in axisymmetry, each of one block of cells."""

    parts: Sequence[float] = PARTS
    waits_first = False

    def __init__(self, run: IncrementRun, settings: Remeshing) -> None:
        self._run, self._settings = run, settings
        self._lost = LostVolume(run)

    def find_obstacle(self) -> str:
        """Return what prevents any new mesh; empty if nothing does."""
        undeclared = find_undeclared(self._run.procedure.state)
        if undeclared:
            return f"no rule carries {', '.join(undeclared)} to a new mesh"
        try:
            for number, section in enumerate(self.find()):
                if section.chains and not self._settings.keeps_first:
                    check_budget(section, self._settings_of(number))
        except MeshError as error:
            return str(error)
        return ""

    def find_reason(self, number: int, old: OldSection, wait: float, *, is_first: bool) -> str | None:
        """Return why a body needs a new mesh. wait: factor on the triggers; is_first: it has its first mesh."""
        old = old if wait == 1.0 else replace(old, closing=None)  # small cells where nodes land can wait
        if is_first:
            return find_reason_to_leave_first(old)
        state, settings = self._run.procedure.state, self._settings_of(number)
        own = state.nodes.increment[old.points.start : old.points.stop]
        if wait == 1.0 and will_land(old, state, self._run.model):
            return find_reason(old, own, settings, wait, early=EARLY)
        return find_reason(old, own, settings, wait)

    def note_meshes(self, bodies: set[int] | None, *, is_new: bool, is_refused: bool) -> None:
        """Note nothing: what is wrong with a mesh is seen on the next look."""

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return nothing."""
        return {}

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up nothing."""

    def _settings_of(self, number: int) -> Remeshing:
        """Return the sizes and triggers of a body."""
        bodies = self._run.model.bodies
        return self._settings.of_body(bodies[number].name) if bodies else self._settings

    def find(self) -> list[OldSection]:
        """Return the bodies where they are now."""
        run = self._run
        procedure, model, state = run.procedure, run.model, run.procedure.state
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
            for number, body in enumerate(
                list_bodies(model)
            ):  # where it touches itself it has folded: a lap may be closed
                if all(number not in c.between or c.slave == c.master for c in model.contacts):
                    on_others[body.points.start : body.points.stop] = False
            on_tool = np.concatenate([on_tool, on_others[None]])
        fixed = np.asarray(procedure.interactions.supports.fixed(procedure.present_step().stage))
        share = find_shares(state, fixed) * on_tool[: len(model.plane_tools)].any(axis=0)
        position = model.mesh.points + state.nodes.moved
        bodies, moved = list_bodies(model), state.nodes.increment[:, :2]
        before = [shift_segments(p, -move) for p, move in zip(profiles, find_tool_moves(state, model), strict=True)]
        outlines, outlines_then = (draw_outlines(model.mesh, bodies, at) for at in (position, position - moved))
        sections: list[OldSection] = []
        for number, (body, mesh) in enumerate(zip(bodies, split_mesh(model.mesh, bodies), strict=True)):
            own = slice(body.points.start, body.points.stop)
            ring, lost = model.analysis == "axisymmetric", self._lost.find(number)
            touched = sorted({i for c in model.contacts for i in c.between if number in c.between and i != number})
            others, others_then = ([o for i in touched for o in of[i]] for of in (outlines, outlines_then))
            closing = find_closing(position[own], moved[own], [*profiles, *others], [*before, *others_then])
            sections.append(
                OldSection(
                    mesh, position[own], on_tool[:, own], fixed[own], profiles, ring, body.points, lost,
                    self._find_power(body) if self._settings.error else None,
                    others=others, closing=closing, share=share[own],
                )
            )  # fmt: skip
        return sections

    def _find_power(self, body: Body) -> FloatArray | None:
        """Return the stress power over volume in the last increment, in each cell of a body (n_cells,) [MPa]."""
        state, mesh = self._run.procedure.state, self._run.model.mesh
        if not state.nodes.increment.any():
            return None
        cells = mesh.blocks[body.blocks.start].connectivity
        corners = take_corners(cells)
        stress = state.cells.stress[body.blocks.start].mean(axis=1)
        position = mesh.points + state.nodes.moved
        ring = self._run.model.analysis == "axisymmetric"
        return measure_power(position[corners], state.nodes.increment[corners], stress, ring=ring)

    def make(self, old: Sequence[OldSection], own: set[int], part: float) -> tuple[ImplicitProcedure, Carrier]:
        """Return the procedure on new meshes of bodies, of a part of the size, with the state carried to them.

        Raises MeshError or GaveUpError.
        """
        before = self._run.procedure
        new = [
            make_on_lead(before.world, remesh_section, section, self._settings_of(i), part=part) if i in own else None
            for i, section in enumerate(old)
        ]
        position = before.model.mesh.points + before.state.nodes.displacement
        mesh, parts = join_sections(old, new)
        carrier = Carrier(before.model.mesh, position, mesh, parts)
        return carry_to_mesh(before, mesh, carrier), carrier
