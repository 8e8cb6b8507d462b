# SPDX-License-Identifier: Apache-2.0
"""The commands `sweep` and `calibrate`, with `blank` of blank_command.py.

Exit status: 0 all completed; 2 bad input; 3 a member gave up or died; 130 interrupted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any, Literal

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from presswork.case import CaseError
from presswork.case.errors import Problem
from presswork.results import OutputError
from presswork.study.blank_command import add_command as add_blank_command
from presswork.study.calibrate import SYMBOLS, BorePlace, Calibration, FrictionLaw, calibrate_ring
from presswork.study.sweep import TABLE, SweepProgress, SweepResult, run_sweep
from presswork.study.table import require_pyarrow, write_parquet
from presswork.study.vary import parse_variation

BAD_INPUT, GAVE_UP, INTERRUPTED = 2, 3, 130

console = Console(stderr=True, highlight=False, soft_wrap=True)
calibrate_app = typer.Typer(help="Find a parameter from measured tests.", no_args_is_help=True)

Settings = Annotated[
    list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Change a key of the case, for all members.")
]
Jobs = Annotated[int, typer.Option(min=0, help="Members at a time; 0 for one a core. Each has one thread.")]
Resume = Annotated[bool, typer.Option("--resume", help="Keep completed members and continue the others.")]
Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace the members in the folder.")]
Quiet = Annotated[bool, typer.Option("--quiet", help="No progress, errors only.")]


def add_commands(app: typer.Typer) -> None:
    """Give the commands to the command line."""
    app.command()(sweep)
    app.add_typer(calibrate_app, name="calibrate")
    add_blank_command(app)


def sweep(
    case: Annotated[Path, typer.Argument(help="The case file (TOML).", show_default=False)],
    vary: Annotated[
        list[str],
        typer.Option(
            "--vary",
            metavar="KEY=A:B:N | KEY=V1,V2",
            help="N values from A to B, or a list; several --vary give every combination.",
            show_default=False,
        ),
    ],
    set_: Settings = None,
    output: Annotated[Path | None, typer.Option(help="Folder; default: the case's name with _sweep.")] = None,
    column: Annotated[
        list[str] | None,
        typer.Option(
            metavar="max:FIELD | min:FIELD | last:HISTORY",
            help="One more column of the table: extreme of a field at the last step, or of a column of history.csv.",
        ),
    ] = None,
    jobs: Jobs = 0,
    table_format: Annotated[
        Literal["csv", "parquet"], typer.Option(help="parquet: leave table.parquet beside table.csv.")
    ] = "csv",
    resume: Resume = False,
    overwrite: Overwrite = False,
    quiet: Quiet = False,
) -> None:
    """Run a family of cases in parallel, and leave one table and one picture."""
    folder = output or case.with_name(f"{case.stem}_sweep")
    with _errors_told():
        if table_format == "parquet":
            require_pyarrow()  # before anything is run
        varied: dict[str, list[Any]] = {}
        for text in vary:
            key, values = parse_variation(text)
            if key in varied:
                raise CaseError([Problem(key, "varied twice", "give all its values in one --vary")], case)
            varied[key] = values
        with _progress_shown(case.stem, quiet) as show:
            result = run_sweep(
                case,
                varied,
                folder,
                settings=set_ or [],
                columns=column or [],
                jobs=jobs,
                resume=resume,
                overwrite=overwrite,
                on_progress=show,
            )
        if table_format == "parquet":
            write_parquet(result.folder / TABLE.replace("csv", "parquet"), result.rows)
    _report_members(result, quiet)


def _report_members(result: SweepResult, quiet: bool) -> None:
    """Say which members did not complete, and leave with the status that it asks for."""
    for member in result.members:
        if member.status in ("bad_input", "gave_up", "failed"):
            values = ", ".join(f"{key} = {value}" for key, value in member.values.items())
            text = f"{member.folder.name} ({values}): {member.status.replace('_', ' ')}: {member.reason}"
            console.print(text, style="red", markup=False)
    for fault in result.faults:
        console.print(f"no column {fault}", style="red", markup=False)
    counts = result.counts
    if not quiet:
        console.print(
            f"{counts['completed']} of {len(result.members)} completed; {result.folder / TABLE}", markup=False
        )
    if result.interrupted:
        console.print(f"interrupted: continue with --resume; {result.folder / TABLE} says how far it is", style="red")
        raise typer.Exit(INTERRUPTED)
    if counts["gave_up"] or counts["failed"]:
        raise typer.Exit(GAVE_UP)
    if counts["bad_input"] or result.faults:
        raise typer.Exit(BAD_INPUT)


@calibrate_app.callback()
def _calibrate() -> None:
    """Find a parameter from measured tests."""


@calibrate_app.command()
def ring(
    measured: Annotated[
        Path,
        typer.Argument(
            help="CSV with height_reduction (or height_reduction_percent) and bore_ratio (or bore_diameter_mm).",
            show_default=False,
        ),
    ],
    case: Annotated[Path, typer.Option(help="The ring compression (TOML).", show_default=False)],
    law: Annotated[FrictionLaw, typer.Option(help="Constant shear (m) or Coulomb (mu).")] = "shear",
    values: Annotated[
        str, typer.Option(metavar="V1,V2,...", help="Friction values of the curves; default: ten of them.")
    ] = "",
    bore: Annotated[
        BorePlace, typer.Option(help="What was measured: mean over the height, or at mid-height.")
    ] = "mean",
    set_: Settings = None,
    output: Annotated[Path | None, typer.Option(help="Folder; default: measured file's name, _calibration.")] = None,
    jobs: Jobs = 0,
    resume: Resume = False,
    overwrite: Overwrite = False,
    quiet: Quiet = False,
) -> None:
    """Fit friction to a measured ring test: the value, its 95 % confidence, and the picture."""
    folder = output or measured.with_name(f"{measured.stem}_calibration")
    with _errors_told(), _progress_shown("calibration curves", quiet) as show:
        calibration = calibrate_ring(
            measured,
            case,
            folder,
            law=law,
            values=_read_values(values),
            bore=bore,
            settings=set_ or [],
            jobs=jobs,
            resume=resume,
            overwrite=overwrite,
            on_progress=show,
        )
    if calibration is None:
        console.print("interrupted: continue with --resume", style="red")
        raise typer.Exit(INTERRUPTED)
    _report_fit(calibration)


def _read_values(text: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",") if part.strip()]
    except ValueError:
        raise CaseError([Problem("--values", f"`{text}` are no numbers", "write --values 0,0.1,0.2")]) from None


def _report_fit(calibration: Calibration) -> None:
    fit = calibration.fit
    symbol = SYMBOLS[calibration.law]
    text = f"{symbol} = {fit.friction:.4f}"
    if len(fit.residuals) > 1:
        low, high = fit.interval
        text += f", 95 % confidence {low:.4f} to {high:.4f}; scatter of the bore ratio {fit.scatter:.4f}"
    typer.echo(f"{text}; {len(fit.residuals)} point{'s' * (len(fit.residuals) > 1)}")
    for warning in fit.warnings:
        typer.echo(f"warning: {warning}")
    console.print(f"calibration.png and calibration.json in {calibration.folder}", markup=False)


@contextmanager
def _errors_told() -> Iterator[None]:
    """Have bad input and unusable folders said plainly, with exit status 2."""
    try:
        yield
    except (CaseError, OutputError) as error:
        console.print(f"error: {error}", style="red", markup=False)
        raise typer.Exit(BAD_INPUT) from error


@contextmanager
def _progress_shown(title: str, quiet: bool) -> Iterator[Callable[[SweepProgress], None]]:
    """Give what shows one bar for all members."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, disable=quiet) as bar:
        task = bar.add_task(title, total=1.0)

        def show(progress: SweepProgress) -> None:
            counts = progress.counts
            bad = counts["gave_up"] + counts["failed"] + counts["bad_input"]
            text = f"{title}: {counts['completed']} of {progress.total} done, {counts['running']} running"
            bar.update(task, completed=progress.fraction, description=text + (f", {bad} failed" if bad else ""))

        yield show
