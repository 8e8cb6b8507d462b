# SPDX-License-Identifier: Apache-2.0
"""Explicit solids whose mesh changes in the run: where cells become flat, their time step collapses, or a row fails.

A new mesh begins where the old one is. Velocities are carried by moving least squares and shifted evenly, so that the
momentum stays; stress and history from point to point; the work of stress and of hourglass control in proportion to the
cells, so that their sums stay. The density is scaled so that the mass stays. Internal forces begin at zero for one
cycle: inside a body near equilibrium they balance each other.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork import _core
from presswork.evolution.of_material import BY_NAME
from presswork.explicit.energy import EnergyBalance
from presswork.explicit.input_checks import ExplicitError
from presswork.fields.instant import Instant
from presswork.geometry.pose import ToolPose, place_segments, start_profile
from presswork.mesh.checks import MeshError
from presswork.model import BoolArray, ElementName, FloatArray, Mesh, Model, Remeshing
from presswork.process.epochs import NamedArrays
from presswork.process.impact import ExplicitImpact
from presswork.process.laps import find_laps, mark_laps, tell_laps
from presswork.process.mesh_reasons import DUE, FAILS, STEP, find_cause, find_reason, find_reason_to_leave_first
from presswork.process.new_epoch import keep_held, make_on_lead
from presswork.process.recording import Row
from presswork.process.remeshing import MOST_GIVEN_BACK
from presswork.process.rows import RowReport
from presswork.process.seams import Seams
from presswork.ranks.world import World
from presswork.remesh.axes import straighten_axes
from presswork.remesh.carrier import Carrier, Part, SkinPlaces, SurfacePlaces
from presswork.remesh.section import OldSection, remesh_section
from presswork.remesh.size_field import measure_power
from presswork.threads import available_threads

COLLAPSED = 0.3
"""Stable step over that with which the mesh began, below which it is made anew."""
OF_THE_RUN = ("loop.work", "run.clock", "run.energy", "run.scales")
OF_A_WALL = ("offset", "angle", "floating", "impulse")
BEGIN_ANEW, KEPT = ("mass_factor", "hourglass", "force", "pressure"), "block_0.kept"
"""Names in a dump of explicit solids: what goes along, and what begins anew in cells."""
ELEMENT: ElementName = "quad4_1pt"
"""Of new meshes of triangles."""
NEAR = 0.02
"""Gap of a node that counts as on a tool, over the smallest size of cells."""


class RemeshedImpact(ExplicitImpact):
    """A solid in explicit dynamics, meshed anew where its mesh would fail."""

    def __init__(self, model: Model, *, threads: int = 0, world: World | None = None) -> None:
        assert model.remeshing is not None
        assert len(model.mesh.blocks) == 1
        self._remeshing: Remeshing = model.remeshing
        self._density = 1.0
        self._seams = Seams()
        self._notes: list[str] = []
        self._cause = 0
        self._threads = threads or available_threads()
        super().__init__(model, threads=threads, world=world)
        self._increment = np.zeros_like(model.mesh.points)
        self._first_volume = self._measure_volume()

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
        warnings, places = tell_laps(laps, (self._seams.begun,))
        told["warnings"] += warnings
        return told | {"remeshes": self.epoch, "laps": places}

    def _compute_row(self, number: int, row: int) -> tuple[int, float, EnergyBalance]:
        if (reason := self._find_reason(row)) is not None:
            self._remesh(reason)
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

    def _find_reason(self, row: int) -> str | None:
        """Return why the present mesh should not go on before a row of the stage."""
        if self._remeshing.keeps_first and self.epoch == 0:
            return self._find_reason_to_leave_first()
        rows = self._remeshing.every * self.model.output.rows
        if rows > 0.0 and row > 0 and int(row / rows + 1e-9) > int((row - 1) / rows + 1e-9):
            return DUE
        if self.solids.stable_step() < COLLAPSED * self.solids.first_step:
            return f"{STEP} {COLLAPSED:g} of that of the mesh at first"
        return self._find_wear()

    def _find_reason_to_leave_first(self) -> str | None:
        return find_reason_to_leave_first(self._find_section())

    def _find_wear(self) -> str | None:
        """Return why the body has outgrown its mesh."""
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

    def _find_loss(self) -> float:
        """Return the part of the volume that is lost and can be given back."""
        if self._pores is not None:  # they grow
            return 0.0
        return float(np.clip(self._first_volume / self._measure_volume() - 1.0, -MOST_GIVEN_BACK, MOST_GIVEN_BACK))

    def _make_mesh(self) -> tuple[Mesh, SurfacePlaces | SkinPlaces, Sequence[FloatArray]]:
        """Return a new mesh, where its surface lies on the old one, and lines where folds were left out.

        Raises MeshError.
        """
        new = make_on_lead(self._world, remesh_section, self._find_section(), self._remeshing)
        return new.mesh, new.surface(0, 0), new.line.seams

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
        for support in self.model.supports:
            held[self.model.mesh.node_sets[support.node_set]] |= np.asarray(support.fix[:d])
        return held

    def _remesh(self, reason: str, *, failed: bool = False) -> bool:
        """Go on with a new mesh, or with the old one where none can be made; return whether there is one.

        failed: the row has failed on the old one.
        """
        position, first = self.solids.position, range(len(self.model.mesh.points))
        try:
            mesh, surface, lines = self._make_mesh()
        except MeshError as error:
            self._notes.append(f"not remeshed ({reason}): {error}")
            return False
        carrier = Carrier(self.model.mesh, position, mesh, [Part(first, range(len(mesh.points)), 0, surface)])
        before, dump, volumes = self.solids, self.solids.dump_as_given(), self._find_volumes()
        evolved, heat = self.points.values, self.heat
        origin, places = carrier.material(self.mesh.points), self.marked.places(position)
        seams = self._seams.places(position)
        self._begin_epoch(mesh, origin)
        keep_held(origin, self.model)
        self._increment = np.zeros_like(mesh.points)
        self._make_run(self._epoch_arrays())
        self._density *= before.added_mass().mass / self.solids.added_mass().mass
        self._make_run(self._epoch_arrays())
        self._begin_stage()
        kept = self.solids.mass.sum() / before.mass.sum()  # added mass is not carried, nor the momentum that it has
        self.solids.restore_as_given(self._carry(dump, carrier, volumes, kept * (before.mass @ before.velocity)))
        if heat is not None and self.heat is not None:
            self.heat.carry(heat, carrier)
        self.points.carry(evolved, lambda values: _carry_cells(carrier, values, self.solids.stress))
        self.marked.find(mesh, mesh.points, places)
        self._seams.go_on(mesh, seams, lines, before.time)
        self._cause = find_cause(FAILS if failed else reason)
        gained = _kinetic_energy(self.solids) / max(_kinetic_energy(before), 1e-300) - 1.0
        self._notes.append(
            f"remesh {self.epoch} ({reason}): {len(self.solids.stress)} cells, stable step "
            f"{self.solids.stable_step():.3g} s, kinetic energy {gained:+.2%}, volume "
            f"{self._measure_volume() / self._first_volume - 1.0:+.2e} of the first"
        )
        return True

    def _carry(
        self, dump: Mapping[str, FloatArray], carrier: Carrier, volumes: FloatArray, momentum: FloatArray
    ) -> dict[str, FloatArray]:
        """Return the state of the present mesh out of that of the old one.

        volumes: of the old cells (n_cells,) [mm3]; momentum: of the old nodes (2,) [t mm/s].
        """
        found: dict[str, FloatArray] = self.solids.dump_as_given()
        for name, given in dump.items():
            owner, _, what = name.partition(".")
            if name in OF_THE_RUN or (owner.startswith("wall_") and what in OF_A_WALL):
                found[name] = given
            elif owner.startswith("block_") and what == "work":
                density = _carry_cells(carrier, given / volumes[:, None], self.solids.stress)
                work = density * self._find_volumes()[:, None]
                found[name] = work * given.sum(axis=0) / np.where(work.sum(axis=0) == 0.0, 1.0, work.sum(axis=0))
            elif owner.startswith("block_") and what not in BEGIN_ANEW:
                found[name] = _carry_cells(carrier, given, self.solids.stress)
                if given.size and _has_peaks(what):
                    found[name] = keep_peaks(carrier, name, given, found[name], self._find_volumes())
        self._mend(carrier, dump, found)
        found["nodes.velocity"] = self._carry_velocity(carrier.nodes(dump["nodes.velocity"]), momentum)
        return found

    def _mend(self, carrier: Carrier, dump: Mapping[str, FloatArray], found: dict[str, FloatArray]) -> None:
        """Give carried values of laws (found) the form that laws need."""
        material = self.model.materials[self.model.mesh.blocks[0].material]
        if (kept := found[KEPT]).size and material.umat is None:  # the last two are the direction of the law's axes
            kept[:, -2:] = straighten_axes(kept[:, -2:])

    def _carry_velocity(self, velocity: FloatArray, momentum: FloatArray) -> FloatArray:
        """Return carried velocities (n_points, ...) with the momentum (d,) of the old ones, across an axis none."""
        mass, free = self.solids.mass, ~self._find_held()
        moved = velocity[:, : len(momentum)]
        lacking = momentum - mass @ moved
        lacking[0] *= self.model.analysis != "axisymmetric"
        moved += free * lacking / np.maximum(mass @ free, 1e-300)
        return velocity

    def _epoch_arrays(self) -> NamedArrays:
        kept = {"density": np.array(self._density), "increment": self._increment}
        return kept | self.marked.to_arrays() | self._seams.to_arrays()

    def _load_epoch(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        self._increment = np.array(epoch["increment"], dtype=float)
        self.marked.load_arrays(epoch)
        self._seams.load_arrays(epoch)

    def _make_run(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        self._density = float(epoch.get("density", 1.0))
        super()._make_run(epoch)
        if epoch:
            self.heat = self.heat and self._make_heat(self._threads)
            self.points.start(self._find_points())

    def _find_volumes(self) -> FloatArray:
        """Return the volume of each cell (n_cells,) [mm3]; of 1 rad, or 1 mm of depth."""
        x, y = np.moveaxis(self.solids.position[self.model.mesh.blocks[0].connectivity], -1, 0)
        area = 0.5 * (x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1)
        return np.asarray(area * (x.mean(axis=1) if self.model.analysis == "axisymmetric" else 1.0))

    def _measure_volume(self) -> float:
        """Return the volume without its elastic part, in the unit of _find_volumes."""
        material = self.model.materials[self.model.mesh.blocks[0].material]
        dilatation = self.solids.stress[:, :3].sum(axis=1) * (1.0 - 2.0 * material.poisson) / material.young
        return float((self._find_volumes() * np.exp(-dilatation)).sum())


def _carry_cells(carrier: Carrier, values: FloatArray, stress: FloatArray) -> FloatArray:
    """Return values of old cells (n, ...), one point each, in the new ones, of which stress (n_cells, 4) are some."""
    if not values.size:
        return np.zeros((len(stress), *values.shape[1:]))
    (found,) = carrier.points([values[:, None]], [np.zeros((len(stress), 1, *values.shape[1:]))])
    return found[:, 0]


def _has_peaks(name: str) -> bool:
    """Say whether the largest value of an array of cells in a dump decides: plastic strain, damage."""
    quantity = BY_NAME.get(name.removeprefix("damage_"))
    return name == "eqps" or (quantity is not None and quantity.peak_counts)


def keep_peaks(carrier: Carrier, name: str, values: FloatArray, found: FloatArray, volumes: FloatArray) -> FloatArray:
    """Return a field carried by _carry_cells from values of old cells (n, ...) with the peaks that it had."""
    shape = found.shape
    (kept,) = carrier.peaks(name, [values.reshape(-1, 1)], [found.reshape(-1, 1)], [volumes[:, None]])
    return kept.reshape(shape)


def _kinetic_energy(solids: Any) -> float:
    """Return the kinetic energy of the nodes, half a step back [N mm]."""
    return 0.5 * float(solids.mass @ (solids.velocity**2).sum(axis=1))
