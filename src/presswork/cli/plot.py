# SPDX-License-Identifier: Apache-2.0
"""The command `plot`."""

from __future__ import annotations

from math import atan2, degrees
from pathlib import Path
from typing import Annotated

import typer

from presswork.cli.pictures import draw, overlay
from presswork.cli.terminal import console, refuse
from presswork.fields.table import list_fields
from presswork.post import trace_outline
from presswork.results import OutputError, Result, write_outline

EPILOG = "\n\n".join(["Fields and their units; a run has those of its procedure.", *list_fields()])
"""Ends the help; typer takes square brackets for markup."""


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
            metavar="[X,Y,]ANGLE|X,Y,X,Y",
            help="Draw the section of a sheet along a ray from the origin or from X, Y (mm), at an angle from x "
            "(degrees) or towards a second point, on the undeformed blank; write its thickness as CSV.",
        ),
    ] = None,
    flow_lines: Annotated[
        bool | None,
        typer.Option(
            help="Draw the grain flow of a section, lines of one initial coordinate; default: if it was remeshed.",
            show_default=False,
        ),
    ] = None,
    outline: Annotated[
        Path | None, typer.Option(help="Write the outline of a sheet as .csv or .dxf, at the last of the steps.")
    ] = None,
) -> None:
    """Draw PNG pictures of results: mesh with fields, history, contact stress, forming limit diagram.

    Several folders are drawn over each other, into --out or the folder comparison: force curves, sections, forming
    limit, contact stress. With fields, steps, sections or an outline each is drawn by itself.
    """
    sections = [_read_section(text) for text in section or ()]
    try:
        if len(folders) > 1 and not (field or step or section or outline or flow_lines):
            overlay([Result(folder) for folder in folders], out or Path("comparison"))
            return
        for folder in folders:
            target = out / folder.name if out and len(folders) > 1 else out
            result = Result(folder)
            draw(result, target, fields=field, steps=step, sections=sections, flow_lines=flow_lines)
            if outline:
                path = outline.with_stem(f"{outline.stem}_{folder.name}") if len(folders) > 1 else outline
                write_outline(trace_outline(result, step[-1] if step else -1), path)
                console().print(f"outline in {path}", markup=False)
    except OutputError as error:
        raise refuse(str(error)) from error


def _read_section(text: str) -> tuple[float, float, float]:
    """Return x, y [mm] and angle [degree] of "ANGLE", "X,Y,ANGLE" or "X,Y,X,Y": the point first, then where to."""
    try:
        numbers = [float(number) for number in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) == 4 and numbers[:2] != numbers[2:]:
        numbers = [*numbers[:2], degrees(atan2(numbers[3] - numbers[1], numbers[2] - numbers[0]))]
    if len(numbers) not in (1, 3):
        raise refuse(
            f"--section = {text}: expected ANGLE, X,Y,ANGLE or X,Y,X,Y, for instance 45, 10,0,90 or 10,0,10,50"
        )
    x, y, angle = (0.0, 0.0, *numbers)[-3:]
    return x, y, angle
