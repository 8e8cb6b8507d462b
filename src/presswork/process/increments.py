# SPDX-License-Identifier: Apache-2.0
"""What recordings of the implicit procedure say alike: each report is an increment."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.implicit.epochs import AskForMesh, Epoch, MeshChange, new_epoch
from presswork.implicit.progress import Progress
from presswork.implicit.stepping import ImplicitProcedure, IncrementReport
from presswork.mesh.dump import dump_mesh, load_mesh
from presswork.model import FloatArray, Mesh, Model
from presswork.outcome import GaveUpError
from presswork.process.recording import ModelRecording, Row

EPOCH, ORIGIN, MADE = "epoch.", "origin", "made"
"""Prefix of the arrays of a mesh in a checkpoint, and two of them."""


class IncrementRecording(ModelRecording):
    """An implicit procedure at work on a model."""

    def __init__(self, model: Model, procedure: ImplicitProcedure, ask_for_mesh: AskForMesh | None = None) -> None:
        """ask_for_mesh: asked after every increment whether the run goes on with another mesh."""
        self.model = model
        self.procedure = procedure
        self.timing = procedure.timing
        self._ask_for_mesh = ask_for_mesh
        self._origin: FloatArray | None = None
        """Where the material of the nodes was when the run began; None: on the first mesh."""
        self._made_at, self._failed_at = 0, -1
        """Increments when the mesh was made, and when one last failed."""
        self._notes: list[str] = []

    @property
    def number(self) -> int:
        """Increments so far."""
        return self.procedure.state[Progress].increments

    @property
    def mesh(self) -> Mesh:
        """The mesh of the present epoch, its points where their material was when the run began."""
        return self.model.mesh if self._origin is None else replace(self.model.mesh, points=self._origin)

    def moved(self, displacement: FloatArray) -> FloatArray:
        """Return displacements since the run began, of those since the epoch's points (n_points, d) [mm]."""
        if self._origin is None or self._origin is self.model.mesh.points:
            return displacement
        moved = displacement.copy()
        moved[:, : self._origin.shape[1]] += self.model.mesh.points - self._origin
        return moved

    def advance(self) -> Iterator[IncrementReport]:
        """Compute increment after increment, and change the mesh between them. Raises GaveUpError."""
        while self.remaining() > 0.0:
            if self.number > 0 and self._made_at != self.number:
                self._may_change_mesh()
            try:
                report = next(self.procedure.advance())
            except GaveUpError as error:
                if self._failed_at == self.number:
                    raise
                self._failed_at = self.number
                if not self._may_change_mesh(str(error)):
                    raise
                continue
            yield report

    def _may_change_mesh(self, failure: str = "") -> bool:
        """Ask for another mesh, and go on with it; return whether there is one."""
        change = None
        if self._ask_for_mesh is not None:
            change = self._ask_for_mesh(Epoch(self.model.mesh, self.procedure.state, self.procedure, failure))
        if change is not None:
            self.change_mesh(change)
        return change is not None

    def change_mesh(self, change: MeshChange) -> None:
        """Go on with another mesh. Raises GaveUpError."""
        self._begin_on(new_epoch(self.procedure, change.mesh, change.transfer), change.origin)
        self._made_at = self.number
        cells = sum(len(block.connectivity) for block in change.mesh.blocks)
        self._notes.append(f"new mesh of {cells} cells after increment {self.number} {change.reason}".rstrip())

    def _begin_on(self, procedure: ImplicitProcedure, origin: FloatArray | None) -> None:
        mesh = procedure.model.mesh
        self.procedure, self.model = procedure, replace(self.model, mesh=mesh)
        self._origin = mesh.points if origin is None else origin

    def remaining(self) -> float:
        """Return the part of the whole process that is still to be computed, counted in stage durations."""
        return self.procedure.remaining()

    def log_lines(self, report: IncrementReport) -> list[str]:
        """Say how the increment was found."""
        log, notes = report.log, self._notes
        self._notes = []
        return [
            *notes,
            *(f"increment {report.number} cut back: {reason}" for reason in report.cutbacks),
            f"increment {report.number}, stage {report.stage} at {report.fraction:.4f}, {len(log)} iterations, "
            f"residuals {' '.join(f'{r:.1e}' for r in log.residual)}, "
            f"corrections {' '.join(f'{c:.1e}' for c in log.correction)}",
        ]

    def to_arrays(self) -> dict[str, NDArray[np.generic]]:
        """Return the converged state, and its mesh if that is not the first one."""
        arrays = self.procedure.state.to_arrays()
        if self._origin is not None:
            arrays |= {f"{EPOCH}{name}": values for name, values in dump_mesh(self.model.mesh).items()}
            arrays[f"{EPOCH}{ORIGIN}"] = self._origin
            arrays[f"{EPOCH}{MADE}"] = np.array([self._made_at, self._failed_at])
        return arrays

    def load_arrays(self, arrays: Mapping[str, NDArray[np.generic]]) -> None:
        """Take up a converged state, and its mesh. Raises ValueError if it is another model's."""
        own = {name.removeprefix(EPOCH): values for name, values in arrays.items() if name.startswith(EPOCH)}
        if own:
            mesh, origin = load_mesh(own), np.asarray(own[ORIGIN], dtype=np.float64)
            after = ImplicitProcedure(replace(self.procedure.model, mesh=mesh), before=self.procedure)
            self._begin_on(after, mesh.points if np.array_equal(origin, mesh.points) else origin)
            self._made_at, self._failed_at = (int(number) for number in own[MADE])
        self.procedure.state.load_arrays({n: values for n, values in arrays.items() if not n.startswith(EPOCH)})

    def _begin_row(self, report: IncrementReport) -> Row:
        """Return the first columns of the history."""
        return {
            "time": report.time,
            "stage": report.stage,
            "increment": report.number,
            "iterations": len(report.log),
        }

    def _count_work(self) -> dict[str, Any]:
        """Return what the summary says of the work done."""
        p = self.procedure.state[Progress]
        return {
            "increments": p.increments,
            "iterations": p.iterations,
            "cutbacks": p.cutbacks,
            "work": f"{p.increments} increments, {p.iterations} iterations, {p.cutbacks} cut-backs",
            "freedoms": self.procedure.mechanics.freedoms * len(self.model.mesh.points),
        }
