# SPDX-License-Identifier: Apache-2.0
"""What commands that compute one case share: its progress, its end in words, and the exit status."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from math import expm1
from pathlib import Path
from typing import Any

import typer
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Column

from presswork.cli.dies import look_at_bodies
from presswork.cli.pictures import show
from presswork.cli.terminal import GAVE_UP, INTERRUPTED, console, refuse
from presswork.outcome import StartError
from presswork.post import judge_result
from presswork.recorder import Outcome
from presswork.recorder import Progress as RunProgress
from presswork.results import OutputError, Result


@contextmanager
def ending(source: Path) -> Iterator[None]:
    """End the program with a plain message and a status if computing the file `source` raises an error."""
    try:
        yield
    except OutputError as error:
        raise refuse(str(error)) from error
    except StartError as error:
        raise refuse(f"{source}: {error}") from error
    except KeyboardInterrupt as error:
        console().print("interrupted: stopped by the user or a signal; all files are whole", style="red", markup=False)
        raise typer.Exit(INTERRUPTED) from error


@contextmanager
def showing_progress(title: str, quiet: bool) -> Iterator[Callable[[RunProgress], None]]:
    """Supply what shows the progress of a run in a bar."""
    columns = (
        TextColumn("{task.description}", table_column=Column(no_wrap=True, overflow="ellipsis", ratio=1)),
        BarColumn(bar_width=16, table_column=Column(no_wrap=True, min_width=16)),
        TextColumn("{task.percentage:>3.0f} %", table_column=Column(no_wrap=True, min_width=5)),
        TimeElapsedColumn(table_column=Column(no_wrap=True, min_width=7)),
        TextColumn("left", table_column=Column(no_wrap=True, min_width=4)),
        TimeRemainingColumn(table_column=Column(no_wrap=True, min_width=7)),
    )
    with Progress(*columns, console=console(), disable=quiet, expand=True) as bar:
        task = bar.add_task(title, total=1.0)
        yield lambda now: bar.update(task, completed=now.fraction, description=now.text)


def finish(outcome: Outcome, *, plot: bool, report: bool, quiet: bool = False) -> None:
    """Print warnings and what was found, draw pictures and page, and leave with the status of a run that stopped."""
    if outcome.has_results:
        result = outcome.result
        _print_summary(result, outcome, quiet)
        if outcome.status == "completed" and not quiet:
            look_at_bodies(result)
        if outcome.status != "interrupted":
            show(result, plot=plot, report=report, quiet=quiet)
    if outcome.status != "completed":
        console().print(f"{outcome.status.replace('_', ' ')}: {outcome.reason}", style="red", markup=False)
        if outcome.has_results:
            console().print(f"what was computed is in {outcome.folder}; its run.log describes the course", markup=False)
        raise typer.Exit(GAVE_UP if outcome.status == "gave_up" else INTERRUPTED)


def _print_summary(result: Result, outcome: Outcome, quiet: bool) -> None:
    summary = result.summary
    for warning in summary["warnings"] if outcome.status == "completed" else []:
        console().print(f"warning: {warning}", style="yellow", markup=False)
    if quiet:
        return
    if "blank" in summary:
        typer.echo(_describe_blank(result))
    if "ended_by" in summary:
        typer.echo(f"ended early: {summary['ended_by']}")
    if "first_crack" in summary:
        typer.echo(describe_crack(summary["first_crack"]))
    if outcome.status == "completed":
        typer.echo(judge_result(result).text())
    console().print(
        f"{summary['work']}, {summary['wall_seconds']['total']:.1f} s; results in {outcome.folder}", markup=False
    )


def describe_crack(crack: Mapping[str, Any]) -> str:
    """Describe the stroke and the place at which a sheet first passed its forming limit.

    >>> describe_crack({"strokes_mm": {"punch": -12.346, "holder": 0.0}, "time_s": 0.4, "at_mm": [1.0, 25.0, -3.0]})
    'first crack after punch -12.35 mm, at (1, 25, -3) mm'
    """
    moved = ", ".join(f"{tool} {stroke:.4g} mm" for tool, stroke in crack["strokes_mm"].items() if stroke)
    place = ", ".join(f"{x:.4g}" for x in crack["at_mm"])
    return f"first crack after {moved or format(crack['time_s'], '.4g') + ' s'}, at ({place}) mm"


def _describe_blank(result: Result) -> str:
    """Return the size of the blank that one step has found, and what forming it takes."""
    blank, judged = result.summary["blank"], result.summary["formability"]
    width, height = blank["extent_mm"]
    thinnest, thickest = result.summary["extremes"]["thickness_strain"]
    strip = blank["strip"]
    size = (
        f"blank {width:.1f} x {height:.1f} mm, {blank['area_mm2']:.0f} mm2; thickness {_percent(thinnest)} to "
        f"{_percent(thickest)}; punch force {result.summary['punch_force_kN']:.1f} kN; "
        f"{strip['utilisation_percent']:.0f} % of a strip {strip['width_mm']:.1f} mm wide"
    )
    return f"{size}\n{judged['verdict']}" + (f"; {judged['paths']}" if judged["least_margin"] else "")


def _percent(strain: float) -> str:
    return f"{100 * expm1(strain):+.1f} %"
