# SPDX-License-Identifier: Apache-2.0
"""The command `dies`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from presswork.cli.case_files import reading
from presswork.cli.terminal import console, exit_on
from presswork.results import OutputError, Result

if TYPE_CHECKING:
    from presswork.case.plane.die_body import DieBody
    from presswork.dies.study import DieStudy


def dies(
    folder: Annotated[
        Path, typer.Argument(help="Output folder of a run in the plane or in axisymmetry.", show_default=False)
    ],
    tool: Annotated[
        list[str] | None, typer.Option("--tool", help="Tools to look at; without it: all that have a body.")
    ] = None,
    at: Annotated[
        list[float] | None,
        typer.Option("--at", help="Part of the run, 0 to 1; the nearest saved step is taken. Several may be given."),
    ] = None,
    body: Annotated[
        Path | None, typer.Option(help="TOML file with [tools.NAME.body], instead of the case's own.")
    ] = None,
) -> None:
    """Find the stress of a tool's body after a run, with its rings, and whether it holds.

    Without --at all saved steps are looked at. Writes dies_NAME.csv to the folder, and
    a picture of it beside its others.
    """
    from presswork.case.plane.die_body import read_bodies

    with exit_on(OutputError), reading():
        result = Result(folder)
        for name, own in read_bodies(body or folder / "case.toml", tool).items():
            _look_at(result, name, own, at=at or ())


def look_at_bodies(result: Result) -> None:
    """Find the stress of all tools with a body at the end of a run; what does not fit is a warning."""
    from presswork.case import CaseError

    path = result.folder / "case.toml"
    if not path.is_file() or "body" not in path.read_text("utf-8"):
        return
    from presswork.case.plane.die_body import has_bodies, read_bodies

    if not has_bodies(path):
        return
    try:
        for name, own in read_bodies(path).items():
            _look_at(result, name, own)
    except (CaseError, OutputError) as error:
        console().print(f"warning: {error}", style="yellow", markup=False)


def _look_at(result: Result, tool: str, body: DieBody, *, at: Sequence[float] = ()) -> None:
    """Write table and picture of a die; print warnings and whether it holds."""
    from presswork.dies.study import study_die
    from presswork.dies.table import describe, write_table

    study = study_die(result, tool, body.build(), at=at)
    write_table(study, result.folder / f"dies_{tool}.csv")
    _draw(study, result.folder)
    for warning in study.warnings:
        console().print(f"warning: {warning}", style="yellow", markup=False)
    for line in describe(study):
        typer.echo(line)


def _draw(study: DieStudy, folder: Path) -> None:
    """Write the picture, where matplotlib is there."""
    try:
        from presswork.view.plots.die_body_plot import plot_die
        from presswork.view.style import create_folder, save_picture
    except ImportError:
        return
    create_folder(folder / "plots")
    save_picture(plot_die(study), folder / "plots" / f"dies_{study.tool}.png")
