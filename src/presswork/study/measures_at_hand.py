# SPDX-License-Identifier: Apache-2.0
"""The measures that runs of a case will have, known from its start before anything is computed."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from presswork.api import build
from presswork.case import CaseError
from presswork.case.errors import Problem, suggest
from presswork.fields.surface_defects import FOLD
from presswork.fields.table import find_row
from presswork.formability import PATH_MARGINS, POLAR
from presswork.model import Model, OneStepModel
from presswork.outcome import StartError
from presswork.recorder import write_start
from presswork.results import Result, ResultError
from presswork.study.measures import Column, parse_column
from presswork.study.vary import Member

_ALWAYS = (
    "fraction_computed", "increments", "iterations", "cutbacks", "wall_seconds",
    "max_equivalent_plastic_strain", "max_effective_stress",
)  # fmt: skip
STAGE = "stage"
"""The column of history.csv that is a text."""
_ONE_STEP = ("punch.force", "blank_area", "strip_utilisation_percent")


def check_measures(
    measures: Mapping[str, str], model: Model | OneStepModel, study_file: Path
) -> tuple[tuple[Column, ...], tuple[str, ...]]:
    """Return the columns among measures, and those of the history; measures: each with the key of the study file that
    names it.

    Raises CaseError, with every one that the runs of the model will not have.
    """
    with tempfile.TemporaryDirectory() as folder:
        start = _Start(model, Path(folder))
        problems, columns = [], []
        for measure, key in measures.items():
            try:
                column = start.find(measure)
            except CaseError as error:
                problems += [Problem(key, p.expected, p.remedy, measure) for p in error.problems]
                continue
            columns += [column] if column else []
    if problems:
        raise CaseError(problems, study_file)
    return tuple(columns), tuple(start.history)


def check_columns(columns: Sequence[Column], members: Sequence[Member]) -> None:
    """Raise CaseError, before anything is run, for columns that none of the members will have.

    A member that cannot start is passed over.
    """
    missing, found = list(columns), dict[Column, str]()
    for member in members:
        if not missing:
            return
        if member.case is None:
            continue
        try:
            with tempfile.TemporaryDirectory() as folder:
                start = _Start(build(member.case), Path(folder))
                faults = {column: start.explain_missing(column) for column in missing}
        except (CaseError, StartError):
            continue
        found = {column: found.get(column, fault) for column, fault in faults.items() if fault}
        missing = list(found)
    if found:
        problems = [Problem("--column", f"{column.title}: {fault}", "") for column, fault in found.items()]
        raise CaseError(problems)


class _Start:
    """The start of a run, and what can be measured of it."""

    def __init__(self, model: Model | OneStepModel, folder: Path) -> None:
        self.result: Result | None = None
        self._is_complete = isinstance(model, Model) and model.analysis in ("stamping", "shell")
        """Whether no field comes later: sheets get no new meshes, with which some of solids begin."""
        self.history: list[str] = ["iteration", "unbalanced"]
        names = list(_ALWAYS)
        if isinstance(model, OneStepModel):
            names += [*_ONE_STEP, "max_thinning_percent"]
            names += ["min_forming_limit_margin", "cracked_cells"] if model.material.formability.curve else []
        else:
            self.history = write_start(model, folder)
            self.result = Result(folder)
            names += self._of_process(model)
        self.names = names

    def _of_process(self, model: Model) -> list[str]:
        """Return the names of the table of a process in time."""
        assert self.result is not None
        fields, names = self.result.field_names, []
        for column in self.history:
            tool, _, quantity = column.rpartition(".")
            names += [column, f"{tool}.force", f"{tool}.max_force"] if tool and quantity == "stroke" else []
        names += ["max_thinning_percent"] if "thinning" in fields else []
        names += ["min_forming_limit_margin", "cracked_cells"] if "forming_limit_margin" in fields else []
        names += ["max_fold_ratio", "folds"] if FOLD in fields else []
        names += [f"min_{margin}" for margin in PATH_MARGINS if margin in fields]
        names += ["cracked_cells_by_path"] if POLAR in fields else []
        names += ["min_temperature", "max_temperature"] if "temperature" in fields else []
        names += ["min_draw_in", "max_draw_in"] if self.result.is_stamping else []
        names += ["wrinkle_height"] if _has_pushed_holder(model) else []
        springs = model.springback or any(operation.springback for operation in model.following)
        names += ["max_springback", "min_deviation", "max_deviation"] if springs else []
        return names

    def find(self, measure: str) -> Column | None:
        """Return the column of a measure, None of one that every row has. Raises CaseError if there is no such one."""
        if measure in self.names:
            return None
        if ":" not in measure:
            remedy = suggest(measure, self.names, "measures of this case")
            remedy += "; or max:FIELD, min:FIELD, last:COLUMN of history.csv"
            raise CaseError([Problem("", "the runs of this case have no such measure", remedy)])
        column = parse_column(measure)
        if fault := self.explain_missing(column):
            raise CaseError([Problem("", *fault.split("; ", 1))])
        return column

    def explain_missing(self, column: Column) -> str:
        """Return why the runs will not have a column, with the remedy behind a semicolon; empty: they may have it."""
        if column.name in self.history:
            return "" if column.name != STAGE else f"{STAGE} is not a number; name another column of history.csv"
        missing = f"the runs of this case have no {column.name}"
        if column.extreme == "last":
            return f"{missing}; {suggest(column.name, self.history, 'columns of history.csv')}"
        if self.result is None:
            return "" if find_row(column.name) is not None else f"{missing}; {suggest(column.name, [], 'fields')}"
        try:
            self.result.scalar(column.name)
        except ResultError as error:
            if column.name in self.result.field_names:
                return str(error)
            if find_row(column.name) is None or self._is_complete:
                return f"{missing}; {suggest(column.name, list(self.result.field_names), 'fields')}"
        return ""


def _has_pushed_holder(model: Model) -> bool:
    """Return whether a force pushes a flat blank's holder, or the die against it."""
    kinds = {tool.name: tool.kind for tool in model.tools}
    pushed = {kinds.get(name) for stage in model.stages for name, motion in stage.tool_motion.items() if motion.push}
    return model.formed is None and "holder" in kinds.values() and bool(pushed & {"holder", "die"})
