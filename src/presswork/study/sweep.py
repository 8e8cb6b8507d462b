# SPDX-License-Identifier: Apache-2.0
"""A family of cases in parallel processes: DIR/member_000 ..., one table, one picture.

Each member has a process of its own, so that one that gives up, or dies, leaves the others alone.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from presswork.case import CaseError
from presswork.case.errors import Problem
from presswork.results import OutputError, Result, load_checkpoint, open_output_folder
from presswork.results.folder import CASE, CHECKPOINT, RESULTS, delete_folder, find_members
from presswork.study.cluster.connection import Cluster
from presswork.study.measures import Column, measure_run, parse_column
from presswork.study.measures_at_hand import check_columns
from presswork.study.open_runner import open_runner
from presswork.study.runner import Ended, Moved, Runner, Started, Task
from presswork.study.table import read_summary, write_table
from presswork.study.vary import Member, format_override, make_members, multiply_out

MemberStatus = Literal["waiting", "running", "completed", "gave_up", "failed", "bad_input", "interrupted"]
TABLE = "table.csv"
FINISHED = ("completed", "gave_up", "failed", "bad_input")


@dataclass(frozen=True)
class SweepProgress:
    """Progress of a sweep, for a display."""

    fraction: float
    """Completed part of the whole sweep."""
    counts: Counter[str]
    """Number of members of each status."""
    total: int


@dataclass(frozen=True)
class MemberResult:
    """Result of one member."""

    number: int
    values: dict[str, Any]
    """The varied keys and their values."""
    status: MemberStatus
    """"failed" is a process that died or could not write; "waiting" one that was never started."""
    reason: str
    folder: Path

    warnings: tuple[str, ...] = ()
    """What its run warns of: laps, cracks and the like."""

    @property
    def result(self) -> Result:
        """Its results. Raises ResultError if there are none."""
        return Result(self.folder)


@dataclass(frozen=True)
class SweepResult:
    """Result of a sweep."""

    folder: Path
    members: tuple[MemberResult, ...]
    rows: tuple[dict[str, Any], ...]
    """The rows of the table."""
    faults: tuple[str, ...] = ()
    """Why the table lacks requested columns."""

    @property
    def counts(self) -> Counter[str]:
        """Number of members that ended with each status."""
        return Counter(member.status for member in self.members)

    @property
    def interrupted(self) -> bool:
        """Whether it was stopped before the last member had ended."""
        return any(member.status not in FINISHED for member in self.members)


def run_sweep(
    case_file: Path | str,
    vary: Mapping[str, Sequence[Any]],
    folder: Path | str,
    *,
    settings: Sequence[str] = (),
    columns: Sequence[str] = (),
    jobs: int = 0,
    cluster: Cluster | str | None = None,
    member_timeout: float | None = None,
    resume: bool = False,
    overwrite: bool = False,
    on_progress: Callable[[SweepProgress], None] | None = None,
) -> SweepResult:
    """Run the full product of the varied keys and write DIR/member_*, table.csv and force_stroke.png.

    The case may be of any kind. vary: keys of the case file, each with its values; settings: `key=value` texts for all
    members. columns: more columns of the table, `max:FIELD` or `min:FIELD` at the last saved step, or `max:`, `min:`,
    `last:` of a column of history.csv. jobs: members that run at a time, 0 for one a core; each has one thread.
    cluster: a Dask cluster that computes them, or the address of its scheduler; its threads are the jobs.
    member_timeout: longest time of a member [s]. A member that gives up or cannot be computed is recorded, and the
    others go on. Ctrl-C stops all at their checkpoints and returns; with `resume` completed members are kept and the
    others go on from there, or start anew. Raises CaseError, before anything is run, if no member can be computed or
    none will have a column, OutputError if the folder cannot be used, and ClusterError if the cluster cannot.
    """
    twice = [key for key in vary if key in {setting.partition("=")[0].strip() for setting in settings}]
    if twice:
        raise CaseError([Problem(key, "both set and varied", "leave one out") for key in twice], case_file)
    combinations = [(values, [format_override(k, v) for k, v in values.items()]) for values in multiply_out(vary)]
    members = make_members(case_file, combinations, settings)
    return run_members(
        members, folder, columns=columns, jobs=jobs, cluster=cluster, member_timeout=member_timeout, resume=resume,
        overwrite=overwrite, on_progress=on_progress,
    )  # fmt: skip


def run_members(
    members: Sequence[Member],
    folder: Path | str,
    *,
    columns: Sequence[str] = (),
    jobs: int = 0,
    cluster: Cluster | str | None = None,
    member_timeout: float | None = None,
    resume: bool = False,
    overwrite: bool = False,
    on_progress: Callable[[SweepProgress], None] | None = None,
) -> SweepResult:
    """Run members that are made already; as run_sweep otherwise."""
    wanted = [parse_column(text) for text in columns]
    check_columns(wanted, members)
    with open_runner(jobs, cluster, member_timeout) as runner:
        return complete_members(
            members, Path(folder), wanted, runner, resume=resume, overwrite=overwrite, on_progress=on_progress
        )


def complete_members(
    members: Sequence[Member],
    folder: Path,
    columns: Sequence[Column],
    runner: Runner,
    *,
    resume: bool = False,
    overwrite: bool = False,
    on_progress: Callable[[SweepProgress], None] | None = None,
) -> SweepResult:
    """Run members by a runner that is open, their columns checked already; as run_sweep otherwise."""
    from presswork.study.sweep_plot import draw_curves

    run = _Sweep(members, _open_folder(folder, members, resume, overwrite), columns, on_progress)
    run.complete(run.plan(resume, overwrite), runner)
    result = run.collect()
    write_table(run.folder / TABLE, result.rows)
    draw_curves(result.members, run.folder)
    return result


def _open_folder(folder: Path, members: Sequence[Member], resume: bool, overwrite: bool) -> Path:
    """Create the sweep's folder, or see that it may be used; with `overwrite` surplus members are deleted."""
    if resume and overwrite:
        raise OutputError("--overwrite and --resume exclude each other: the first deletes what the second continues")
    present = [path for path in find_members(folder, "member_*") if (path / CASE).is_file()]
    if resume and not folder.is_dir():
        raise OutputError(f"there is no {folder} to resume; run without --resume to start anew")
    if present and not (resume or overwrite):
        raise OutputError(
            f"{folder} already holds a sweep ({len(present)} members); choose another folder, "
            "or run with --overwrite to replace it or --resume to continue"
        )
    open_output_folder(folder)  # refuses the results of a single run, and a folder that cannot be written
    wanted = {member.folder_name for member in members if member.case is not None}
    for path in present if overwrite else ():
        if path.name not in wanted:
            delete_folder(path)
    return folder


class _Sweep:
    """One sweep in one folder."""

    def __init__(
        self,
        members: Sequence[Member],
        folder: Path,
        columns: Sequence[Column],
        on_progress: Callable[[SweepProgress], None] | None,
    ) -> None:
        self.members = members
        self.folder = folder
        self.columns = columns
        self.on_progress = on_progress
        self.status: list[MemberStatus] = ["waiting" if m.case is not None else "bad_input" for m in members]
        self.reasons = [m.fault for m in members]
        self.fractions = [0.0 if m.case is not None else 1.0 for m in members]
        self.numbers: list[dict[str, Any]] = [{} for _ in members]
        self.faults: list[list[str]] = [[] for _ in members]
        self.warnings: list[tuple[str, ...]] = [() for _ in members]

    def plan(self, resume: bool, overwrite: bool) -> dict[int, Task]:
        """Return what is to be run, by member; completed members are marked as such."""
        tasks = {}
        for i, member in enumerate(self.members):
            folder = self.folder / member.folder_name
            if member.case is None:
                continue
            mode: Literal["new", "overwrite", "resume"] = "overwrite" if overwrite else "new"
            if resume and folder.is_dir():
                mode = "resume" if self._can_resume(member) else "overwrite"
                if mode == "resume" and read_summary(folder).get("status") == "completed":
                    self._end(i, "completed", "")
                    continue
            tasks[i] = Task(member.case, folder, mode)
        return tasks

    def _can_resume(self, member: Member) -> bool:
        """Return whether there is a run to continue. Raises OutputError if it is that of another case."""
        folder = self.folder / member.folder_name
        if not (folder / RESULTS).is_file():
            return False
        try:
            model: Any = load_checkpoint(folder / CHECKPOINT)[1]["model"]
        except OutputError:
            model = read_summary(folder).get("model")  # one step leaves no checkpoint: it completes, or is run anew
            if model is None:
                return False
        if model != member.model_id:
            raise OutputError(
                f"{folder} belongs to another case ({member.values}): resume with the case, --set and --vary as they "
                "were, or use --overwrite"
            )
        return True

    def _end(self, i: int, status: MemberStatus, reason: str) -> None:
        """Record how a member has ended, and the messages of its run."""
        self.status[i], self.reasons[i], self.fractions[i] = status, reason, 1.0
        folder = self.folder / self.members[i].folder_name
        if status != "bad_input":
            summary = read_summary(folder)
            self.numbers[i], self.faults[i] = measure_run(folder, summary, self.columns)
            self.warnings[i] = tuple(summary.get("warnings", ()))

    def complete(self, tasks: Mapping[int, Task], runner: Runner) -> None:
        """Run the tasks to their end, keeping the table on disk up to date; Ctrl-C stops them and returns."""
        self._report()
        for event in runner.run(tasks):
            match event:
                case Started(i):
                    self.status[i] = "running"
                case Moved(i, fraction, _):
                    self.fractions[i] = fraction
                case Ended(i, status, reason):
                    self._end(i, status, reason)
                    write_table(self.folder / TABLE, self.collect().rows)
            self._report()

    def _report(self) -> None:
        if self.on_progress:
            fraction = sum(self.fractions) / len(self.fractions)
            self.on_progress(SweepProgress(fraction, Counter(self.status), len(self.members)))

    def collect(self) -> SweepResult:
        """Return what is known of every member."""
        results = tuple(
            MemberResult(m.number, m.values, status, reason, self.folder / m.folder_name, warnings)
            for m, status, reason, warnings in zip(self.members, self.status, self.reasons, self.warnings, strict=True)
        )
        rows = tuple(
            {"member": r.folder.name, **r.values, "status": r.status, "reason": r.reason, **numbers}
            for r, numbers in zip(results, self.numbers, strict=True)
        )
        faults = dict.fromkeys(fault for faults in self.faults for fault in faults)
        return SweepResult(self.folder, results, rows, tuple(faults))
