# SPDX-License-Identifier: Apache-2.0
"""Explicit solids whose mesh changes in the run: where cells become flat, their time step collapses, or a row fails.

A new mesh begins where the old one is. Velocities are carried by moving least squares and shifted evenly, so that the
momentum stays; stress and history from point to point; the work of stress and of hourglass control in proportion to the
cells, so that their sums stay. What was added to the mass is dropped first; the density is scaled so that the rest
stays. Internal forces begin at zero for one cycle: inside a body near equilibrium they balance each other.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork import _core
from presswork.evolution.points import EvolvedArrays
from presswork.explicit.arrays import MotionArrays
from presswork.explicit.energy import EnergyBalance
from presswork.explicit.input_checks import ExplicitError
from presswork.fields.instant import Instant
from presswork.geometry.pose import ToolPose, place_segments, start_profile
from presswork.mesh.checks import MeshError
from presswork.model import BoolArray, ElementName, FloatArray, Mesh, Model, Remeshing, list_bodies
from presswork.observe.contract import Row
from presswork.process.explicit.impact import ExplicitImpact
from presswork.process.explicit.rows import RowReport
from presswork.process.implicit.lost_volume import MOST_GIVEN_BACK
from presswork.process.mesh_change.carrying import OnMesh, carry_peaks, carry_state, carry_surface
from presswork.process.mesh_change.contacts_on_new_mesh import find_rows, turn_impulses
from presswork.process.mesh_change.laps import explain_laps, find_laps, list_laps, mark_laps
from presswork.process.mesh_change.mesh_reasons import (
    DUE,
    FAILS,
    STEP,
    find_cause,
    find_reason,
    find_reason_to_leave_first,
)
from presswork.process.mesh_change.new_epoch import keep_held, make_on_lead
from presswork.process.mesh_change.seams import Seams
from presswork.process.model_recording import NamedArrays
from presswork.ranks.world import World
from presswork.remesh.carrier import Carrier, Part
from presswork.remesh.section import OldSection, remesh_section
from presswork.remesh.size_field import measure_power
from presswork.threads import available_threads

COLLAPSED = 0.3
"""Stable step over that with which the mesh began, below which it is made anew."""
ON_FIRST = "on_first"
"""Name in a checkpoint."""
ELEMENT: ElementName = "quad4_1pt"
"""Of new meshes of triangles."""
NEAR = 0.02
"""Gap of a node that counts as on a tool, over the smallest size of cells."""


@dataclass(frozen=True)
class MadeMesh:
    """A mesh on which some bodies have new cells, and others those that they had."""

    mesh: Mesh
    """Its points where those of each body were when its mesh began: of a new one, where they are now."""
    position: FloatArray
    """Where its nodes are now (n_points, d) [mm]."""
    parts: Sequence[Part]
    """What becomes of each body."""
    faults: Sequence[str] = ()
    """Why bodies that were to get new cells have none."""

    @property
    def lines(self) -> list[FloatArray]:
        """At which folds were left out."""
        return [seam for part in self.parts for seam in part.seams]

    @property
    def is_new(self) -> list[bool]:
        """Which bodies have new cells."""
        return [part.surface is not None for part in self.parts]


class RemeshedImpact(ExplicitImpact):
    """A solid in explicit dynamics, meshed anew where its mesh would fail."""

    def __init__(self, model: Model, *, threads: int = 0, world: World | None = None) -> None:
        assert model.remeshing is not None
        self._remeshing: Remeshing = model.remeshing
        self._n_bodies = len(list_bodies(model))
        self._density = np.ones(self._n_bodies)
        """Factor on the density of each body, so that its mass stays."""
        self._on_first = set(range(self._n_bodies)) if model.remeshing.keeps_first else set()
        """Bodies whose first mesh is to stay until it fails."""
        self._seams = Seams()
        self._notes: list[str] = []
        self._cause = 0
        self._threads = threads or available_threads()
        super().__init__(model, threads=threads, world=world)
        self._increment = np.zeros_like(model.mesh.points)
        self._first_volumes = self._measure_bodies()

    @property
    def columns(self) -> list[str]:
        """Of history.csv."""
        return [*super().columns, "cells", "remeshes", "remesh_cause"]

    def row(self, report: RowReport) -> Row:
        """Return the row of the history."""
        cause, self._cause = self._cause, 0
        meshes = {"cells": len(self.solids.stress), "remeshes": self.epoch, "remesh_cause": cause}
        return super().row(report) | meshes

    def log_lines(self, report: RowReport) -> list[str]:
        """Say where the row ended, and which meshes there were in it."""
        notes, self._notes = self._notes, []
        return [*notes, *super().log_lines(report)]

    def show(self) -> Instant:
        """Return what the fields of the present state are computed from."""
        now = super().show()
        now.initial_position = self.mesh.points
        now.laps = mark_laps(np.zeros(len(self.mesh.points)), self._seams)
        return now

    def summary(self, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return what the summary tells, and how many meshes there were."""
        told, mesh = super().summary(history), self.model.mesh
        laps = find_laps(mesh, self.solids.position, np.zeros(len(mesh.points)), self._seams)
        told["warnings"] += explain_laps(laps, (self._seams.begun,))
        return told | {"remeshes": self.epoch, "laps": list_laps(laps)}

    def _compute_row(self, number: int, row: int) -> tuple[int, float, EnergyBalance]:
        if (found_reason := self._find_reason(row)) is not None:
            self._remesh(*found_reason)
        before, start = self.to_arrays(), self.solids.position
        try:
            found = super()._compute_row(number, row)
        except ExplicitError as error:
            self.load_arrays(before)
            if not self._remesh(str(error).partition(":")[0], failed=True):
                raise
            start = self.solids.position
            found = super()._compute_row(number, row)
        self._increment = self.solids.position - start
        return found

    # --- new meshes --------------------------------------------------------------------------------------------------

    def _find_reason(self, row: int) -> tuple[str, set[int]] | None:
        """Return why present meshes should not go on before a row of the stage, and of which bodies."""
        rows, bodies = self._remeshing.every * self.model.output.rows, set(range(self._n_bodies))
        if rows > 0.0 and row > 0 and int(row / rows + 1e-9) > int((row - 1) / rows + 1e-9):
            return DUE, bodies
        least = COLLAPSED * self.solids.first_step
        if self._on_first != bodies and self.solids.stable_step() < least:
            steps = [2.0 / np.sqrt(own.max()) for own in self._split(self.solids.bound_frequencies())]
            collapsed = {number for number, step in enumerate(steps) if step < least} - self._on_first
            if collapsed:
                return f"{STEP} {COLLAPSED:g} of that of the mesh at first", collapsed
        found = {number: reason for number in sorted(bodies) if (reason := self._find_reason_of(number)) is not None}
        return ("; ".join(dict.fromkeys(found.values())), set(found)) if found else None

    def _find_reason_of(self, number: int) -> str | None:
        """Return why a body should not go on with its mesh."""
        if number in self._on_first:
            return find_reason_to_leave_first(self._find_section())
        return find_reason(self._find_section(), self._increment, self._remeshing, wait=1.0)

    def _find_section(self) -> OldSection:
        """Return the body where it is now."""
        mesh, position = self.model.mesh, self.solids.position
        profiles = [
            place_segments(start_profile(tool), ToolPose(np.zeros(2), wall.displacement, 0.0))
            for tool, wall in zip(self.model.tools, self.walls, strict=True)
        ]
        gaps = [_core.touch_profile(profile, np.ascontiguousarray(position))[0] for profile in profiles]
        near = NEAR * self._remeshing.smallest_size
        on_tool = np.abs(np.array(gaps).reshape(len(profiles), len(position))) < near
        on_tool &= np.isin(np.arange(len(position)), mesh.boundary_edges)
        ring = self.model.analysis == "axisymmetric"
        lost, power = self._find_loss(), self._find_power()
        return OldSection(
            mesh, position, on_tool, self._find_held(), profiles, ring, range(len(position)), lost, power, ELEMENT
        )

    def _find_loss(self, number: int = 0) -> float:
        """Return the part of a body's volume that is lost and can be given back."""
        if self._pores is not None:  # they grow
            return 0.0
        lost = self._first_volumes[number] / self._measure_bodies()[number] - 1.0
        return float(np.clip(lost, -MOST_GIVEN_BACK, MOST_GIVEN_BACK))

    def _make_mesh(self, bodies: set[int]) -> MadeMesh:
        """Return a mesh on which bodies have new cells. Raises MeshError where none can be made."""
        new = make_on_lead(self._world, remesh_section, self._find_section(), self._remeshing)
        points = range(len(self.model.mesh.points)), range(len(new.mesh.points))
        return MadeMesh(new.mesh, new.mesh.points, [Part(*points, 0, new.surface(0, 0), new.line.seams)])

    def _find_power(self) -> FloatArray | None:
        """Return the stress power over volume in the last row, in each cell (n_cells,) [MPa]; None: nothing moved."""
        if not self._remeshing.error or not self._increment.any():
            return None
        cells, ring = self.model.mesh.blocks[0].connectivity, self.model.analysis == "axisymmetric"
        return measure_power(self.solids.position[cells], self._increment[cells], self.solids.stress, ring=ring)

    def _find_held(self) -> BoolArray:
        """Mark the components that supports hold (n_points, d)."""
        d = self.model.dimension
        held = np.zeros((len(self.model.mesh.points), d), dtype=bool)
        for support in self.model.supports_in(min(self._progress.stage, len(self.model.stages) - 1)):
            held[self.model.mesh.node_sets[support.node_set]] |= np.asarray(support.fix[:d])
        return held

    def _remesh(self, reason: str, bodies: set[int] | None = None, *, failed: bool = False) -> bool:
        """Go on with new meshes of bodies (None: of all), or with the old ones where none can be made; return whether
        there are any.

        failed: the row has failed on the old ones.
        """
        old, position, origin_n = self.model, self.solids.position, self.mesh.points
        try:
            made = self._make_mesh(set(range(self._n_bodies)) if bodies is None else bodies)
        except MeshError as error:
            self._notes.append(f"not remeshed ({reason}): {error}")
            return False
        lying = replace(made.mesh, points=made.position)
        carrier = Carrier(old.mesh, position, lying, made.parts)
        before, heat = self.solids, self.heat
        blocks = zip(old.mesh.blocks, made.is_new, strict=True)
        before.drop_added_mass(np.concatenate([np.full(len(block.connectivity), is_new) for block, is_new in blocks]))
        masses, on_old = self._measure_masses(), self._find_on_mesh(position)
        places, seams = self.marked.places(position), self._seams.places(position)
        origin = carrier.material(origin_n)
        increment = np.where(carrier.is_new()[:, None], 0.0, carrier.motion(self._increment))
        means = [before.mass[own] @ before.velocity[own] / before.mass[own].sum() for own in self._list_nodes()]
        self.begin_epoch(made.mesh, origin)
        keep_held(origin, self.model)
        self._increment = increment
        self.make_run(self._epoch_arrays())
        self._density = np.where(made.is_new, self._density * masses / self._measure_masses(), self._density)
        self.make_run(self._epoch_arrays())
        self._begin_stage()
        self._carry(on_old, self._find_on_mesh(made.position), carrier, means)
        if heat is not None and self.heat is not None:
            self.heat.go_on(heat, carrier)
        self.marked.go_on(lying, made.parts, places)
        self._seams.go_on(lying, seams, made.lines, before.time)
        self._on_first -= {number for number, is_new in enumerate(made.is_new) if is_new}
        self._cause = find_cause(FAILS if failed else reason)
        self._note_new_mesh(reason, made, before)
        return True

    def _note_new_mesh(self, reason: str, made: MadeMesh, before: Any) -> None:
        """Say in the log what has come of a new mesh; before: the run on the old one."""
        gained = _kinetic_energy(self.solids) / max(_kinetic_energy(before), 1e-300) - 1.0
        named = [body.name for body, is_new in zip(self.model.bodies, made.is_new, strict=False) if is_new]
        of_bodies = f" of {' and '.join(named)}" if len(self.model.bodies) > 1 else ""
        volume = sum(self._measure_bodies()) / sum(self._first_volumes) - 1.0
        self._notes += [f"not remeshed ({reason}): {fault}" for fault in made.faults]
        self._notes.append(
            f"remesh {self.epoch}{of_bodies} ({reason}): {len(self.solids.stress)} cells, stable step "
            f"{self.solids.stable_step():.3g} s, kinetic energy {gained:+.2%}, volume {volume:+.2e} of the first"
        )

    def _find_on_mesh(self, position: FloatArray) -> OnMesh:
        """Return the state on the present mesh, whose nodes are at positions (n_points, d) [mm]."""
        state, volumes = self.solids.state_as_given(), [volume[:, None] for volume in self._find_volumes()]
        state.add(EvolvedArrays(self.points.values), *([self.heat.arrays] if self.heat else []))
        return OnMesh(self.model, state, position, volumes, partial(find_rows, self.contacts.added))

    def _carry(self, old: OnMesh, new: OnMesh, carrier: Carrier, means: Sequence[FloatArray]) -> None:
        """Begin on the present mesh with the state of the old one; means: velocity of each body (d,) [mm/s]."""
        new.state.take_over(old.state)
        carry_state(old, new, carrier)
        carry_surface(old, new, carrier)
        carry_peaks(old, new, carrier)
        turn_impulses(new.state, old.model, new.model)
        self._keep_momentum(carrier, new.state[MotionArrays].velocity, means)
        self.solids.take_state_as_given(new.state)
        self.points.values = new.state[EvolvedArrays].values

    def _keep_momentum(self, carrier: Carrier, velocity: FloatArray, means: Sequence[FloatArray]) -> None:
        """Give carried velocities (n_points, ...) of bodies with a new mesh the means (d,) that they had, in place."""
        free = ~self._find_held()
        for part, own, mean in zip(carrier.parts, self._list_nodes(), means, strict=True):
            if part.surface is None:
                continue
            mass, moved = self.solids.mass[own], velocity[own, : len(mean)]  # a view
            lacking = mass.sum() * mean - mass @ moved
            lacking[0] *= self.model.analysis != "axisymmetric"  # across an axis there is none
            moved += free[own] * lacking / np.maximum(mass @ free[own], 1e-300)

    def _list_nodes(self) -> list[slice]:
        """Return the nodes of each body."""
        return [slice(body.points.start, body.points.stop) for body in list_bodies(self.model)]

    def _measure_masses(self) -> FloatArray:
        """Return the mass of each body without what was added (n_bodies,) [t]."""
        return np.array([own.sum() for own in self._split(self.solids.true_mass)])

    def _epoch_arrays(self) -> NamedArrays:
        on_first = np.isin(np.arange(self._n_bodies), list(self._on_first))
        kept = {"density": self._density, "increment": self._increment, ON_FIRST: on_first}
        return super()._epoch_arrays() | kept | self._seams.to_arrays()

    def _load_epoch(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        self._increment = np.array(epoch["increment"], dtype=float)
        self._on_first = set(np.flatnonzero(epoch[ON_FIRST]).tolist())
        super()._load_epoch(epoch)
        self._seams.load_arrays(epoch)

    def make_run(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        self._density = np.array(epoch.get("density", np.ones(self._n_bodies)), dtype=float)
        super().make_run(epoch)
        if epoch:
            self.heat = self.heat and self._make_heat(self._threads)
            self.points.start(self._find_points())

    def _find_volumes(self) -> list[FloatArray]:
        """Return the volume of each cell of each block (n_cells,) [mm3]; of 1 rad, or 1 mm of depth."""
        x, y = np.moveaxis(self.solids.position[self.model.mesh.blocks[0].connectivity], -1, 0)
        area = 0.5 * (x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1)
        return [np.asarray(area * (x.mean(axis=1) if self.model.analysis == "axisymmetric" else 1.0))]

    def _measure_bodies(self) -> list[float]:
        """Return the volume of each body without its elastic part, in the unit of _find_volumes."""
        mesh, found = self.model.mesh, []
        for block, volume, stress in zip(
            mesh.blocks, self._find_volumes(), self._split(self.solids.stress), strict=True
        ):
            material = self.model.materials[block.material]
            dilatation = stress[:, :3].sum(axis=1) * (1.0 - 2.0 * material.poisson) / material.young
            found.append(float((volume * np.exp(-dilatation)).sum()))
        return found


def _kinetic_energy(solids: Any) -> float:
    """Return the kinetic energy of the nodes, half a step back [N mm]."""
    return 0.5 * float(solids.mass @ (solids.velocity**2).sum(axis=1))
