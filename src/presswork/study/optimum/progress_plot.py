# SPDX-License-Identifier: Apache-2.0
"""progress.png: the goal run by run, over each variable, and against what is limited."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from presswork.results import OutputError
from presswork.study.optimum.search import find_best
from presswork.study.optimum.study_file import Limit, Study, Variable
from presswork.view.style import save_picture

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from presswork.study.optimum.runs import Run

PICTURE = "progress.png"
_FEASIBLE, _PASSED, _FAILED, _BEST = "#1f6fb2", "#9aa3ad", "#c8102e", "#e08a00"
_MOST = 8
"""Panels of variables and limits."""


def draw_progress(study: Study, runs: Sequence[Run], folder: Path) -> Path | None:
    """Draw all runs that have ended; None without matplotlib, or if none has results."""
    ended = sorted((run for run in runs if run.outcome), key=lambda run: run.number)
    known = [run for run in ended if run.outcome and run.outcome.is_known]
    try:
        from matplotlib.figure import Figure
    except ImportError:
        return None
    if not known:
        return None
    panels: list[Variable | str] = [*study.variables, *dict.fromkeys(limit.measure for limit in study.limits)]
    panels = panels[:_MOST]
    columns = min(1 + len(panels), 3)
    rows = -(-(1 + len(panels)) // columns)
    figure = Figure(figsize=(4.2 * columns, 3.4 * rows), layout="constrained")
    axes = list(np.ravel(figure.subplots(rows, columns, squeeze=False)))
    place = find_best([run.outcome for run in known if run.outcome])
    best = None if place is None else known[place]
    _draw_history(axes[0], study, ended, best)
    for ax, panel in zip(axes[1:], panels, strict=False):
        if isinstance(panel, str):
            _scatter(ax, study, known, [float(run.measures[panel]) for run in known], best)
            ax.set_xlabel(panel)
            _mark_limits(ax, [limit for limit in study.limits if limit.measure == panel])
        else:
            name = panel.names[0]
            _scatter(ax, study, known, [run.values[name] for run in known], best)
            ax.set_xlabel(_wrap(name) + (f" [{panel.unit}]" if panel.unit else ""))
    for ax in axes[1 + len(panels) :]:
        ax.set_axis_off()
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper left", ncols=len(labels), frameon=False, fontsize="small")
    try:
        return save_picture(figure, folder / PICTURE)
    except OutputError:
        return None


def _draw_history(ax: Axes, study: Study, runs: Sequence[Run], best: Run | None) -> None:
    """Draw the goal by the number of the run, with the best so far; runs without results as crosses below."""
    known = [run for run in runs if run.outcome and run.outcome.is_known]
    for is_feasible, colour, label in ((True, _FEASIBLE, "within limits"), (False, _PASSED, "limits passed")):
        chosen = [run for run in known if run.is_feasible == is_feasible]
        face = colour if is_feasible else "none"
        ax.scatter(
            [run.number for run in chosen], [_goal(study, run) for run in chosen], s=26, facecolors=face,
            edgecolors=colour, label=label, zorder=3,
        )  # fmt: skip
    failed = [run.number for run in runs if run not in known]
    if failed:
        ax.scatter(
            failed, [0.03] * len(failed), marker="x", s=26, color=_FAILED, label="without results",
            transform=ax.get_xaxis_transform(),
        )  # fmt: skip
    feasible = [run for run in known if run.is_feasible]
    if feasible and best is not None:
        so_far = [min(feasible[: i + 1], key=_sum_of_goals) for i in range(len(feasible))]
        numbers = [run.number for run in feasible] + [max(run.number for run in runs)]
        goals = [_goal(study, run) for run in [*so_far, so_far[-1]]]
        ax.step(numbers, goals, where="post", color=_BEST, linewidth=1.2, label="best yet")
        ax.scatter([best.number], [_goal(study, best)], s=110, facecolors="none", edgecolors=_BEST, label="best")
    ax.set_xlabel("run")
    ax.set_ylabel(_name_of_goal(study))
    ax.locator_params(axis="x", integer=True)


def _scatter(ax: Axes, study: Study, runs: Sequence[Run], values: Sequence[float], best: Run | None) -> None:
    """Draw the goal of runs over values of theirs."""
    for run, value in zip(runs, values, strict=True):
        colour = _FEASIBLE if run.is_feasible else _PASSED
        ax.scatter(value, _goal(study, run), s=26, facecolors=colour if run.is_feasible else "none", edgecolors=colour)
        if run is best:
            ax.scatter(value, _goal(study, run), s=110, facecolors="none", edgecolors=_BEST)
    ax.set_ylabel(_name_of_goal(study))


def _mark_limits(ax: Axes, limits: Sequence[Limit]) -> None:
    """Shade what lies beyond limits."""
    low, high = ax.get_xlim()
    for limit in limits:
        for sign, value in limit.sides:
            low, high = min(low, value - 0.05 * (high - low)), max(high, value + 0.05 * (high - low))
            ax.axvline(value, color=_FAILED, linewidth=0.9)
            ax.axvspan(value, value + sign * 1e3 * (high - low), color=_FAILED, alpha=0.08, linewidth=0)
    ax.set_xlim(low, high)


def _sum_of_goals(run: Run) -> float:
    return run.outcome.goal if run.outcome else float("inf")


def _goal(study: Study, run: Run) -> float:
    """Return what is drawn of the goals: the one measure itself, or the sum of several."""
    return float(run.measures[study.goals[0].measure]) if len(study.goals) == 1 else _sum_of_goals(run)


def _name_of_goal(study: Study) -> str:
    return study.goals[0].measure if len(study.goals) == 1 else "sum of goals"


def _wrap(key: str) -> str:
    """Break a long key after its middle."""
    parts = key.split(".")
    if len(key) <= 30 or len(parts) < 2:
        return key
    half = len(parts) // 2
    return ".".join(parts[:half]) + ".\n" + ".".join(parts[half:])
