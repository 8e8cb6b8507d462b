# SPDX-License-Identifier: Apache-2.0
"""The runs of an optimisation in one folder: each point computed once, kept, and found again when resumed."""

from __future__ import annotations

import contextlib
import itertools
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from presswork.api import build, identify
from presswork.case import CaseError, read_case
from presswork.model import FloatArray
from presswork.results import OutputError, Result, load_checkpoint, open_output_folder
from presswork.results.folder import CASE, CHECKPOINT, RESULTS, delete_folder, find_members
from presswork.study.measures import Column, measure_run
from presswork.study.member_process import Mode
from presswork.study.optimum.search import Outcome, SpentError
from presswork.study.optimum.slopes import Slopes
from presswork.study.optimum.study_file import Study
from presswork.study.runner import Ended, Moved, Runner, Started, Task
from presswork.study.sweep import MemberStatus, SweepProgress
from presswork.study.table import read_summary, write_table

if TYPE_CHECKING:
    from presswork.case.any_case import AnyCase

TABLE = "table.csv"
_KEPT = ("completed", "gave_up")
"""Ends that a case comes to again, so that a study that is resumed keeps them."""


@dataclass
class Run:
    """One run of the study."""

    number: int
    folder: Path
    values: dict[str, float]
    """Values of the variables by their keys, in the units of the study file."""
    x: FloatArray
    """The same as parts of the bounds' ranges (n_variables,)."""
    case_text: str = ""
    """The case file, to be run from anywhere; empty of a case that cannot be read."""
    status: MemberStatus = "waiting"
    reason: str = ""
    """Why it has no results, or why they do not count."""
    measures: dict[str, Any] = field(default_factory=dict)
    outcome: Outcome | None = None

    @property
    def is_feasible(self) -> bool:
        """Whether it keeps all limits."""
        return self.outcome is not None and self.outcome.is_feasible


class StudyRuns:
    """Runs of a study by the points of the unit box, in a folder that holds those of before."""

    def __init__(
        self,
        study: Study,
        study_file: Path,
        folder: Path,
        columns: Sequence[Column],
        runner: Runner,
        *,
        slopes: Slopes | None = None,
        on_progress: Callable[[SweepProgress], None] | None = None,
        on_round: Callable[[Sequence[Run]], object] | None = None,
    ) -> None:
        self.study, self.study_file, self.folder, self.columns, self.runner = study, study_file, folder, columns, runner
        self.on_progress, self.on_round, self.slopes = on_progress, on_round, slopes
        self.runs: list[Run] = []
        self._by_values: dict[tuple[float, ...], Run] = {}
        self._kept = find_kept_runs(folder)
        self._fractions: dict[int, float] = {}
        self._cases: dict[int, AnyCase] = {}

    def evaluate(self, points: Sequence[FloatArray]) -> list[Outcome]:
        """Return the outcomes of points (n_variables,) of the unit box, those that are new run in parallel.

        Raises SpentError when all runs are used, KeyboardInterrupt when stopped by the user or a signal, CaseError if a
        run that has completed lacks a measure.
        """
        asked = [self.study.values_at(point) for point in points]
        new = list(dict.fromkeys(values for values in asked if values not in self._by_values))
        room = self.study.search.runs - len(self.runs)
        for values in new[:room]:
            self._by_values[values] = self._add(values)
        self._complete([self._by_values[values] for values in new[:room]])
        if len(new) > room:
            raise SpentError
        found = [self._by_values[values].outcome for values in asked]
        return [outcome for outcome in found if outcome is not None]

    def _add(self, values: tuple[float, ...]) -> Run:
        """Make the run of some values; of a case that cannot be computed one that has ended already."""
        named = {v.names[0]: value for v, value in zip(self.study.variables, values, strict=True)}
        run = Run(0, self.folder, named, self.study.place_of(values))
        model_id = ""
        try:
            case = self._read(values)
            run.case_text = case.text
            if self.slopes is not None:
                with contextlib.suppress(CaseError):  # a number at an end of its range: this run finds none
                    case = self._read(values, self.slopes.override)
            model_id = identify(case)
        except CaseError as error:
            run.status, run.reason = "bad_input", "; ".join(str(problem) for problem in error.problems)
        used = {other.number for other in self.runs}
        free = next(n for n in itertools.count() if n not in used and n not in self._kept.values())
        kept = self._kept.get(model_id, free)
        run.number = free if kept in used else kept
        run.folder = self.folder / f"run_{run.number:03d}"
        self.runs.append(run)
        if run.status != "bad_input":
            self._cases[run.number] = case
        return run

    def _read(self, values: tuple[float, ...], *more: str) -> AnyCase:
        """Return the case with some values. Raises CaseError where it cannot be computed."""
        case = read_case(self.study_file.parent / self.study.case, [*self.study.write_overrides(values), *more])
        if more:
            build(case)
        return case

    def _complete(self, runs: Sequence[Run]) -> None:
        """Run what has not been run, and take the outcomes."""
        tasks = {}
        for run in runs:
            if run.status == "bad_input":
                continue
            mode = _choose_mode(run.folder)
            summary = read_summary(run.folder)
            if run.number in self._kept.values() and summary.get("status") in _KEPT:
                run.status, run.reason = summary["status"], str(summary.get("reason", ""))
            else:
                tasks[run.number] = Task(self._cases[run.number], run.folder, mode)
        numbered = {run.number: run for run in runs}
        self._report()
        for event in self.runner.run(tasks) if tasks else ():
            match event:
                case Started(i):
                    numbered[i].status = "running"
                case Moved(i, fraction, _):
                    self._fractions[i] = fraction
                case Ended(i, status, reason):
                    numbered[i].status, numbered[i].reason = status, reason
            self._report()
        if any(run.status in ("waiting", "running", "interrupted") for run in runs):
            self.write()
            raise KeyboardInterrupt
        for run in runs:
            self._measure(run)
            self._cases.pop(run.number, None)
        self.write()

    def _measure(self, run: Run) -> None:
        """Take the outcome of a run that has ended."""
        study, faults = self.study, list[str]()
        if run.status != "bad_input":
            run.measures, faults = measure_run(run.folder, read_summary(run.folder), self.columns)
            for variable in study.variables:
                run.measures |= dict.fromkeys(variable.names, run.values[variable.names[0]])
        sides = [(limit.measure, *side) for limit in study.limits for side in limit.sides]
        run.outcome = Outcome(run.x, float("nan"), np.full(len(sides), np.nan))
        if run.status != "completed":
            return
        lacking = [name for name in study.measures if not _is_number(run.measures.get(name))]
        if lacking:
            run.reason = "; ".join(faults) or f"the run has no {', '.join(lacking)}"
            return
        values = {name: float(run.measures[name]) for name in study.measures}
        goal = sum(goal.factor * values[goal.measure] for goal in study.goals)
        excess = np.array([sign * (values[name] - value) for name, sign, value in sides])
        run.outcome = Outcome(
            run.x, goal, excess, *self._measure_slopes(run, [(name, sign) for name, sign, _ in sides])
        )
        run.reason = "; ".join(
            f"{name} = {values[name]:.6g} is {'above' if sign > 0 else 'below'} {value:g}"
            for (name, sign, value), by in zip(sides, excess, strict=True)
            if by > 0.0
        )

    def _measure_slopes(
        self, run: Run, sides: Sequence[tuple[str, float]]
    ) -> tuple[FloatArray | None, FloatArray | None]:
        """Return the slopes of goal and sides that a run has found, if it has."""
        if self.slopes is None:
            return None, None
        try:
            by_measure = self.slopes.measure(Result(run.folder).history)
        except KeyError:
            return None, None
        if not all(np.isfinite(slope).all() for slope in by_measure.values()):
            return None, None
        slope = sum((goal.factor * by_measure[goal.measure] for goal in self.study.goals), np.zeros(len(run.x)))
        rows = [sign * by_measure[name] for name, sign in sides]
        return slope, np.array(rows).reshape(-1, len(run.x))

    def write(self) -> None:
        """Bring the table on disk up to date."""
        write_table(self.folder / TABLE, [self.row(run) for run in sorted(self.runs, key=lambda run: run.number)])
        if self.on_round:
            self.on_round(self.runs)

    def row(self, run: Run) -> dict[str, Any]:
        """Return a run's row of the table."""
        units = {v.names[0]: v.unit for v in self.study.variables}
        known = run.outcome is not None and run.outcome.is_known
        asked = {name: run.measures.get(name) for name in self.study.measures}
        return {
            "run": f"run_{run.number:03d}",
            **{f"{key} [{units[key]}]" if units[key] else key: value for key, value in run.values.items()},
            "status": run.status,
            "feasible": run.is_feasible,
            "reason": run.reason,
            "goal": run.outcome.goal if known and run.outcome else None,
            **asked,
            **{name: value for name, value in run.measures.items() if name not in asked},
        }

    def _report(self) -> None:
        if self.on_progress:
            done = sum(1.0 if run.outcome else self._fractions.get(run.number, 0.0) for run in self.runs)
            total = self.study.search.runs
            self.on_progress(SweepProgress(done / total, Counter(run.status for run in self.runs), total))


def open_study_folder(folder: Path, resume: bool, overwrite: bool) -> Path:
    """Create the study's folder, or see that it may be used. Raises OutputError."""
    if resume and overwrite:
        raise OutputError("--overwrite and --resume exclude each other: the first deletes what the second continues")
    present = [path for path in find_members(folder, "run_*") if (path / CASE).is_file()]
    if resume and not folder.is_dir():
        raise OutputError(f"there is no {folder} to resume; run without --resume to start anew")
    if present and not (resume or overwrite):
        raise OutputError(
            f"{folder} already holds a study ({len(present)} runs); choose another folder, "
            "or run with --overwrite to replace it or --resume to continue"
        )
    open_output_folder(folder)
    for path in present if overwrite else ():
        delete_folder(path)
    return folder


def find_kept_runs(folder: Path) -> dict[str, int]:
    """Return the numbers of the runs in a folder by the fingerprints of their models."""
    kept: dict[str, int] = {}
    for path in sorted(folder.glob("run_*")):
        number = path.name.removeprefix("run_")
        model = _read_model_id(path) if number.isdigit() else None
        if model is not None:
            kept.setdefault(model, int(number))
    return kept


def _read_model_id(folder: Path) -> str | None:
    """Return the fingerprint of a run's model; None if there is no run to keep."""
    if not (folder / RESULTS).is_file():
        return None
    try:
        found: Any = load_checkpoint(folder / CHECKPOINT)[1].get("model")
    except OutputError:
        found = read_summary(folder).get("model")  # one step leaves no checkpoint
    return None if found is None else str(found)


def _choose_mode(folder: Path) -> Mode:
    """Choose how a run begins in its folder, which never holds one of another model."""
    if not folder.is_dir():
        return "new"
    return "resume" if _read_model_id(folder) is not None and (folder / CHECKPOINT).is_file() else "overwrite"


def _is_number(value: object) -> bool:
    return isinstance(value, int | float | np.number) and bool(np.isfinite(value))
