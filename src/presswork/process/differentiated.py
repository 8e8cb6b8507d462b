# SPDX-License-Identifier: Apache-2.0
"""An implicit run whose history has derivatives by numbers of the case beside its columns."""

from __future__ import annotations

import difflib
from dataclasses import replace
from typing import Any

import numpy as np

from presswork.implicit.sensitivities import Neighbour, Neighbours, Sensitivities
from presswork.implicit.stepping import IncrementReport
from presswork.model import Model
from presswork.outcome import StartError
from presswork.process.implicit_recording import ImplicitRecording
from presswork.process.recording import Row
from presswork.results.history import name_derivative

NO_MEASURES = ("time", "stage", "increment", "iterations")
"""Columns of the history that have no derivative."""


class DifferentiatedForming(ImplicitRecording):
    """An implicit procedure at work beside its neighbours, whose rows give the derivatives.

    A row of the neighbours is made as the run's own, so any of its columns has a derivative. Raises StartError for a
    column that there is not.
    """

    def __init__(self, model: Model, *, threads: int = 0) -> None:
        super().__init__(model, threads=threads)
        assert model.gradients is not None, "begin() makes this of models with derivatives"
        self._own_columns = super().columns
        measures = [name for name in self._own_columns if name not in NO_MEASURES]
        forces = [f"{tool.name}.force" for tool in model.tools]
        self._of = list(model.gradients.of or forces)
        for name in self._of:
            if name not in measures:
                near = difflib.get_close_matches(name, measures, n=1, cutoff=0.4)
                remedy = f"did you mean `{near[0]}`? " if near else ""
                raise StartError(
                    f"gradients.of: the history has no column `{name}`; {remedy}it has {', '.join(measures)}"
                )
        if not self._of:
            raise StartError(f"gradients.of: say of what; the history has {', '.join(measures)}")
        self._by = model.gradients.by
        whole = replace(model, gradients=None, solver=replace(model.solver, symmetric=False))
        self._same = ImplicitRecording(whole, threads=threads)
        same = Neighbour(self._same.procedure, 0.0)
        self._beside, neighbours = [], []
        for p in self._by:
            less, more = (ImplicitRecording(m, threads=threads) if m else self._same for m in (p.less, p.more))
            self._beside.append((less, more))
            beside = Neighbour(less.procedure, -p.step) if p.less else same
            neighbours.append(Neighbours(p.key, Neighbour(more.procedure, p.step), beside))
        self._sensitivities = Sensitivities(self.procedure, same, neighbours)

    @property
    def columns(self) -> list[str]:
        """Of history.csv."""
        return [*super().columns, *(name_derivative(of, p.key) for p in self._by for of in self._of)]

    def row(self, report: IncrementReport) -> Row:
        """Return the row of the history."""
        row = super().row(report)
        own = self._same.row(report)
        neighbours = self._sensitivities.neighbours
        for number, (parameter, sides, each) in enumerate(zip(self._by, self._beside, neighbours, strict=True)):
            if self._sensitivities.is_lost(self.procedure.state, number):
                row |= {name_derivative(of, parameter.key): float("nan") for of in self._of}
                continue
            less, more = (own if side is self._same else side.row(report) for side in sides)
            for of in self._of:
                row[name_derivative(of, parameter.key)] = (float(more[of]) - float(less[of])) / each.apart
        return row

    def summary(self, history: Any) -> dict[str, Any]:
        """Return what summary.json says; of the derivatives those at the end."""
        found = super().summary(history)
        last = {
            p.key: {"value": p.value}
            | {of: float(history[name][-1]) for of in self._of if len(history[name := name_derivative(of, p.key)])}
            for p in self._by
        }
        found["warnings"] = [*found["warnings"], *self._warn(history)]
        return found | {"gradients": last, "gradient_rounds": self._sensitivities.rounds}

    def _warn(self, history: Any) -> list[str]:
        """Say from which increment on a derivative has not been found."""
        warnings = []
        for parameter in self._by:
            lost = np.isnan(np.asarray(history[name_derivative(self._of[0], parameter.key)], dtype=float))
            if lost.any():
                warnings.append(
                    f"the derivative by {parameter.key} was not found in increment "
                    f"{int(history['increment'][int(np.argmax(lost))])} and stays away: a smaller "
                    "solver.max_increment or solver.force_tolerance may find it"
                )
        return warnings
