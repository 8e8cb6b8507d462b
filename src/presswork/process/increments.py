# SPDX-License-Identifier: Apache-2.0
"""What recordings of the implicit procedure say alike: each report is an increment."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.implicit.stepping import CUTBACKS, INCREMENTS, ITERATIONS, ImplicitProcedure, IncrementReport
from presswork.model import Model
from presswork.process.recording import ModelRecording, Row


class IncrementRecording(ModelRecording):
    """An implicit procedure at work on a model."""

    def __init__(self, model: Model, procedure: ImplicitProcedure) -> None:
        self.model = model
        self.procedure = procedure
        self.timing = procedure.timing

    @property
    def number(self) -> int:
        """Increments so far."""
        return int(self.procedure.state.progress[INCREMENTS])

    def advance(self) -> Iterator[IncrementReport]:
        """Compute increment after increment. Raises GaveUpError."""
        return self.procedure.advance()

    def remaining(self) -> float:
        """Return the part of the whole process that is still to be computed, counted in stage durations."""
        return self.procedure.remaining()

    def log_lines(self, report: IncrementReport) -> list[str]:
        """Say how the increment was found."""
        log = report.log
        return [
            *(f"increment {report.number} cut back: {reason}" for reason in report.cutbacks),
            f"increment {report.number}, stage {report.stage} at {report.fraction:.4f}, {len(log)} iterations, "
            f"residuals {' '.join(f'{r:.1e}' for r in log.residual)}, "
            f"corrections {' '.join(f'{c:.1e}' for c in log.correction)}",
        ]

    def to_arrays(self) -> dict[str, NDArray[np.generic]]:
        """Return the converged state."""
        return self.procedure.state.to_arrays()

    def load_arrays(self, arrays: Mapping[str, NDArray[np.generic]]) -> None:
        """Take up a converged state. Raises ValueError if it is another model's."""
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
        """Return what the summary says of the work done."""
        progress = self.procedure.state.progress
        increments, iterations, cutbacks = (int(progress[i]) for i in (INCREMENTS, ITERATIONS, CUTBACKS))
        return {
            "increments": increments,
            "iterations": iterations,
            "cutbacks": cutbacks,
            "work": f"{increments} increments, {iterations} iterations, {cutbacks} cut-backs",
            "freedoms": self.procedure.mechanics.freedoms * len(self.model.mesh.points),
        }
