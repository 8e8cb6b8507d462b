# SPDX-License-Identifier: Apache-2.0
"""The commands `materials` and `material plot`. Exit status: 0, or 2 for bad input."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from presswork.case.errors import CaseError
from presswork.material.library import find_sheet, list_sheets
from presswork.material.sheet_plot import draw_sheet

BAD_INPUT = 2

console = Console(stderr=True, highlight=False, soft_wrap=True)
material_app = typer.Typer(help="Sheet materials at a point.", no_args_is_help=True)

Name = Annotated[str, typer.Argument(help="A material of the library, or a material file.", show_default=False)]


def add_commands(app: typer.Typer) -> None:
    """Give the commands to the command line."""
    app.command()(materials)
    app.add_typer(material_app, name="material")


def materials() -> None:
    """List the sheet materials of the library."""
    for sheet in list_sheets():
        typer.echo(f"{sheet.key:26s} {sheet.name}: {sheet.summary}")


@material_app.command()
def plot(
    name: Name,
    output: Annotated[Path | None, typer.Option(help="The picture; default: the material's name here.")] = None,
) -> None:
    """Draw a material: yield locus, yield stress and r-value by direction, flow stress."""
    with _errors_told():
        sheet = find_sheet(name)
        typer.echo(draw_sheet(sheet, output or Path(f"{sheet.key}.png")))


@contextmanager
def _errors_told() -> Iterator[None]:
    """Have bad input said plainly, with exit status 2."""
    try:
        yield
    except (CaseError, ImportError) as error:
        console.print(f"error: {error}", style="red", markup=False)
        raise typer.Exit(BAD_INPUT) from error
