# SPDX-License-Identifier: Apache-2.0
"""The command `run`.

Exit status: 0 the whole process was computed; 2 bad input or output folder; 3 the solver gave up; 130 interrupted.
"""

from __future__ import annotations

import signal
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from presswork.cli.case_files import load_model
from presswork.cli.pictures import show
from presswork.cli.terminal import GAVE_UP, INTERRUPTED, CaseFile, RunUserCode, Settings, console, exit_on, refuse
from presswork.model import Model, OneStepModel
from presswork.process.begin import begin
from presswork.process.on_ranks import begin_on_ranks
from presswork.ranks.world import RanksError, World, find_world
from presswork.recorder import Outcome, Progress, StartError, run_model
from presswork.results import OutputError, Result


def run(
    case: CaseFile,
    output: Annotated[Path | None, typer.Option(help="Output folder; default: the case's name beside it.")] = None,
    set_: Settings = None,
    resume: Annotated[bool, typer.Option("--resume", help="Continue from the folder's checkpoint.")] = False,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace results in the folder.")] = False,
    threads: Annotated[
        int, typer.Option(min=0, help="Threads; 0 uses every core. The results do not depend on it.")
    ] = 0,
    device: Annotated[
        str | None,
        typer.Option(
            metavar="cpu|cuda|host",
            help="What computes the cycles of an explicit run: the CPU, an NVIDIA card, or the card's code on the CPU; "
            "as --set explicit.device=.",
        ),
    ] = None,
    plot: Annotated[bool, typer.Option(help="Draw the pictures at the end.")] = True,
    report: Annotated[bool, typer.Option(help="Write the page for the browser at the end.")] = True,
    quiet: Annotated[bool, typer.Option("--quiet", help="No progress, errors only.")] = False,
    run_user_code: RunUserCode = False,
) -> None:
    """Compute a case, draw its pictures and write its page for the browser."""
    folder = output or case.with_suffix("")
    with exit_on(RanksError):
        world = find_world()
    if world is not None and world.rank > 0:
        console().quiet = quiet = True
    model = load_model(case, [*(set_ or []), *([f"explicit.device={device}"] if device else [])], folder)
    if isinstance(model, OneStepModel):
        if world is not None:
            raise refuse("a one-step run takes seconds and is not divided over ranks: run it without mpiexec")
        if resume:
            raise refuse("a one-step run takes seconds and leaves nothing to resume; run it anew with --overwrite")
        result = _run_onestep(model, folder, overwrite, threads, quiet)
        with exit_on(OutputError):
            show(result, plot=plot, report=report, quiet=quiet)
        return
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        outcome = _compute(model, folder, overwrite, resume, threads, quiet, world)
        if world is not None and world.rank > 0:
            return
        if outcome.status != "interrupted":
            show(outcome.result, plot=plot, report=report, quiet=quiet)
    except OutputError as error:
        raise refuse(str(error)) from error
    except StartError as error:
        raise refuse(f"{case}: {error}") from error
    except KeyboardInterrupt as error:
        console().print("interrupted: stopped by the user or a signal; all files are whole", style="red", markup=False)
        raise typer.Exit(INTERRUPTED) from error
    if outcome.status != "completed":
        console().print(f"{outcome.status.replace('_', ' ')}: {outcome.reason}", style="red", markup=False)
        console().print(f"what was computed is in {folder}; run.log there says how it went", markup=False)
        raise typer.Exit(GAVE_UP if outcome.status == "gave_up" else INTERRUPTED)


def _run_onestep(model: OneStepModel, folder: Path, overwrite: bool, threads: int, quiet: bool) -> Result:
    """Find a blank."""
    from presswork.cli.onestep import compute
    from presswork.mesh import MeshError
    from presswork.onestep.part import OneStepError

    try:
        return compute(model, folder, overwrite=overwrite, threads=threads, quiet=quiet)
    except OneStepError as error:
        console().print(f"gave up: {error}", style="red", markup=False)
        raise typer.Exit(GAVE_UP) from error
    except (OutputError, MeshError) as error:
        raise refuse(str(error)) from error


def _compute(
    model: Model, folder: Path, overwrite: bool, resume: bool, threads: int, quiet: bool, world: World | None
) -> Outcome:
    from rich import progress
    from rich.table import Column

    columns = (
        progress.TextColumn("{task.description}", table_column=Column(no_wrap=True, overflow="ellipsis", ratio=1)),
        progress.BarColumn(bar_width=16, table_column=Column(no_wrap=True, min_width=16)),
        progress.TextColumn("{task.percentage:>3.0f} %", table_column=Column(no_wrap=True, min_width=5)),
        progress.TimeElapsedColumn(table_column=Column(no_wrap=True, min_width=7)),
        progress.TextColumn("left", table_column=Column(no_wrap=True, min_width=4)),
        progress.TimeRemainingColumn(table_column=Column(no_wrap=True, min_width=7)),
    )
    with progress.Progress(*columns, console=console(), disable=quiet, expand=True) as bar:
        task = bar.add_task(model.title, total=1.0)

        def show(now: Progress) -> None:
            bar.update(task, completed=now.fraction, description=now.text)

        begin_run = begin if world is None else partial(begin_on_ranks, world=world)
        outcome = run_model(
            model,
            folder,
            overwrite=overwrite,
            resume=resume,
            threads=threads,
            on_increment=show,
            procedure=begin_run,
            world=world,
        )
    if world is not None and world.rank > 0:
        return outcome
    s = outcome.result.summary
    for warning in s["warnings"] if outcome.status == "completed" else []:
        console().print(f"warning: {warning}", style="yellow", markup=False)
    if not quiet:
        console().print(
            f"{s['work']}, {s['wall_seconds']['total']:.1f} s; results in {folder}",
            markup=False,
        )
    return outcome
