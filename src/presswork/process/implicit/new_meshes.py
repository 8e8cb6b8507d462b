# SPDX-License-Identifier: Apache-2.0
"""New meshes in an implicit run: when, and how the state goes along.

Each mesh is an epoch (process/model_run.py): its points are where the material was when it began, its
displacements begin at zero. The material's first place is carried from mesh to mesh, so that results have displacements
of the whole run.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from presswork.fields.instant import Instant
from presswork.implicit.progress import Progress
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.bodies.laps import LapArrays
from presswork.mesh.checks import MeshError
from presswork.model import Remeshing, find_cell
from presswork.observe.contract import History, Observed, Row
from presswork.outcome import Failed, GaveUpError, StartError
from presswork.process.implicit.increments import IncrementRun, find_position
from presswork.process.mesh_change.carrying import OnMesh, carry_peaks
from presswork.process.mesh_change.contract import MeshChange
from presswork.process.mesh_change.laps import Lap, explain_laps, find_laps, list_laps, mark_laps
from presswork.process.mesh_change.mesh_reasons import DUE, FAILS, find_cause
from presswork.process.mesh_change.new_balance import balance_new_mesh, measure_jump
from presswork.process.mesh_change.new_epoch import NewEpoch, keep_held
from presswork.process.mesh_change.seams import Seams
from presswork.remesh.carrier import Carrier

Old = TypeVar("Old")
"""A body as it is when it gets a new mesh."""
MOST_JUMP = 0.02
"""Change of a tool's force, of the largest, beyond which another mesh is tried, and none taken that can wait."""
WAIT = 1.5
"""Factor on all triggers, up to which the present mesh goes on rather than one that changes the force too much."""
MOST_WAITS = 3
"""Most times that a mesh is put off because it changes the force; longer waits only make it worse."""
WAITED, ON_FIRST = "waited", "on_first"
"""Names in a checkpoint."""


class MeshedBodies(Protocol[Old]):
    """The bodies of a run, in the plane or in space, as new meshes are made of them."""

    parts: Sequence[float]
    """Factors on the requested size, in meshes tried one after the other."""
    waits_first: bool
    """Whether a mesh that changes a force too much is rather put off than followed by another try."""

    def find_obstacle(self) -> str:
        """Return what prevents any new mesh; empty if nothing does."""

    def find(self) -> Sequence[Old]:
        """Return the bodies where they are now."""

    def find_reason(self, number: int, old: Old, wait: float, *, is_first: bool) -> str | None:
        """Return why a body needs a new mesh. wait: factor on the triggers; is_first: it has its first mesh."""

    def make(self, old: Sequence[Old], own: set[int], part: float) -> tuple[ImplicitProcedure, Carrier]:
        """Return the procedure on new meshes of bodies, of a part of the size, with the state carried to them."""

    def note_meshes(self, bodies: set[int] | None, *, is_new: bool, is_refused: bool) -> None:
        """Note what is wrong with the meshes of bodies (None: of all), which are new, or which stay for good."""

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return what a checkpoint keeps."""

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what `arrays` gave."""


class NewMeshes(MeshChange, Generic[Old]):
    """Makes a new mesh of each body where its mesh would fail."""

    def __init__(self, run: IncrementRun, bodies: MeshedBodies[Old]) -> None:
        """Raises StartError where no mesh can be made."""
        assert run.model.remeshing is not None
        self._run, self.bodies = run, bodies
        self._settings: Remeshing = run.model.remeshing
        self.seams = Seams()
        self._stayed = False
        """Whether a new mesh was refused after the last increment."""
        self._cause, self._changed_at = 0, -1
        """Why the present mesh was made, and after which increment."""
        self._waited = 0
        """How often one was put off because it changes the force, on this mesh."""
        self._on_first = self._all if self._settings.keeps_first else set()
        """Bodies whose first mesh is to stay until it fails."""
        if not self._settings.keeps_first:
            run.made_at = -1  # the first mesh is looked at, too
        self._obstacle = self._settings.obstacle or bodies.find_obstacle()
        if self._obstacle and not self._settings.keeps_first:
            raise StartError(f"{self._obstacle}: leave out [remesh]")

    @property
    def _all(self) -> set[int]:
        """The numbers of the bodies."""
        return set(range(max(len(self._run.model.bodies), 1)))

    # --- its reports -------------------------------------------------------------------------------------------------

    def columns(self, run: Observed) -> list[str]:
        """Return the number of cells and of meshes, and why the present one was made."""
        return ["cells", "remeshes", "remesh_cause"]

    def row(self, run: Observed, *, is_released: bool = False) -> Row:
        """Return the values of its columns; the cause in the first row on a mesh."""
        cause = self._cause if run.number == self._changed_at + 1 else 0
        return {"cells": self._count_cells(), "remeshes": run.epoch, "remesh_cause": cause}

    def _count_cells(self) -> int:
        return sum(len(block.connectivity) for block in self._run.model.mesh.blocks)

    def begin_log(self) -> str:
        """Return what prevents new meshes."""
        return f"; no new meshes: {self._obstacle}" if self._obstacle else ""

    def find_hints(self) -> list[str]:
        """Return what prevents new meshes."""
        if self._obstacle:
            return [f"no new mesh: {self._obstacle}"]
        return ["[remesh] in the case makes new meshes before the first one fails"] if self._on_first else []

    def show(self, run: Observed, now: Instant) -> None:
        """Add laps, and where the material was when the run began."""
        now.laps = mark_laps(self._run.procedure.state[LapArrays].mark, self.seams)
        now.initial_position = self._run.mesh.points

    def summary(self, run: Observed, history: History) -> dict[str, Any]:
        """Return how many meshes there were, and the laps."""
        return {"remeshes": run.epoch, "laps": list_laps(self._find_laps())}

    def warnings(self, run: Observed, history: History) -> list[str]:
        """Return the laps."""
        begun = self._run.procedure.state[LapArrays].begun, self.seams.begun
        return explain_laps(self._find_laps(), begun)

    def _find_laps(self) -> list[Lap]:
        procedure = self._run.procedure
        mark = procedure.state[LapArrays].mark
        return find_laps(self._run.model.mesh, find_position(procedure), mark, self.seams)

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return which first meshes stay, how long a new one was put off, and the seams."""
        on_first = np.isin(np.arange(len(self._all)), list(self._on_first))
        own = {WAITED: np.array([self._waited]), ON_FIRST: on_first}
        return own | self.seams.to_arrays() | self.bodies.arrays()

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what `arrays` gave."""
        self.seams.load_arrays(arrays)
        self._waited = int(arrays[WAITED][0])
        self._on_first = set(np.flatnonzero(arrays[ON_FIRST]).tolist())
        self.bodies.load_arrays(arrays)

    # --- when --------------------------------------------------------------------------------------------------------

    def look(self, failure: str = "") -> bool:
        """Make another mesh if the present one should not go on, and go on with it; return whether there is one."""
        if self._obstacle:
            return False
        if failure:
            again = self._run.made_at == self._run.number and not self._stayed
            return self.remesh(FAILS, must=True, again=again)
        found = self._find_reason()
        return found is not None and self.remesh(*found)

    def _find_reason(self, wait: float = 1.0) -> tuple[str, set[int]] | None:
        """Return why present meshes should not go on, and of which bodies; wait: factor on the triggers."""
        if wait == 1.0 and self._run.number > 0 and self._passed_fraction():
            return DUE, self._all
        found: dict[int, str] = {}
        for number, old in enumerate(self.bodies.find()):
            reason = self.bodies.find_reason(number, old, wait, is_first=number in self._on_first)
            if reason is not None:
                found[number] = reason
        return ("; ".join(dict.fromkeys(found.values())), set(found)) if found else None

    def _passed_fraction(self) -> bool:
        if self._settings.every == 0.0:
            return False
        progress = self._run.procedure.state[Progress]
        before = progress.fraction or 1.0
        last = before - progress.last_size if progress.fraction else 1.0 - self._settings.every
        every = self._settings.every * (1 - 1e-9)
        return bool(np.floor(before / every) > np.floor(last / every))

    def _may_wait(self) -> bool:
        """Return whether the present mesh may go on for another increment."""
        return self._waited < MOST_WAITS and self._find_reason(WAIT) is None

    # --- how ---------------------------------------------------------------------------------------------------------

    def remesh(self, reason: str, bodies: set[int] | None = None, *, must: bool = False, again: bool = False) -> bool:
        """Make new meshes of bodies (None: of all), and go on with them; return whether there are any.

        must: the run ends without. again: the last mesh has failed at once.
        """
        waited = self._waited
        is_new = self._make_meshes(reason, bodies, must=must, again=again)
        self.bodies.note_meshes(bodies, is_new=is_new, is_refused=self._waited == waited)
        return is_new

    def _make_meshes(self, reason: str, bodies: set[int] | None, *, must: bool, again: bool) -> bool:
        """Make new meshes of bodies (None: of all), and go on with them; the old ones stay where that fails.

        Where a tool's force changes by more than MOST_JUMP, finer meshes are tried. The best one is taken if it keeps
        the force, or if there must be one. again: the last one has failed at once; now the metal may yield while the
        tools are at rest. Quadratic cells all give way at once: bodies have as many nodes on an edge.
        """
        run, old = self._run, self.bodies.find()
        is_quadratic = find_cell(1, run.model.mesh.boundary_edges).is_quadratic
        own = bodies if bodies and not is_quadratic else set(range(len(old)))
        found: list[NewEpoch] = []
        faults: list[str] = []
        self._stayed = False
        for part in self.bodies.parts:
            try:
                found.append(self._try_mesh(old, own, part, may_yield=again))
            except (MeshError, GaveUpError) as error:
                faults.append(str(error))
                if (
                    self.bodies.waits_first and not must and isinstance(error, MeshError)
                ):  # finer ones have been tried, too
                    break
                continue
            if found[-1].jump <= MOST_JUMP or (self.bodies.waits_first and not must and self._may_wait()):
                break
        if not found:
            return self._stay(reason, faults[0])
        new = min(found, key=lambda mesh: mesh.jump)
        if new.jump > MOST_JUMP and not must and self._may_wait():
            self._waited += 1
            return self._stay(reason, f"the largest force of a tool would change by {new.jump:.2%}")
        self._go_on(new)
        self._waited, self._cause, self._changed_at = 0, find_cause(reason), run.number
        self._on_first = self._on_first - own
        volume = new.procedure.volume() / new.procedure.initial_volume - 1.0
        run.notes.append(
            f"remesh {run.epoch} ({reason}): {self._count_cells()} cells, largest "
            f"force of a tool changes by {new.jump:.2%}, volume {volume:+.2e} of the first, {new.iterations} iterations"
            + (f"; none of {len(found)} meshes keeps the force within {MOST_JUMP:.0%}" if new.jump > MOST_JUMP else "")
        )
        return True

    def _go_on(self, new: NewEpoch) -> None:
        """Go on with new meshes. Raises GaveUpError."""
        run = self._run
        seams = self.seams.places(find_position(run.procedure))
        if run.neighbours is not None:
            run.neighbours.leave_mesh(new)
        run.begin_on(new.procedure, new.origin, new.procedure.model.mesh.points)
        if run.neighbours is not None:
            run.neighbours.take_mesh(new)
        self.seams.go_on(run.model.mesh, seams, new.seams, run.procedure.state[Progress].time)

    def _try_mesh(self, old: Sequence[Old], own: set[int], part: float, *, may_yield: bool) -> NewEpoch:
        """Return equilibrium on new meshes of bodies, of a part of the size. Raises MeshError or GaveUpError."""
        before = self._run.procedure
        after, carrier = self.bodies.make(old, own, part)
        carry_peaks(OnMesh.of(before), OnMesh.of(after), carrier)
        carried = after.state
        outcome = balance_new_mesh(after, may_yield=may_yield)
        if isinstance(outcome, Failed):
            raise GaveUpError(f"no equilibrium on the new mesh, {outcome.reason}")
        origin = carrier.material(self._run.mesh.points)
        keep_held(origin, after.model)
        seams = [seam for part_of in carrier.parts for seam in part_of.seams]
        jump = measure_jump(before.state, after.state)
        return NewEpoch(after, origin, jump, len(outcome.log), seams, carrier, carried, may_yield)

    def _stay(self, reason: str, fault: str) -> bool:
        """Go on with the old mesh."""
        self._run.notes.append(f"not remeshed ({reason}): {fault}")
        self._run.made_at, self._stayed = self._run.number, True
        return False
