# SPDX-License-Identifier: Apache-2.0
"""The command line. Exit status: 0 the whole process was computed; 2 bad input or output folder; 3 the solver gave up;
130 interrupted."""

from __future__ import annotations

import json
import signal
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Column

from presswork import CaseError, OutputError, Result, __version__, build_model
from presswork.case import describe, json_schema, read_case
from presswork.case.onestep import OneStepCase, build_onestep_model
from presswork.examples import copy_example, list_examples
from presswork.material.commands import add_commands as add_material_commands
from presswork.mesh import MeshError
from presswork.mesh.part_file import UndercutError
from presswork.model_onestep import OneStepModel
from presswork.model_stamping import AnyModel
from presswork.onestep.commands import add_commands as add_onestep_commands
from presswork.onestep.commands import compute as compute_onestep
from presswork.onestep.part import OneStepError
from presswork.post import trace_outline
from presswork.procedure.begin import check_start
from presswork.recorder import Outcome, StartError, run_model
from presswork.recorder import Progress as RunProgress
from presswork.results import write_outline
from presswork.study.commands import add_commands

BAD_INPUT, GAVE_UP, INTERRUPTED = 2, 3, 130

app = typer.Typer(
    help="Simulate metal forming: a short case file in, force, flow, strain and contact stress out.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
console = Console(stderr=True, highlight=False, soft_wrap=True)

CaseFile = Annotated[Path, typer.Argument(help="The case file (TOML).", show_default=False)]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="KEY=VALUE", help="Change a key of the case, e.g. --set workpiece.mesh.cells=[30,30]."
    ),
]


def _load(
    case_file: Path, settings: list[str] | None, folder: Path | None = None, *, run_user_code: bool = True
) -> AnyModel | OneStepModel:
    """Build the model of a case file. folder: for a picture of what is refused, if that can be drawn."""
    try:
        case = read_case(case_file, overrides=settings or [])
        return (
            build_onestep_model(case)
            if isinstance(case, OneStepCase)
            else build_model(case, run_user_code=run_user_code)
        )
    except CaseError as error:
        raise _refuse(f"{error}{_picture_undercut(error, folder)}") from error


def _picture_undercut(error: CaseError, folder: Path | None) -> str:
    """Draw the part that is refused for its undercut; return where, as the end of the message."""
    cause = error.__cause__
    if folder is None or not isinstance(cause, UndercutError):
        return ""
    from presswork.view.part_plot import draw_undercut

    path = folder / "undercut.png"
    try:
        folder.mkdir(exist_ok=True)
        draw_undercut(cause.points, cause.triangles, cause.over, path)
    except (ImportError, OSError, OutputError) as failure:
        return f"; no picture: {failure}"
    return f"; {path} shows where"


def _refuse(message: str) -> typer.Exit:
    console.print(f"error: {message}", style="red", markup=False)
    return typer.Exit(BAD_INPUT)


@app.command()
def run(
    case: CaseFile,
    output: Annotated[Path | None, typer.Option(help="Output folder; default: the case's name beside it.")] = None,
    set_: Settings = None,
    resume: Annotated[bool, typer.Option("--resume", help="Continue from the folder's checkpoint.")] = False,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace results in the folder.")] = False,
    threads: Annotated[
        int, typer.Option(min=0, help="Threads; 0 uses every core. The results do not depend on it.")
    ] = 0,
    plot: Annotated[bool, typer.Option(help="Draw the pictures at the end.")] = True,
    quiet: Annotated[bool, typer.Option("--quiet", help="No progress, errors only.")] = False,
) -> None:
    """Compute a case and draw its pictures."""
    folder = output or case.with_suffix("")
    model = _load(case, set_, folder)
    if isinstance(model, OneStepModel):
        if resume:
            raise _refuse("a one-step run takes seconds and leaves nothing to resume; run it anew with --overwrite")
        _run_onestep(model, folder, overwrite, threads, plot, quiet)
        return
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        outcome = _compute(model, folder, overwrite, resume, threads, quiet)
        if plot and outcome.status != "interrupted":
            _draw(outcome.result, None, quiet=quiet)
    except (OutputError, StartError) as error:
        raise _refuse(str(error)) from error
    except KeyboardInterrupt as error:
        console.print("interrupted: stopped by the user or a signal; all files are whole", style="red", markup=False)
        raise typer.Exit(INTERRUPTED) from error
    if outcome.status != "completed":
        console.print(f"{outcome.status.replace('_', ' ')}: {outcome.reason}", style="red", markup=False)
        console.print(f"what was computed is in {folder}; run.log there says how it went", markup=False)
        raise typer.Exit(GAVE_UP if outcome.status == "gave_up" else INTERRUPTED)


def _run_onestep(model: OneStepModel, folder: Path, overwrite: bool, threads: int, plot: bool, quiet: bool) -> None:
    """Find a blank."""
    try:
        result = compute_onestep(model, folder, overwrite=overwrite, threads=threads, quiet=quiet)
        if plot:
            _draw(result, None, quiet=quiet)
    except OneStepError as error:
        console.print(f"gave up: {error}", style="red", markup=False)
        raise typer.Exit(GAVE_UP) from error
    except (OutputError, MeshError) as error:
        raise _refuse(str(error)) from error


def _compute(model: AnyModel, folder: Path, overwrite: bool, resume: bool, threads: int, quiet: bool) -> Outcome:
    columns = (
        TextColumn("{task.description}", table_column=Column(no_wrap=True, overflow="ellipsis", ratio=1)),
        BarColumn(bar_width=16, table_column=Column(no_wrap=True, min_width=16)),
        TextColumn("{task.percentage:>3.0f} %", table_column=Column(no_wrap=True, min_width=5)),
        TimeElapsedColumn(table_column=Column(no_wrap=True, min_width=7)),
        TextColumn("left", table_column=Column(no_wrap=True, min_width=4)),
        TimeRemainingColumn(table_column=Column(no_wrap=True, min_width=7)),
    )
    with Progress(*columns, console=console, disable=quiet, expand=True) as bar:
        task = bar.add_task(model.title, total=1.0)

        def show(progress: RunProgress) -> None:
            bar.update(task, completed=progress.fraction, description=progress.text)

        outcome = run_model(model, folder, overwrite=overwrite, resume=resume, threads=threads, on_increment=show)
    s = outcome.result.summary
    for warning in s["warnings"] if outcome.status == "completed" else []:
        console.print(f"warning: {warning}", style="yellow", markup=False)
    if not quiet:
        console.print(
            f"{s['work']}, {s['wall_seconds']['total']:.1f} s; results in {folder}",
            markup=False,
        )
    return outcome


def _draw(
    result: Result,
    out: Path | None,
    *,
    quiet: bool = False,
    fields: list[str] | None = None,
    steps: list[int] | None = None,
    sections: list[tuple[float, float, float]] | None = None,
) -> None:
    from presswork.view import plot_all

    try:
        paths = plot_all(result, out, fields, steps or "last", sections=sections or ())
    except ImportError as error:
        console.print(f"no pictures: {error}", markup=False)
        return
    if not quiet and paths:
        console.print(f"{len(paths)} pictures in {paths[0].parent}", markup=False)
    if not quiet and (verdict := result.summary.get("formability")):
        console.print(f"at the end: {verdict['verdict']}", markup=False)


def _overlay(results: list[Result], out: Path) -> None:
    from presswork.view.overlay_plot import plot_overlays

    try:
        paths = plot_overlays(results, out)
    except ImportError as error:
        console.print(f"no pictures: {error}", markup=False)
        return
    found = (
        f"{len(paths)} pictures in {out}" if paths else "nothing to draw over each other: these runs share no quantity"
    )
    console.print(found, markup=False)


@app.command()
def check(
    case: CaseFile,
    set_: Settings = None,
    run_user_code: Annotated[
        bool, typer.Option("--run-user-code", help="Open and try the libraries (umat) that the case names.")
    ] = False,
) -> None:
    """Validate a case and say in words what would be computed; code that it names runs only if asked for."""
    model = _load(case, set_, run_user_code=run_user_code)
    typer.echo(describe(model))
    if isinstance(model, OneStepModel):
        return
    if not run_user_code and any(material.umat for material in model.materials):
        typer.echo("not opened: the libraries of its materials, whose code would run; --run-user-code tries them")
        return
    try:
        check_start(model)
    except StartError as error:
        raise _refuse(str(error)) from error


@app.command()
def plot(
    folders: Annotated[list[Path], typer.Argument(help="Output folders.", show_default=False)],
    field: Annotated[
        list[str] | None,
        typer.Option(help="Fields to draw; default: effective stress and strain, of a sheet also its strains."),
    ] = None,
    step: Annotated[list[int] | None, typer.Option(help="Saved steps to draw, from 0, or from the end: -1.")] = None,
    out: Annotated[
        Path | None, typer.Option(help="Where to write; default: DIR/plots; of several runs: comparison.")
    ] = None,
    section: Annotated[
        list[str] | None,
        typer.Option(
            metavar="[X,Y,]ANGLE",
            help="Of a sheet: draw the section along a ray at an angle from x [degree], from the origin or from X, Y "
            "[mm]; write its thickness as CSV.",
        ),
    ] = None,
    outline: Annotated[
        Path | None, typer.Option(help="Of a sheet: write its outline as .csv or .dxf, at the last of the steps.")
    ] = None,
) -> None:
    """Draw PNG pictures of results: mesh with fields, history, contact stress, forming limit diagram.

    Several folders are drawn over each other, into --out or the folder comparison: force curves, sections, forming
    limit, contact stress. With fields, steps, sections or an outline each is drawn by itself.
    """
    sections = [_read_section(text) for text in section or ()]
    try:
        if len(folders) > 1 and not (field or step or section or outline):
            _overlay([Result(folder) for folder in folders], out or Path("comparison"))
            return
        for folder in folders:
            target = out / folder.name if out and len(folders) > 1 else out
            result = Result(folder)
            _draw(result, target, fields=field, steps=step, sections=sections)
            if outline:
                path = outline.with_stem(f"{outline.stem}_{folder.name}") if len(folders) > 1 else outline
                write_outline(trace_outline(result, step[-1] if step else -1), path)
                console.print(f"outline in {path}", markup=False)
    except OutputError as error:
        raise _refuse(str(error)) from error


def _read_section(text: str) -> tuple[float, float, float]:
    """Return x, y [mm] and angle [degree] of "ANGLE" or "X,Y,ANGLE"."""
    try:
        numbers = [float(number) for number in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in (1, 3):
        raise _refuse(f"--section = {text}: expected ANGLE or X,Y,ANGLE, for instance 45 or 10,0,90")
    x, y, angle = (0.0, 0.0, *numbers)[-3:]
    return x, y, angle


@app.command()
def examples(
    name: Annotated[
        str | None, typer.Argument(help="The example to copy; none lists them.", show_default=False)
    ] = None,
    to: Annotated[Path, typer.Option(help="Folder to copy into.")] = Path(),
) -> None:
    """List the example cases, or copy one here."""
    if name is None:
        for example, title in list_examples().items():
            typer.echo(f"{example:20s} {title}")
        return
    try:
        typer.echo(copy_example(name, to))
    except CaseError as error:
        raise _refuse(str(error)) from error


@app.command()
def schema(
    kind: Annotated[
        str | None,
        typer.Argument(help="solid, shell, stamping or onestep; none: all kinds of case.", show_default=False),
    ] = None,
) -> None:
    """Print the JSON schema of case files, for editors that complete them."""
    try:
        typer.echo(json.dumps(json_schema(kind), indent=2))
    except CaseError as error:
        raise _refuse(str(error)) from error


add_commands(app)
add_material_commands(app)
add_onestep_commands(app, lambda result: _draw(result, None), _picture_undercut)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"presswork {__version__}")
        raise typer.Exit


@app.callback()
def main(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print it.")
    ] = False,
) -> None:
    """Hold the options that come before a command."""
