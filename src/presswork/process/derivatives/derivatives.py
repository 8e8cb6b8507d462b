# SPDX-License-Identifier: Apache-2.0
"""Neighbours of a run, and the derivatives of its history that their rows give."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Generic, Protocol, TypeVar

import numpy as np

from presswork.implicit.neighbours import Neighbour, Neighbours
from presswork.implicit.sensitivities import Sensitivities
from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import FloatArray, Model
from presswork.observe.contract import Row
from presswork.outcome import StartError
from presswork.results.history import name_derivative

NO_MEASURES = ("time", "stage", "increment", "iterations", "cells", "remeshes", "remesh_cause")
"""Columns of the history that have no derivative."""
WORK = ("external_work", "plastic_work", "friction_work", "inertia_work", "energy_error_percent")
"""Columns for which neighbours add up work."""


class Measured(Protocol):
    """A recording whose rows are compared."""

    def row(self, report: Any) -> Row:
        """Return the row of the history."""


Side = TypeVar("Side", bound=Measured)


class Derivatives(Generic[Side]):
    """The neighbours of a recording. A row of theirs is made as its own, so any of its columns has a derivative.

    columns: of the recording's history. make: makes a recording like it of a neighbour's Model. Raises StartError for a
    column that there is not.
    """

    def __init__(self, model: Model, columns: Sequence[str], make: Callable[[Model], Side]) -> None:
        assert model.gradients is not None, "the caller has asked"
        self._by = model.gradients.by
        self._of = _find_columns(model, columns)
        whole = replace(model, gradients=None, solver=replace(model.solver, symmetric=False))
        self.same = make(whole)
        """Neighbours of the same model, whose matrix is not symmetric."""
        self._beside: list[tuple[Side, Side]] = []
        for p in self._by:
            self._beside.append((make(p.less) if p.less else self.same, make(p.more)))
        self._rounds = 0
        self._sensitivities: Sensitivities | None = None
        self._lost = [False] * len(self._by)
        """Parameters whose derivatives end with a procedure."""

    @property
    def sides(self) -> list[Side]:
        """All neighbours, the same model first."""
        return [self.same, *(side for both in self._beside for side in both if side is not self.same)]

    @property
    def placed(self) -> list[tuple[Side, int, float]]:
        """All neighbours, each with the number of its parameter, and how far that is from the run's."""
        found = [(self.same, 0, 0.0)]
        for number, (p, (less, more)) in enumerate(zip(self._by, self._beside, strict=True)):
            found += [(side, number, change) for side, change in ((less, -p.step), (more, p.step)) if side != self.same]
        return found

    def differ(self, measure: Callable[[Side], FloatArray]) -> FloatArray:
        """Return derivatives of what is measured at neighbours, by one parameter after the other; 0 where lost."""
        found = []
        for number, (p, (less, more)) in enumerate(zip(self._by, self._beside, strict=True)):
            apart = p.step if p.less is None else 2.0 * p.step
            ends = (self.same, self.same) if self.is_lost(number) else (more, less)
            found.append(np.subtract(*(measure(side) for side in ends)) / apart)
        return np.array(found)

    @property
    def names(self) -> list[str]:
        """The columns of the derivatives."""
        return [name_derivative(of, p.key) for p in self._by for of in self._of]

    @property
    def rounds(self) -> int:
        """Back-substitutions so far, of all numbers."""
        return self._rounds + (self._sensitivities.rounds if self._sensitivities else 0)

    def follow(self, procedure: ImplicitProcedure, of: Callable[[Side], ImplicitProcedure]) -> None:
        """Let the neighbours go along with a procedure of the run, from the states that they have.

        of: returns the same procedure of a neighbour. A derivative that was lost in a procedure before stays so.
        """
        counts = any(name in WORK for name in self._of)
        same, neighbours = Neighbour(of(self.same), 0.0, counts_work=counts), []
        for p, (less, more) in zip(self._by, self._beside, strict=True):
            beside = Neighbour(of(less), -p.step, counts_work=counts) if p.less else same
            neighbours.append(Neighbours(p.key, Neighbour(of(more), p.step, counts_work=counts), beside))
        self._lost = [self.is_lost(number) for number in range(len(self._by))]
        self._rounds = self.rounds
        self._sensitivities = Sensitivities(procedure, same, neighbours, self._lost)

    def lose(self, number: int | None = None) -> None:
        """Give up the derivative by a parameter from here on (None: by all)."""
        for each in range(len(self._by)) if number is None else [number]:
            self._lost[each] = True

    def spread(self) -> None:
        """Put the neighbours where the derivatives of the run's present state have them."""
        assert self._sensitivities is not None, "they follow a procedure"
        self._sensitivities.spread()

    def add(self, row: Row, report: Any) -> Row:
        """Return a row of the run with its derivatives."""
        own = self.same.row(report)
        for number, (p, sides) in enumerate(zip(self._by, self._beside, strict=True)):
            if self.is_lost(number):
                row |= {name_derivative(of, p.key): float("nan") for of in self._of}
                continue
            less, more = (own if side is self.same else side.row(report) for side in sides)
            apart = p.step if p.less is None else 2.0 * p.step
            row |= {name_derivative(of, p.key): (float(more[of]) - float(less[of])) / apart for of in self._of}
        return row

    def is_lost(self, number: int) -> bool:
        """Return whether there is no derivative by a parameter from here on."""
        found = self._sensitivities
        return self._lost[number] or (found is not None and found.is_lost_now(number))

    def add_summary(self, summary: dict[str, Any], history: Mapping[str, Any]) -> dict[str, Any]:
        """Return the contents of summary.json, with the derivatives at the end."""
        last = {
            p.key: {"value": p.value}
            | {of: float(history[name][-1]) for of in self._of if len(history[name := name_derivative(of, p.key)])}
            for p in self._by
        }
        warnings = [*summary["warnings"], *self._warn(history)]
        return summary | {"gradients": last, "gradient_rounds": self.rounds, "warnings": warnings}

    def _warn(self, history: Mapping[str, Any]) -> list[str]:
        """Warn of derivatives that were not found, from which increment on."""
        warnings = []
        for parameter in self._by:
            lost = np.isnan(np.asarray(history[name_derivative(self._of[0], parameter.key)], dtype=float))
            if lost.any():
                warnings.append(
                    f"the derivative by {parameter.key} was not found in increment "
                    f"{int(history['increment'][int(np.argmax(lost))])} and stays away: a smaller "
                    "max_increment or force_tolerance may find it"
                )
        return warnings


def _find_columns(model: Model, columns: Sequence[str]) -> list[str]:
    """Return the requested columns. Raises StartError for an unknown one."""
    assert model.gradients is not None, "the caller has asked"
    measures = [name for name in columns if name not in NO_MEASURES]
    found = list(model.gradients.of or (f"{tool.name}.force" for tool in model.tools))
    for name in found:
        if name not in measures:
            near = difflib.get_close_matches(name, measures, n=1, cutoff=0.4)
            remedy = f"did you mean `{near[0]}`? " if near else ""
            raise StartError(f"gradients.of: the history has no column `{name}`; {remedy}it has {', '.join(measures)}")
    if not found:
        raise StartError(f"gradients.of: name columns; the history has {', '.join(measures)}")
    return found
