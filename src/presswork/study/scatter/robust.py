# SPDX-License-Identifier: Apache-2.0
"""How often a process fails when its inputs scatter, and which input to hold tighter first.

DIR/member_000 ... are the runs, table.csv has a row of each, robust.json what follows from them, robust.png the
picture. A limit is judged by the runs themselves; a surrogate through them (gaussian_process.py) shows which input
makes the scatter, and what half of an input's scatter would bring.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from presswork.api import build
from presswork.case import CaseError, read_case
from presswork.case.errors import Problem
from presswork.model import FloatArray
from presswork.results.whole_file import write_whole
from presswork.study.cluster.connection import Cluster
from presswork.study.measures import Column
from presswork.study.measures_at_hand import check_measures
from presswork.study.open_runner import open_runner
from presswork.study.optimum.study_file import Limit
from presswork.study.runner import Runner
from presswork.study.scatter.draws import Draws, draw_points
from presswork.study.scatter.gaussian_process import GaussianProcess
from presswork.study.scatter.maps import draw_map, map_field
from presswork.study.scatter.statistics import (
    bound_share,
    find_capability,
    find_indices,
    is_beyond,
    share_beyond,
)
from presswork.study.scatter.study_file import ScatterStudy, read_coils, read_study
from presswork.study.sweep import FINISHED, SweepProgress, SweepResult, complete_members
from presswork.study.vary import Member, format_override, make_members

ROBUST, STUDY = "robust.json", "study.toml"
PREDICTED = 2**14
"""Points at which a surrogate stands for runs."""
TRUSTED = 0.5
"""Part of a measure's variance that a surrogate must explain before it is asked."""
FEWEST = 8
"""Runs with a measure that a surrogate needs."""


@dataclass(frozen=True)
class Robustness:
    """Result of a study."""

    sweep: SweepResult
    data: dict[str, Any]
    """What robust.json has."""

    @property
    def is_complete(self) -> bool:
        """Whether every run has ended."""
        return all(member.status in FINISHED for member in self.sweep.members)


def robust(
    study_file: Path | str,
    folder: Path | str,
    *,
    jobs: int = 0,
    cluster: Cluster | str | None = None,
    member_timeout: float | None = None,
    resume: bool = False,
    overwrite: bool = False,
    on_progress: Callable[[SweepProgress], None] | None = None,
) -> Robustness:
    """Run the case of a study file with inputs that scatter, judge it, and write everything to the folder.

    jobs: runs at a time, 0 for one a core; each has one thread. cluster: a Dask cluster that computes them, or the
    address of its scheduler. member_timeout: longest time of a run [s]. A run that gives up counts as beyond every
    limit. Raises CaseError, before anything is run, for a study or case that cannot be used, OutputError for a folder
    that cannot, ClusterError for a cluster that cannot.
    """
    path = Path(study_file)
    study, text = read_study(path)
    draws, points, members, columns = prepare(study, path)
    with open_runner(jobs, cluster, member_timeout) as runner:
        return complete(
            study, draws, points, members, columns, Path(folder), runner, text=text, resume=resume, overwrite=overwrite,
            on_progress=on_progress,
        )  # fmt: skip


def prepare(study: ScatterStudy, study_file: Path) -> tuple[Draws, FloatArray, list[Member], tuple[Column, ...]]:
    """Return the draws, their points (runs, d), the cases and the columns that limits need. Raises CaseError."""
    case_file = study_file.parent / study.case
    read_case(case_file, list(study.set))  # says what is wrong with the case itself, by its own name
    draws = Draws(study, read_coils(study, study_file))
    sampling = study.sampling
    points = draw_points(sampling.runs, draws.dimension, sampling.method, sampling.seed)
    combinations = []
    for row in draws.values_at(points):
        written = {
            key: each.write(float(f"{value:.9g}"))
            for each, value in zip(study.inputs, row, strict=True)
            for key in each.names
        }
        combinations.append((written, [format_override(key, value) for key, value in written.items()]))
    members = make_members(case_file, combinations, list(study.set))
    _refuse_impossible(study, members, study_file)
    first = next(member.case for member in members if member.case is not None)
    columns, _ = check_measures(study.measures, build(first), study_file)
    return draws, points, members, columns


def _refuse_impossible(study: ScatterStudy, members: Sequence[Member], study_file: Path) -> None:
    """Raise CaseError where a draw makes no case: the tail of a distribution reaches where nothing is."""
    bad = [member for member in members if member.case is None]
    if not bad:
        return
    problems = []
    for index, each in enumerate(study.inputs):
        named = [member for member in bad if each.names[0] in member.fault]
        if named:
            values = ", ".join(str(member.values[each.names[0]]) for member in named[:3])
            text = f"{len(named)} of {len(members)} draws make no case ({values}): {named[0].fault}"
            problems.append(Problem(f"inputs.{index}", text, "cut the distribution off by lower and upper"))
    if not problems:
        text = f"{len(bad)} of {len(members)} draws make no case: {bad[0].fault}"
        problems = [Problem("inputs", text, "cut the distributions off by lower and upper")]
    raise CaseError(problems, study_file)


def complete(
    study: ScatterStudy,
    draws: Draws,
    points: FloatArray,
    members: Sequence[Member],
    columns: Sequence[Column],
    folder: Path,
    runner: Runner,
    *,
    text: str = "",
    resume: bool = False,
    overwrite: bool = False,
    on_progress: Callable[[SweepProgress], None] | None = None,
) -> Robustness:
    """Run members by a runner that is open, and judge them; `robust` without its checks."""
    sweep = complete_members(
        members, folder, columns, runner, resume=resume, overwrite=overwrite, on_progress=on_progress
    )
    write_whole(folder / STUDY, text.encode())
    data = judge(study, draws, points, sweep)
    for number, each in enumerate(study.maps):
        ended = [member.folder for member in sweep.members if member.status == "completed"]
        found, fault = map_field(each, ended)
        data["maps"].append({"field": each.field, "fault": fault} if found is None else found.to_data())
        if found is not None:
            draw_map(found, ended[0], folder / f"map_{number}_{each.field}.png")
    write_whole(folder / ROBUST, json.dumps(data, indent=1).encode())
    from presswork.study.scatter.picture import draw_robustness

    draw_robustness(study, data, sweep, folder)
    return Robustness(sweep, data)


def judge(study: ScatterStudy, draws: Draws, points: FloatArray, sweep: SweepResult) -> dict[str, Any]:
    """Return the judgement of every limit by the runs that have ended, as robust.json has it."""
    ended = np.array([member.status in FINISHED for member in sweep.members])
    failed = np.array([member.status in FINISHED and member.status != "completed" for member in sweep.members])
    inputs = draws.values_at(points)
    data: dict[str, Any] = {"runs": int(ended.sum()), "failed": int(failed.sum()), "limits": [], "maps": []}
    for limit in study.limits:
        values = np.array([_read(row.get(limit.measure)) for row in sweep.rows])
        known = ended & ~failed & np.isfinite(values)
        entry = _judge_limit(limit, values[known], int(ended.sum()), int((ended & ~known).sum()))
        if known.sum() >= FEWEST and float(np.ptp(values[known])) > 0.0:
            entry |= _ask_surrogate(study, draws, limit, inputs[known], values[known])
        data["limits"].append(entry)
    return data


def _judge_limit(limit: Limit, values: FloatArray, runs: int, lost: int) -> dict[str, Any]:
    """Return the judgement of a limit by the runs: values of those with the measure (n,), and runs without it."""
    given = {name: getattr(limit, name) for name in ("at_most", "at_least") if getattr(limit, name) is not None}
    entry: dict[str, Any] = {"measure": limit.measure, **given, "runs_without": lost}
    beyond = int(is_beyond(values, limit).sum()) + lost
    entry |= {"beyond": beyond}
    if runs:
        entry |= {"share_beyond": beyond / runs, "share_beyond_at_most": bound_share(beyond, runs)}
    if len(values) > 1:
        found = find_capability(values, limit)
        entry |= {
            "mean": float(values.mean()),
            "deviation": float(values.std(ddof=1)),
            "least": float(values.min()),
            "largest": float(values.max()),
            "cpk": found.cpk,
            "cpk_at_least": found.least,
            "share_beyond_if_normal": share_beyond(found.cpk),
        }
        if values.min() == values.max():
            entry["fault"] = "no input has an effect on it: all runs give the same"
    return entry


def _ask_surrogate(
    study: ScatterStudy, draws: Draws, limit: Limit, inputs: FloatArray, values: FloatArray
) -> dict[str, Any]:
    """Return the share beyond by a surrogate through the runs, and what each input contributes to it."""
    surrogate = GaussianProcess(inputs, values)
    found: dict[str, Any] = {"surrogate_explains": surrogate.explained}
    if surrogate.explained < TRUSTED:
        return found
    points = draw_points(PREDICTED, 2 * draws.dimension, "sobol", study.sampling.seed)
    left, right = points[:, : draws.dimension], points[:, draws.dimension :]
    unsure = np.random.default_rng(study.sampling.seed).standard_normal(PREDICTED)

    def predict(narrowed: int | None = None) -> tuple[float, float]:
        values = draws.values_at(left, narrowed, 0.5)
        predicted = surrogate(values) + surrogate.find_deviation(values) * unsure
        return float(is_beyond(predicted, limit).mean()), float(predicted.std())

    found["share_beyond_by_surrogate"], found["deviation_by_surrogate"] = predict()
    entries: list[dict[str, Any]] = []
    for index, each in enumerate(study.inputs):
        share, deviation = predict(index)
        halved = {"share_beyond_with_half_its_scatter": share, "deviation_with_half_its_scatter": deviation}
        entries.append({"key": each.names[0], **halved})
    if draws.are_independent:
        indices = find_indices(lambda x: surrogate(draws.values_at(x)), left, right)
        order = [*study.drawn, *(index for index, each in enumerate(study.inputs) if each.column)]
        for place, index in enumerate(order):
            entries[index] |= {"first_order": float(indices.first[place]), "total_order": float(indices.total[place])}
    return found | {"inputs": entries}


def _read(value: Any) -> float:
    """Return a number of the table; what is none is not a number."""
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) else math.nan
