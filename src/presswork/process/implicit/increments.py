# SPDX-License-Identifier: Apache-2.0
"""What recordings of the implicit procedure share: each report is an increment."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from presswork.body.law_window import LawWindow
from presswork.evolution.points import find_evolved
from presswork.fields.instant import Instant
from presswork.implicit.progress import IncrementReport, Progress
from presswork.implicit.ram import RamArrays
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.loose_bodies import warn_of_loose
from presswork.model import Blow, FloatArray, Model, change_mesh
from presswork.observe.contract import Evolved, Observed, Ram, Row
from presswork.outcome import GaveUpError
from presswork.process.mesh_change.contract import MeshChange
from presswork.process.mesh_change.new_epoch import NewEpoch
from presswork.process.model_run import ModelRun, NamedArrays
from presswork.process.observed_run import ObservedRun

MADE = "made"
"""Name in a checkpoint."""


class FollowedRun(Protocol):
    """What follows a run onto the meshes that it gets."""

    def leave_mesh(self, new: NewEpoch) -> None:
        """Note where nodes are before the run goes on to a new mesh."""

    def take_mesh(self, new: NewEpoch) -> None:
        """Go on with the new mesh that the run has gone on to. Raises GaveUpError."""

    def end(self) -> None:
        """End: the run goes on with another procedure."""

    def make_again(self, before: ImplicitProcedure, epoch: Mapping[str, NDArray[Any]]) -> None:
        """Follow the procedure that was made for the epoch of a checkpoint, after another one."""

    def epoch_arrays(self) -> NamedArrays:
        """Return what belongs to the epoch."""

    def load_epoch(self) -> None:
        """Go on in the epoch of make_again, once the run has taken it up."""


class IncrementRun(ObservedRun, ModelRun):
    """An implicit procedure at work on a model."""

    def __init__(self, model: Model, procedure: ImplicitProcedure) -> None:
        super().__init__(model)
        self.procedure = procedure
        self.timing = procedure.timing
        self.begin_observing()
        self.neighbours: FollowedRun | None = None
        """What follows the run onto its new meshes."""
        self.made_at, self._failed_at = 0, -1
        """Increments when the mesh was made, or could not be, and when one last failed."""

    def add_mesh_change(self, change: MeshChange) -> None:
        """Let the mesh of the run change. Raises ValueError for a run that follows its path on one mesh."""
        if self.model.solver.control == "arc_length":
            raise ValueError("arc length follows its path on one mesh: take load control")
        super().add_mesh_change(change)

    def at_work(self) -> Observed:
        """Return the run itself."""
        return self

    def files(self) -> dict[str, str]:
        """Return the files of the observers."""
        return self.observers.files(self)

    @property
    def number(self) -> int:
        """Increments so far."""
        return self.procedure.state[Progress].increments

    def advance(self) -> Iterator[IncrementReport]:
        """Compute increment after increment, and change the mesh between them. Raises GaveUpError."""
        while self.remaining() > 0.0:
            if self.made_at != self.number:
                self._change_mesh()
            try:
                report = next(self.procedure.advance())
            except GaveUpError as error:
                has_failed, self._failed_at = self._failed_at == self.number, self.number
                if has_failed or not self._change_mesh(str(error)):
                    raise GaveUpError("; ".join([str(error), *self.notes, *self._find_hints()])) from error
                continue
            yield report

    def _find_hints(self) -> list[str]:
        """Return what may have made the increment fail."""
        return [hint for change in self.mesh_changes for hint in change.find_hints()]

    def _change_mesh(self, failure: str = "") -> bool:
        """Ask for another mesh, and go on with it; return whether there is one."""
        return any(change.look(failure) for change in self.mesh_changes)

    def begin_on(self, procedure: ImplicitProcedure, origin: FloatArray | None, position: FloatArray) -> None:
        """Go on with a procedure on another mesh.

        position: of its nodes in the present state of the old one (n_points, d) [mm].
        """
        self.observers.take_mesh(find_position(self.procedure), procedure.model.mesh, position)
        self.procedure, self.made_at = procedure, self.number
        procedure.evolution.place(origin)
        self.begin_epoch(procedure.model.mesh, origin)

    def replace_procedure(self, procedure: ImplicitProcedure) -> None:
        """Go on with another procedure on the same mesh."""
        self.procedure, self.model = procedure, procedure.model
        procedure.evolution.place(self.origin)
        if self.neighbours is not None:
            self.neighbours.end()

    def current_stage(self) -> int:
        """Return the stage that the converged state belongs to."""
        progress = self.procedure.state[Progress]
        return progress.stage - 1 if progress.fraction == 0.0 and progress.stage > 0 else progress.stage

    def positions(self) -> FloatArray:
        """Return where the nodes are (n_points, 2 | 3) [mm]."""
        points = self.model.mesh.points
        return np.asarray(points + self.procedure.state.nodes.displacement[:, : points.shape[1]])

    def displacements(self) -> FloatArray:
        """Return displacements since the run began (n_points, freedoms) [mm, rad]."""
        return self.moved(self.procedure.state.nodes.displacement)

    @abstractmethod
    def tool_displacements(self) -> dict[str, FloatArray]:
        """Return how far each tool has moved since the run began (2 | 3,) [mm]."""

    @abstractmethod
    def show(self) -> Instant:
        """Return what fields are computed from."""

    def reactions(self) -> FloatArray:
        """Return the forces of what holds nodes (n_points, freedoms) [N, N mm]."""
        return self.procedure.state.nodes.reaction

    def evolved(self) -> Evolved:
        """Return what evolution laws keep at the points of the material."""
        evolution = self.procedure.evolution
        critical = {name: evolution.critical(name) for name in evolution.names}
        return Evolved(find_evolved(self.procedure.state), critical)

    def ram(self) -> Ram:
        """Return the ram of a model that has one."""
        now, drive = self.procedure.state[RamArrays], self.model.stages[self.current_stage()].drive
        blow = drive.motion.number if drive is not None and isinstance(drive.motion, Blow) else 0
        return Ram(now.speed, now.force, now.work, blow)

    def law_window(self) -> LawWindow:
        """Return what the materials have been through."""
        return self.procedure.state[LawWindow]

    def warn_of_loose(self) -> list[str]:
        """Return what a user should know of bodies that nothing holds."""
        return warn_of_loose(self.procedure.model, self.procedure.state)

    def plastic_shares(self) -> FloatArray:
        """Return the plastic work over the work of the ram in each stage (n_stages,)."""
        return self.procedure.state[RamArrays].plastic_share

    def remaining(self) -> float:
        """Return the part of the whole process that is still to be computed, counted in stage durations."""
        return self.procedure.remaining()

    def log_lines(self, report: IncrementReport) -> list[str]:
        """Describe how the increment was found."""
        log = report.log
        return [
            *self.take_notes(),
            *(f"increment {report.number} cut back: {reason}" for reason in report.cutbacks),
            f"increment {report.number}, stage {report.stage} at {report.fraction:.4f}, {len(log)} iterations, "
            f"residuals {' '.join(f'{r:.1e}' for r in log.residual)}, "
            f"corrections {' '.join(f'{c:.1e}' for c in log.correction)}"
            + (f", linear iterations {', '.join(log.solutions)}" if log.solutions else ""),
        ]

    def _prepare_epoch(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        for change in self.mesh_changes:
            change.prepare_epoch(epoch)

    def _epoch_arrays(self) -> NamedArrays:
        beside = self.neighbours.epoch_arrays() if self.neighbours else {}
        return {MADE: np.array([self.made_at, self._failed_at]), **self.observers.arrays(), **beside}

    def _load_epoch(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        self.made_at, self._failed_at = (int(number) for number in epoch[MADE])
        self.observers.load_arrays(epoch)
        if self.neighbours is not None:
            self.neighbours.load_epoch()

    def make_run(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        """Make the procedure for the present mesh; epoch: of a checkpoint."""
        before = self.procedure
        self.procedure = ImplicitProcedure(change_mesh(before.model, self.model.mesh), before=before)
        self.procedure.evolution.place(self.origin)
        if self.neighbours is not None:
            self.neighbours.make_again(before, epoch)

    def _state_arrays(self) -> NamedArrays:
        return self.procedure.state.to_arrays()

    def _load_state(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        self.procedure.state.load_arrays(arrays)

    def _begin_row(self, report: IncrementReport) -> Row:
        """Return the first columns of the history."""
        return {
            "time": report.time,
            "stage": report.stage,
            "increment": report.number,
            "iterations": len(report.log),
        }

    def _count_work(self) -> dict[str, Any]:
        """Return the summary of the work done."""
        p = self.procedure.state[Progress]
        return {
            "increments": p.increments,
            "iterations": p.iterations,
            "cutbacks": p.cutbacks,
            "work": f"{p.increments} increments, {p.iterations} iterations, {p.cutbacks} cut-backs",
            "freedoms": self.procedure.mechanics.freedoms * len(self.model.mesh.points),
        }


def find_position(procedure: ImplicitProcedure) -> FloatArray:
    """Return where the nodes are (n_points, 2 | 3) [mm]."""
    points = procedure.model.mesh.points
    return np.asarray(points + procedure.state.nodes.displacement[:, : points.shape[1]])
