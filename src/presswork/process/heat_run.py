# SPDX-License-Identifier: Apache-2.0
"""What is recorded of heating and cooling without forming: rows, fields and the summary."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.fields.instant import Instant
from presswork.fields.table import compute_fields
from presswork.implicit.progress import IncrementReport
from presswork.model import Model
from presswork.observe.contract import Row
from presswork.observe.heat import heat_columns, measure_heat, summarise_heat, warn_of_tables
from presswork.process.heat import CUTBACKS, ITERATIONS, KINDS, STEPS, TIME, HeatProcedure
from presswork.process.model_run import ModelRun
from presswork.process.run import Snapshot
from presswork.process.tool_quantities import describe_plane


class HeatRun(ModelRun):
    """Heat at work on bodies that do not deform."""

    model: Model

    def __init__(self, model: Model, *, threads: int = 0) -> None:
        super().__init__(model)
        self.procedure = HeatProcedure(model, threads=threads)
        self.timing = self.procedure.timing

    @property
    def columns(self) -> list[str]:
        """Return the columns of history.csv."""
        bodies = [body.name for body in self.model.bodies]
        each = [f"{body}.temperature_mean" for body in bodies] if len(bodies) > 1 else []
        return ["time", "stage", "increment", "iterations", *each, *heat_columns(KINDS)]

    @property
    def number(self) -> int:
        """Steps so far."""
        return int(self.procedure.state["progress"][STEPS])

    def advance(self) -> Iterator[IncrementReport]:
        """Compute step after step. Raises GaveUpError."""
        return self.procedure.advance()

    def remaining(self) -> float:
        """Return the part of the whole process that is still to be computed, counted in stage durations."""
        return self.procedure.remaining()

    def begin_log(self) -> str:
        """Name the linear solver."""
        return f"linear solver: {self.procedure.equation.solver.name}"

    def log_lines(self, report: IncrementReport) -> list[str]:
        """Describe how the step was found."""
        return [
            *(f"step {report.number} cut back: {reason}" for reason in report.cutbacks),
            f"step {report.number}, stage {report.stage} at {report.fraction:.4f}, {len(report.log)} iterations, "
            f"residuals {' '.join(f'{r:.1e}' for r in report.log.residual)}",
        ]

    def progress_text(self, report: IncrementReport) -> str:
        """Name stage and time, and the range of temperature."""
        temperature = self.procedure.state["temperature"]
        return f"{report.stage}: {report.time:.4g} s, {temperature.min():.1f} to {temperature.max():.1f} degrees C"

    def row(self, report: IncrementReport) -> Row:
        """Return the row of the history: temperatures [degrees C], heat since the start [N mm]."""
        procedure, state = self.procedure, self.procedure.state
        temperature = state["temperature"]
        row: Row = {
            "time": report.time,
            "stage": report.stage,
            "increment": report.number,
            "iterations": len(report.log),
        }
        if len(self.model.bodies) > 1:
            for body in self.model.bodies:
                own = slice(body.points.start, body.points.stop)
                row[f"{body.name}.temperature_mean"] = procedure.equation.conduction.mean(temperature, own)
        conduction = procedure.equation.conduction
        return row | measure_heat(conduction, temperature, procedure.stored(), KINDS, state["heat"])

    def snapshot(self) -> Snapshot:
        """Return the fields of the present state."""
        state, points = self.procedure.state, self.model.mesh.points
        now = Instant(self.model, np.zeros(points.shape), temperature=state["temperature"])
        at_points, in_cells = compute_fields(now)
        return Snapshot(
            time=float(state["progress"][TIME]),
            point_data=at_points,
            cell_data=in_cells,
            info={**describe_plane(self.model), "physics": "heat"},
        )

    def to_arrays(self) -> dict[str, NDArray[np.generic]]:
        """Return the converged state."""
        return dict(self.procedure.state)

    def load_arrays(self, arrays: Mapping[str, NDArray[np.generic]]) -> None:
        """Take up a converged state. Raises ValueError if it is another model's."""
        state = self.procedure.state
        if set(state) != set(arrays) or any(state[name].shape != arrays[name].shape for name in state):
            raise ValueError("the checkpoint belongs to another case: its arrays do not fit this mesh")
        for name in state:
            state[name] = np.array(arrays[name], dtype=np.float64)

    def summary(self, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return counts, extremes and the balance of heat."""
        procedure, progress = self.procedure, self.procedure.state["progress"]
        temperature = procedure.state["temperature"]
        steps, iterations, cutbacks = (int(progress[i]) for i in (STEPS, ITERATIONS, CUTBACKS))
        return {
            "increments": steps,
            "iterations": iterations,
            "cutbacks": cutbacks,
            "work": f"{steps} time steps, {iterations} iterations, {cutbacks} cut-backs",
            "freedoms": len(self.model.mesh.points),
            "extremes": {"temperature": [float(temperature.min()), float(temperature.max())]},
            "heat": summarise_heat(procedure.stored(), KINDS, procedure.state["heat"]),
            "linear_solver": procedure.equation.solver.name,
            "warnings": warn_of_tables(self.model, procedure.state["reached"]),
        }
