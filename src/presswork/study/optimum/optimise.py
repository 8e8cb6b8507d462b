# SPDX-License-Identifier: Apache-2.0
"""The best case within limits: variables of a case between bounds, goals and limits by what its runs measure.

DIR/run_000 ... are the runs; table.csv has a row of each, progress.png shows them, best.toml is the case of the best
one. A study that is resumed asks for the same runs and finds those that are there.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import monotonic
from typing import Literal

import numpy as np

from presswork.api import build
from presswork.case import CaseError, read_case
from presswork.case.errors import Problem
from presswork.model import Model, OneStepModel
from presswork.results.whole_file import write_whole
from presswork.study.cluster.connection import Cluster
from presswork.study.measures import Column
from presswork.study.measures_at_hand import check_measures
from presswork.study.open_runner import open_runner
from presswork.study.optimum.gradient import search_by_gradient
from presswork.study.optimum.runs import Run, StudyRuns, open_study_folder
from presswork.study.optimum.search import SpentError, find_best
from presswork.study.optimum.slopes import Slopes, find_slopes
from presswork.study.optimum.study_file import Study, read_study
from presswork.study.optimum.surrogate import search_by_surrogate
from presswork.study.runner import Runner
from presswork.study.sweep import SweepProgress

BEST, STUDY = "best.toml", "study.toml"
_DRAW_EVERY = 10.0
"""Seconds from picture to picture."""


@dataclass(frozen=True)
class Optimum:
    """Result of an optimisation."""

    status: Literal["completed", "gave_up", "interrupted"]
    """"gave_up": no run keeps the limits."""
    reason: str
    """Reason why it ended before it was certain that nothing better is near; empty if it was."""
    folder: Path
    runs: tuple[Run, ...]
    best: Run | None
    """The run of the least goal within all limits."""


def optimise(
    study_file: Path | str,
    folder: Path | str,
    *,
    jobs: int = 0,
    cluster: Cluster | str | None = None,
    member_timeout: float | None = None,
    resume: bool = False,
    overwrite: bool = False,
    on_progress: Callable[[SweepProgress], None] | None = None,
) -> Optimum:
    """Find the values of the variables that a study file asks for, and write everything to the folder.

    jobs: runs at a time, 0 for one a core; each has one thread. cluster: a Dask cluster that computes them, or the
    address of its scheduler. member_timeout: longest time of a run [s]. A run that gives up or cannot be computed
    counts as infeasible. With `resume` the runs that are there are kept, also where the study's goals, limits or number
    of runs have been changed. Raises CaseError, before anything is run, for a study or case that cannot be used,
    OutputError for a folder that cannot, ClusterError for a cluster that cannot.
    """
    study, text = read_study(study_file)
    columns, slopes = check_study(study, Path(study_file))
    with open_runner(jobs, cluster, member_timeout) as runner:
        place = open_study_folder(Path(folder), resume, overwrite)
        _write(place / STUDY, text)
        return search(study, Path(study_file), place, columns, runner, on_progress, slopes)


def check_study(study: Study, study_file: Path) -> tuple[tuple[Column, ...], Slopes | None]:
    """Return the columns that the study's measures need, and their derivatives, if the runs are to find them.

    Raises CaseError for what its case does not have.
    """
    problems = []
    case_file = study_file.parent / study.case
    read_case(case_file, list(study.set))  # reports faults of the case itself, by its own name
    first = [variable.first for variable in study.variables]
    for index, variable in enumerate(study.variables):
        for name, bound in zip(("lower", "upper"), variable.bounds, strict=True):
            values = [*first[:index], bound, *first[index + 1 :]]
            try:
                read_case(case_file, study.write_overrides(values))
            except CaseError as error:
                text = f"{', '.join(variable.names)} = {variable.write(bound)} is not possible in {case_file}"
                wording = "; ".join(str(problem) for problem in error.problems)
                problems.append(Problem(f"variables.{index}.{name}", text, wording))
                break
    if problems:
        raise CaseError(problems, study_file)
    try:
        model: Model | OneStepModel = build(read_case(case_file, study.write_overrides(first)))
    except CaseError as error:
        wording = "; ".join(str(problem) for problem in error.problems)
        remedy = "give every variable a start from which the case can be computed"
        text = f"the first run cannot be computed: {wording}"
        raise CaseError([Problem("variables", text, remedy)], study_file) from None
    measured = {name: key for name, key in study.measures.items() if name not in study.variable_names}
    columns, history = check_measures(measured, model, study_file)
    slopes, asked = None, study.search.slopes
    jumps = isinstance(model, Model) and model.analysis == "stamping"  # nodes come to tools one by one
    if study.search.method == "gradient" and (asked == "exact" or (asked == "auto" and not jumps)):
        try:
            slopes = find_slopes(study, case_file, history)
        except CaseError as error:
            if asked == "exact":
                raise CaseError(error.problems, study_file) from None
    return columns, slopes


def search(
    study: Study,
    study_file: Path,
    folder: Path,
    columns: Sequence[Column],
    runner: Runner,
    on_progress: Callable[[SweepProgress], None] | None = None,
    slopes: Slopes | None = None,
) -> Optimum:
    """Look for the optimum by the study's method; `optimise` without its checks, for a runner that is open."""
    from presswork.study.optimum.progress_plot import draw_progress

    drawn = monotonic()

    def draw(found: Sequence[Run]) -> None:
        nonlocal drawn
        if monotonic() - drawn > _DRAW_EVERY:
            draw_progress(study, found, folder)
            drawn = monotonic()

    runs = StudyRuns(study, study_file, folder, columns, runner, slopes=slopes, on_progress=on_progress, on_round=draw)
    wanted = study.search
    start = study.place_of([variable.first for variable in study.variables])
    status: Literal["completed", "gave_up", "interrupted"] = "completed"
    reason = ""
    try:
        if wanted.method == "surrogate":
            search_by_surrogate(runs.evaluate, start, together=wanted.together, tolerance=wanted.tolerance)
        else:
            reason = search_by_gradient(runs.evaluate, start, step=wanted.step, tolerance=wanted.tolerance)
    except SpentError:
        reason = f"all {wanted.runs} runs are used; search.runs allows more, and --resume keeps these"
    except KeyboardInterrupt:
        status, reason = "interrupted", "stopped by the user or a signal; continue with --resume"
    draw_progress(study, runs.runs, folder)
    place = find_best([run.outcome for run in runs.runs if run.outcome])
    best = None if place is None else [run for run in runs.runs if run.outcome][place]
    if best is not None:
        _write(folder / BEST, best.case_text)
    else:
        (folder / BEST).unlink(missing_ok=True)
        if status == "completed":
            status, reason = "gave_up", _explain_none(runs.runs, reason)
    return Optimum(status, reason, folder, tuple(runs.runs), best)


def _explain_none(runs: Sequence[Run], reason: str) -> str:
    """Explain why no run is feasible, by the one that comes nearest."""
    known = [run for run in runs if run.outcome and run.outcome.is_known]
    if not known:
        return f"none of {len(runs)} runs has results; {runs[0].folder.name}: {runs[0].reason}"
    nearest = min(known, key=lambda run: float(np.maximum(run.outcome.excess, 0.0).sum()) if run.outcome else np.inf)
    text = f"no run of {len(runs)} keeps all limits; nearest, {nearest.folder.name}: {nearest.reason}"
    return f"{text}; {reason}" if reason else text


def _write(path: Path, text: str) -> None:
    content = text.encode()
    write_whole(path, content)
