# SPDX-License-Identifier: Apache-2.0
"""Parts formed one after another: each by a run of its own, between tools as warm as the part before has left them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.implicit.heat_of_forming import HeatArrays
from presswork.implicit.progress import IncrementReport, Progress
from presswork.model import Mesh, Model
from presswork.observe.contract import Observed, Row
from presswork.process.implicit.begin_forming import begin_forming
from presswork.process.implicit.forming import ImplicitForming
from presswork.process.model_run import ModelRun
from presswork.process.run import Meta, Snapshot

PLACE = "series.place"
"""Name in a checkpoint of the place: parts done, reports and time before the present part."""


class SeriesForming(ModelRun):
    """Forms the parts of a series."""

    def __init__(self, model: Model, *, threads: int = 0) -> None:
        assert model.series is not None
        super().__init__(model)
        self._threads, self._series = threads, model.series
        self._part, self._reports, self._time = 0, 0, 0.0
        self._run = self._make_part()
        self.timing = self._run.timing

    def _make_part(self) -> ImplicitForming:
        return begin_forming(self.model, threads=self._threads)

    @property
    def mesh(self) -> Mesh:
        """The undeformed mesh of the present part."""
        return self._run.mesh

    @property
    def columns(self) -> list[str]:
        """Return the columns of history.csv."""
        return [*self._run.columns, "part"]

    @property
    def number(self) -> int:
        """Increments so far."""
        return self._reports + self._run.number

    def advance(self) -> Iterator[IncrementReport]:
        """Form part after part. Raises GaveUpError."""
        while True:
            for report in self._run.advance():
                yield replace(report, number=self._reports + report.number, time=self._time + report.time)
            if self._part + 1 == self._series.parts:
                return
            self._begin_part()

    def _begin_part(self) -> None:
        """Let the tools lie open, and put a fresh workpiece between them."""
        before = self._run.procedure
        assert before.heat is not None
        dies = before.heat.rest(before.state, self._series.pause)
        self._reports += self._run.number
        self._time += before.state[Progress].time + self._series.pause
        self._part += 1
        run = self._make_part()
        run.timing.go_on_from(before.timing)
        arrays = run.procedure.state[HeatArrays]
        arrays.dies, arrays.die_heat = dies.dies, dies.die_heat
        self._run, self.timing = run, run.timing

    def remaining(self) -> float:
        """Return the part of the whole process that is still to be computed."""
        return (self._series.parts - 1 - self._part + self._run.remaining()) / self._series.parts

    def begin_log(self) -> str:
        """Name the linear solver and the parts."""
        return f"{self._run.begin_log()}; {self._series.parts} parts"

    def files(self) -> dict[str, str]:
        """Return the files of the present part."""
        return self._run.files()

    def log_lines(self, report: IncrementReport) -> list[str]:
        """Describe how the increment was found."""
        return [f"part {self._part + 1}: {line}" for line in self._run.log_lines(report)]

    def progress_text(self, report: IncrementReport) -> str:
        """Name part, stage and increment."""
        return f"part {self._part + 1}, {self._run.progress_text(report)}"

    def row(self, report: IncrementReport) -> Row:
        """Return the row of the history."""
        return self._run.row(report) | {"part": self._part + 1}

    def at_work(self) -> Observed | None:
        """Return what observers see of the run that forms at present."""
        return self._run.at_work()

    def snapshot(self) -> Snapshot:
        """Return the fields of the present part."""
        found = self._run.snapshot()
        return replace(found, time=self._time + found.time)

    def to_arrays(self) -> dict[str, NDArray[np.generic]]:
        """Return all that the next report depends on."""
        place = np.array([self._part, self._reports, self._time])
        return {PLACE: place, **self._run.to_arrays()}

    def load_arrays(self, arrays: Mapping[str, NDArray[np.generic]]) -> None:
        """Go back to the part and the state of these arrays. Raises ValueError if they belong to another model."""
        if PLACE not in arrays:
            raise ValueError("the checkpoint is not that of a series")
        part, reports, self._time = (float(value) for value in arrays[PLACE])
        self._part, self._reports = int(part), int(reports)
        self._run = self._make_part()
        self.timing = self._run.timing
        self._run.load_arrays({name: values for name, values in arrays.items() if name != PLACE})

    def meta(self) -> Meta:
        """Return the numbers that a checkpoint keeps beside the arrays."""
        return self._run.meta()

    def load_meta(self, meta: Mapping[str, Any]) -> None:
        """Take up what meta gave."""
        self._run.load_meta(meta)

    def summary(self, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return the summary of the last part, the increments of all, and the peaks of each."""
        parts = np.asarray(history["part"], dtype=int)
        peaks = {
            name: [float(history[name][parts == part].max()) for part in np.unique(parts)]
            for name in history
            if name.endswith(".temperature_max")
        }
        work = {"increments": self.number, "work": f"{self._part + 1} parts, {self.number} increments"}
        return self._run.summary(history) | work | {"parts": self._part + 1, "peaks_by_part": peaks}
