# SPDX-License-Identifier: Apache-2.0
"""Derivatives of a study's measures by its variables, as its runs find them ([gradients] of the case)."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.api import build
from presswork.case import CaseError, read_case
from presswork.case.errors import Problem
from presswork.case.gradients import find_number
from presswork.model import FloatArray
from presswork.recorder import StartError, write_start
from presswork.results.history import name_derivative
from presswork.study.measures import parse_column
from presswork.study.optimum.study_file import Study
from presswork.study.vary import format_override

_AT_THE_END = ("max_thinning_percent",)
"""Measures that are columns of the history under the same name, in its last row."""


@dataclass(frozen=True)
class _Source:
    """Where a measure's value stands in the history."""

    column: str
    row: str
    """last, max, min, or largest: of the absolute values."""

    def find(self, values: FloatArray) -> int:
        """Return the row."""
        if self.row == "last":
            return len(values) - 1
        if self.row == "largest":
            return int(np.argmax(np.abs(values)))
        return int(np.argmax(values) if self.row == "max" else np.argmin(values))


@dataclass(frozen=True)
class Slopes:
    """How the derivatives of a study's measures follow from those of a run's history."""

    sources: Mapping[str, _Source]
    """Sources by measure."""
    keys: tuple[tuple[str, ...], ...]
    """Keys of the case, by variable."""
    ranges: FloatArray
    """Ranges of the variables, in the units of the history (n_variables,)."""

    @property
    def override(self) -> str:
        """What the case is given so that its runs find the derivatives."""
        columns = dict.fromkeys(source.column for source in self.sources.values())
        by = [key for keys in self.keys for key in keys]
        return format_override("gradients", {"by": by, "of": list(columns)})

    def measure(self, history: Mapping[str, NDArray[Any]]) -> dict[str, FloatArray]:
        """Return the slopes of every measure over the variables' ranges (n_variables,); NaN where none was found."""
        found = {}
        for measure, source in self.sources.items():
            row = source.find(np.asarray(history[source.column], dtype=float))
            by = [sum(float(history[name_derivative(source.column, k)][row]) for k in keys) for keys in self.keys]
            found[measure] = np.array(by) * self.ranges
        return found


def find_slopes(study: Study, case_file: Path, columns: Sequence[str]) -> Slopes:
    """Return the derivatives of a study's measures. columns: of the history of its runs.

    Raises CaseError for what has none: a measure that is no column of the history, a case without derivatives.
    """
    first = [variable.first for variable in study.variables]
    sources, problems = {}, []
    for measure, key in study.measures.items():
        source = _find_source(measure, columns)
        if source is None:
            text = f"`{measure}` is not a column of the history, so its runs find no derivatives of it"
            problems.append(Problem(key, text, 'set search.slopes = "differences"'))
        else:
            sources[measure] = source
    if problems:
        raise CaseError(problems)
    case = read_case(case_file, study.write_overrides(first))
    ranges = []
    for index, variable in enumerate(study.variables):
        ends = []
        for bound in variable.bounds:
            values = [*first[:index], bound, *first[index + 1 :]]
            ends.append(find_number(read_case(case_file, study.write_overrides(values)), variable.names[0]))
        ranges.append(ends[1] - ends[0])
    slopes = Slopes(sources, tuple(variable.names for variable in study.variables), np.array(ranges))
    case = read_case(case_file, [*study.write_overrides(first), slopes.override])
    try:
        with tempfile.TemporaryDirectory() as folder:
            write_start(build(case), Path(folder))  # type: ignore[arg-type]
    except StartError as error:
        raise CaseError([Problem("", str(error), 'set search.slopes = "differences"')], case_file) from error
    return slopes


def _find_source(measure: str, columns: Sequence[str]) -> _Source | None:
    """Return where a measure's value stands in a history of these columns; None where it does not."""
    if ":" in measure:
        column = parse_column(measure)
        return _Source(column.name, column.extreme) if column.name in columns else None
    tool, _, quantity = measure.rpartition(".")
    if measure in _AT_THE_END and measure in columns:
        return _Source(measure, "last")
    if f"{tool}.stroke" not in columns:
        return None
    if quantity == "max_force":
        return _Source(f"{tool}.force", "largest")
    return _Source(measure, "last") if quantity in ("force", "stroke") else None
