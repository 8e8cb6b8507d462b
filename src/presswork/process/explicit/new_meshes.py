# SPDX-License-Identifier: Apache-2.0
"""New meshes in an explicit run: where cells become flat, their time step collapses, or a row fails.

A new mesh begins where the old one is. Velocities are carried by moving least squares and shifted evenly, so that the
momentum stays; stress and history from point to point; the work of stress and of hourglass control in proportion to the
cells, so that their sums stay. What was added to the mass is dropped first; the density is scaled so that the rest
stays. Internal forces begin at zero for one cycle: inside a body near equilibrium they balance each other.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from presswork.evolution.points import EvolvedArrays
from presswork.explicit.arrays import MotionArrays
from presswork.fields.instant import Instant
from presswork.mesh.checks import MeshError
from presswork.model import FloatArray, Mesh, Remeshing, list_bodies
from presswork.observe.contract import History, Observed, Row
from presswork.observe.marked_points import find_marked
from presswork.outcome import StartError
from presswork.process.explicit.forming import ExplicitForming
from presswork.process.explicit.present_bodies import find_held, list_nodes
from presswork.process.explicit.solid_domain import Solids
from presswork.process.mesh_change.carrying import OnMesh, carry_peaks, carry_state, carry_surface
from presswork.process.mesh_change.contacts_on_new_mesh import find_rows, turn_impulses
from presswork.process.mesh_change.contract import MeshChange
from presswork.process.mesh_change.laps import Lap, explain_laps, find_laps, list_laps, mark_laps
from presswork.process.mesh_change.mesh_reasons import DUE, FAILS, STEP, find_cause
from presswork.process.mesh_change.new_epoch import keep_held
from presswork.process.mesh_change.seams import Seams
from presswork.remesh.carrier import Carrier, Part

Old = TypeVar("Old")
"""A body as it is when it gets a new mesh."""
COLLAPSED = 0.3
"""Stable step over that with which the mesh began, below which it is made anew."""
ON_FIRST = "on_first"
"""Name in a checkpoint."""


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
        """Return the lines at which folds were left out."""
        return [seam for part in self.parts for seam in part.seams]

    @property
    def is_new(self) -> list[bool]:
        """Which bodies have new cells."""
        return [part.surface is not None for part in self.parts]


class MovingBodies(Protocol[Old]):
    """The bodies of an explicit run, in the plane or in space, as new meshes are made of them."""

    def find_obstacle(self) -> str:
        """Return what prevents any new mesh; empty if nothing does."""

    def find(self, increment: FloatArray) -> Sequence[Old]:
        """Return the bodies where they are now; increment: what the last row has moved the nodes by (n_points, d)."""

    def find_reason(self, number: int, old: Old, increment: FloatArray, *, is_first: bool) -> str | None:
        """Return why a body needs a new mesh; is_first: it has its first mesh."""

    def make(self, bodies: set[int], increment: FloatArray, density: FloatArray) -> MadeMesh:
        """Return a mesh on which bodies have new cells; density: factor on that of each. Raises MeshError."""

    def find_volumes(self) -> list[FloatArray]:
        """Return the volume of each cell of each block (n_cells,) [mm3]; of 1 rad, or 1 mm of depth."""

    def measure(self) -> list[float]:
        """Return the volume of each body without its elastic part, in the unit of find_volumes."""

    def note_meshes(self, is_new: Sequence[bool]) -> None:
        """Note what is wrong with the meshes of bodies that have new ones."""

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return what a checkpoint keeps."""

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what `arrays` gave."""


class IntervalMeshes(MeshChange, Generic[Old]):
    """Makes a new mesh of each body where its mesh would fail."""

    def __init__(self, run: ExplicitForming, bodies: MovingBodies[Old]) -> None:
        """Raises StartError where no mesh can be made."""
        assert run.model.remeshing is not None
        self._run, self.bodies = run, bodies
        self._settings: Remeshing = run.model.remeshing
        self._obstacle = bodies.find_obstacle()
        if self._obstacle and not self._settings.keeps_first:
            raise StartError(f"{self._obstacle}: leave out [remesh]")
        self._n_bodies = len(list_bodies(run.model))
        self._density = np.ones(self._n_bodies)
        """Factor on the density of each body, so that its mass stays."""
        self._on_first = set(range(self._n_bodies)) if self._settings.keeps_first else set()
        """Bodies whose first mesh is to stay until it fails."""
        self._seams = Seams()
        self._cause, self._changed_at = 0, -1
        """Why the present mesh was made, and after which row."""
        self._increment = np.zeros_like(run.model.mesh.points)
        """What the last row has moved the nodes by [mm]."""
        self._start = run.positions()
        self.first_volumes = bodies.measure()

    # --- its reports -------------------------------------------------------------------------------------------------

    def columns(self, run: Observed) -> list[str]:
        """Return the number of cells and of meshes, and why the present one was made."""
        return ["cells", "remeshes", "remesh_cause"]

    def row(self, run: Observed, *, is_released: bool = False) -> Row:
        """Return the values of its columns; the cause in the first row on a mesh."""
        cause = self._cause if run.number == self._changed_at + 1 else 0
        return {"cells": len(self._run.solids.stress), "remeshes": run.epoch, "remesh_cause": cause}

    def begin_log(self) -> str:
        """Return what prevents new meshes."""
        return f"; no new meshes: {self._obstacle}" if self._obstacle else ""

    def show(self, run: Observed, now: Instant) -> None:
        """Add laps, and where the material was when the run began."""
        points = self._run.mesh.points
        now.initial_position = points
        now.laps = mark_laps(np.zeros(len(points)), self._seams)

    def summary(self, run: Observed, history: History) -> dict[str, Any]:
        """Return how many meshes there were, and the laps."""
        return {"remeshes": run.epoch, "laps": list_laps(self._find_laps())}

    def warnings(self, run: Observed, history: History) -> list[str]:
        """Return the laps."""
        return explain_laps(self._find_laps(), (self._seams.begun,))

    def _find_laps(self) -> list[Lap]:
        mesh = self._run.model.mesh
        return find_laps(mesh, self._run.positions(), np.zeros(len(mesh.points)), self._seams)

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return densities, the last motion, which first meshes stay, and the seams."""
        on_first = np.isin(np.arange(self._n_bodies), list(self._on_first))
        kept = {"density": self._density, "increment": self._increment, ON_FIRST: on_first}
        return kept | self._seams.to_arrays() | self.bodies.arrays()

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what `arrays` gave."""
        self._density = np.array(arrays["density"], dtype=float)
        self._increment = np.array(arrays["increment"], dtype=float)
        self._on_first = set(np.flatnonzero(arrays[ON_FIRST]).tolist())
        self._seams.load_arrays(arrays)
        self.bodies.load_arrays(arrays)

    # --- when --------------------------------------------------------------------------------------------------------

    def look(self, failure: str = "") -> bool:
        """Make another mesh if the present one should not go on, and go on with it; return whether there is one."""
        is_new = False
        if self._obstacle:
            pass
        elif failure:
            is_new = self.remesh(failure.partition(":")[0], failed=True)
        elif (found := self._find_reason()) is not None:
            is_new = self.remesh(*found)
        self._start = self._run.positions()
        return is_new

    def end_step(self) -> None:
        """Note what the row has moved the nodes by."""
        self._increment = self._run.positions() - self._start

    def _find_reason(self) -> tuple[str, set[int]] | None:
        """Return why present meshes should not go on before the next row, and of which bodies."""
        run, row = self._run, self._run.row_of_stage
        rows, bodies = self._settings.every * run.model.output.rows, set(range(self._n_bodies))
        if rows > 0.0 and row > 0 and int(row / rows + 1e-9) > int((row - 1) / rows + 1e-9):
            return DUE, bodies
        least = COLLAPSED * run.solids.first_step
        if self._on_first != bodies and run.solids.stable_step() < least:
            steps = [2.0 / np.sqrt(own.max()) for own in run.split(run.solids.bound_frequencies())]
            collapsed = {number for number, step in enumerate(steps) if step < least} - self._on_first
            if collapsed:
                return f"{STEP} {COLLAPSED:g} of that of the mesh at first", collapsed
        found: dict[int, str] = {}
        for number, old in enumerate(self.bodies.find(self._increment)):
            reason = self.bodies.find_reason(number, old, self._increment, is_first=number in self._on_first)
            if reason is not None:
                found[number] = reason
        return ("; ".join(dict.fromkeys(found.values())), set(found)) if found else None

    # --- how ---------------------------------------------------------------------------------------------------------

    def remesh(self, reason: str, bodies: set[int] | None = None, *, failed: bool = False) -> bool:
        """Go on with new meshes of bodies (None: of all), or with the old ones where none can be made; return whether
        there are any.

        failed: the row has failed on the old ones.
        """
        run = self._run
        old, position, origin_n = run.model, run.positions(), run.mesh.points
        try:
            made = self.bodies.make(bodies or set(range(self._n_bodies)), self._increment, self._density)
        except MeshError as error:
            run.notes.append(f"not remeshed ({reason}): {error}")
            return False
        lying = replace(made.mesh, points=made.position)
        carrier = Carrier(old.mesh, position, lying, made.parts)
        before, heat = run.solids, run.heat
        blocks = zip(old.mesh.blocks, made.is_new, strict=True)
        before.drop_added_mass(np.concatenate([np.full(len(block.connectivity), is_new) for block, is_new in blocks]))
        masses, on_old = self._measure_masses(), self._find_on_mesh(position)
        places, seams = find_marked(run).places(position), self._seams.places(position)
        origin = carrier.material(origin_n)
        increment = np.where(carrier.is_new()[:, None], 0.0, carrier.motion(self._increment))
        means = [before.mass[own] @ before.velocity[own] / before.mass[own].sum() for own in list_nodes(run)]
        run.begin_epoch(made.mesh, origin)
        keep_held(origin, run.model)
        self._increment = increment
        run.make_run(self.arrays())
        self._density = np.where(made.is_new, self._density * masses / self._measure_masses(), self._density)
        run.make_run(self.arrays())
        run.begin_stage()
        self._carry(on_old, self._find_on_mesh(made.position), carrier, means)
        if heat is not None and run.heat is not None:
            run.heat.go_on(heat, carrier)
        find_marked(run).go_on(lying, made.parts, places)
        self._seams.go_on(lying, seams, made.lines, before.time)
        self._on_first -= {number for number, is_new in enumerate(made.is_new) if is_new}
        self._cause, self._changed_at = find_cause(FAILS if failed else reason), run.number
        self._note_new_mesh(reason, made, before)
        self.bodies.note_meshes(made.is_new)
        return True

    def _note_new_mesh(self, reason: str, made: MadeMesh, before: Solids) -> None:
        """Log the outcome of a new mesh; before: the run on the old one."""
        run = self._run
        gained = _kinetic_energy(run.solids) / max(_kinetic_energy(before), 1e-300) - 1.0
        named = [body.name for body, is_new in zip(run.model.bodies, made.is_new, strict=False) if is_new]
        of_bodies = f" of {' and '.join(named)}" if len(run.model.bodies) > 1 else ""
        volume = sum(self.bodies.measure()) / sum(self.first_volumes) - 1.0
        run.notes += [f"not remeshed ({reason}): {fault}" for fault in made.faults]
        run.notes.append(
            f"remesh {run.epoch}{of_bodies} ({reason}): {len(run.solids.stress)} cells, stable step "
            f"{run.solids.stable_step():.3g} s, kinetic energy {gained:+.2%}, volume {volume:+.2e} of the first"
        )

    def _find_on_mesh(self, position: FloatArray) -> OnMesh:
        """Return the state on the present mesh, whose nodes are at positions (n_points, d) [mm]."""
        run = self._run
        state, volumes = run.solids.state_as_given(), [volume[:, None] for volume in self.bodies.find_volumes()]
        state.add(EvolvedArrays(run.points.values), *([run.heat.arrays] if run.heat else []))
        return OnMesh(run.model, state, position, volumes, partial(find_rows, run.contacts.added))

    def _carry(self, old: OnMesh, new: OnMesh, carrier: Carrier, means: Sequence[FloatArray]) -> None:
        """Begin on the present mesh with the state of the old one; means: velocity of each body (d,) [mm/s]."""
        new.state.take_over(old.state)
        carry_state(old, new, carrier)
        carry_surface(old, new, carrier)
        carry_peaks(old, new, carrier)
        turn_impulses(new.state, old.model, new.model)
        self._keep_momentum(carrier, new.state[MotionArrays].velocity, means)
        self._run.solids.take_state_as_given(new.state)
        self._run.points.values = new.state[EvolvedArrays].values

    def _keep_momentum(self, carrier: Carrier, velocity: FloatArray, means: Sequence[FloatArray]) -> None:
        """Give carried velocities (n_points, ...) of bodies with a new mesh the means (d,) that they had, in place."""
        run = self._run
        free = ~find_held(run)
        for part, own, mean in zip(carrier.parts, list_nodes(run), means, strict=True):
            if part.surface is None:
                continue
            mass, moved = run.solids.mass[own], velocity[own, : len(mean)]  # a view
            lacking = mass.sum() * mean - mass @ moved
            lacking[0] *= run.model.analysis != "axisymmetric"  # across an axis there is none
            moved += free[own] * lacking / np.maximum(mass @ free[own], 1e-300)

    def _measure_masses(self) -> FloatArray:
        """Return the mass of each body without what was added (n_bodies,) [t]."""
        return np.array([own.sum() for own in self._run.split(self._run.solids.true_mass)])


def _kinetic_energy(solids: Solids) -> float:
    """Return the kinetic energy of the nodes, half a step back [N mm]."""
    return 0.5 * float(solids.mass @ (solids.velocity**2).sum(axis=1))
