# SPDX-License-Identifier: Apache-2.0
"""Implicit runs whose history has derivatives by numbers of the case beside its columns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.model import Mesh, Model
from presswork.observe.contract import Observed, Row
from presswork.process.derivatives.derivatives import Derivatives
from presswork.process.implicit.begin_forming import begin_forming
from presswork.process.implicit.forming import ImplicitForming
from presswork.process.implicit.stamping import ImplicitStamping
from presswork.process.line.press_line import PressLine
from presswork.process.line.springback import ReleasedStamping
from presswork.process.run import Meta, Report, Run, Snapshot


def begin_differentiated(model: Model, threads: int) -> DifferentiatedRun:
    """Return the procedure of a model with derivatives. Raises StartError."""
    if model.following:
        return _begin_line(model, threads)
    if model.analysis == "stamping" and (model.trim or model.springback is not None or model.output.dynain):
        return _begin_release(model, threads)
    if model.analysis == "stamping":
        return _begin_stamping(model, threads)
    return _begin_forming(model, threads)


def _begin_forming(model: Model, threads: int) -> DifferentiatedRun:
    from presswork.process.derivatives.on_new_meshes import OnNewMeshes

    run = begin_forming(model, threads=threads)
    derivatives = Derivatives(model, run.columns, lambda m: ImplicitForming(m, threads=threads))
    derivatives.follow(run.procedure, lambda side: side.procedure)
    run.neighbours = OnNewMeshes(run, derivatives)
    return DifferentiatedRun(run, derivatives)


def _begin_stamping(model: Model, threads: int) -> DifferentiatedRun:
    run = ImplicitStamping(model, threads=threads)
    derivatives = Derivatives(model, run.columns, lambda m: ImplicitStamping(m, threads=threads))
    derivatives.follow(run.procedure, lambda side: side.procedure)
    return DifferentiatedRun(run, derivatives)


def _begin_release(model: Model, threads: int) -> DifferentiatedRun:
    from presswork.process.derivatives.released import find_forming, release_neighbours

    run = ReleasedStamping(model, threads=threads)
    derivatives = Derivatives(model, run.columns, lambda m: ReleasedStamping(m, threads=threads))
    derivatives.follow(find_forming(run), find_forming)
    run.after_release = lambda procedure: release_neighbours(derivatives, lambda side: side, procedure)
    return DifferentiatedRun(run, derivatives)


def _begin_line(model: Model, threads: int) -> DifferentiatedRun:
    from presswork.process.derivatives.through_operations import ThroughOperations

    run = PressLine(model, threads=threads)
    derivatives = Derivatives(model, run.columns, lambda m: PressLine(m, threads=threads))
    run.neighbours = ThroughOperations(run, derivatives)
    return DifferentiatedRun(run, derivatives)


class DifferentiatedRun:
    """A run beside its neighbours: what it records, and the derivatives that their rows give."""

    def __init__(self, run: Run, derivatives: Derivatives[Any]) -> None:
        self.run, self.derivatives = run, derivatives
        self.timing = run.timing

    @property
    def title(self) -> str:
        """What the case shows."""
        return self.run.title

    @property
    def mesh(self) -> Mesh:
        """The undeformed mesh."""
        return self.run.mesh

    @property
    def columns(self) -> list[str]:
        """Return the columns of history.csv."""
        return [*self.run.columns, *self.derivatives.names]

    @property
    def checkpoint_every(self) -> int:
        """Reports between checkpoints."""
        return self.run.checkpoint_every

    @property
    def number(self) -> int:
        """Reports so far."""
        return self.run.number

    def advance(self) -> Iterator[Report]:
        """Go on from the present state. Raises GaveUpError."""
        return self.run.advance()

    def remaining(self) -> float:
        """Return the part of the whole process that is still to be computed."""
        return self.run.remaining()

    def files(self) -> dict[str, str]:
        """Return the names and texts of further files to be written now."""
        return self.run.files()

    def begin_log(self) -> str:
        """Return the line that begins the log."""
        return self.run.begin_log()

    def log_lines(self, report: Any) -> list[str]:
        """Return the log's lines on a report."""
        return self.run.log_lines(report)

    def progress_text(self, report: Any) -> str:
        """Return a line for who waits."""
        return self.run.progress_text(report)

    def row(self, report: Any) -> Row:
        """Return the row of the history."""
        return self.derivatives.add(self.run.row(report), report)

    def at_work(self) -> Observed | None:
        """Return what observers see of the run that forms at present."""
        return self.run.at_work()

    def snapshot(self) -> Snapshot:
        """Return the fields of the present state."""
        return self.run.snapshot()

    def to_arrays(self) -> dict[str, NDArray[np.generic]]:
        """Return every array that the next report depends on; the derivatives are among them."""
        return self.run.to_arrays()

    def load_arrays(self, arrays: Mapping[str, NDArray[np.generic]]) -> None:
        """Go back to the state of these arrays. Raises ValueError if they belong to another model."""
        self.run.load_arrays(arrays)

    def meta(self) -> Meta:
        """Return the numbers that a checkpoint keeps beside the arrays."""
        return self.run.meta()

    def load_meta(self, meta: Mapping[str, Any]) -> None:
        """Take up what meta gave."""
        self.run.load_meta(meta)

    def summary(self, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return the contents of summary.json; derivatives are those at the end."""
        return self.derivatives.add_summary(self.run.summary(history), history)
