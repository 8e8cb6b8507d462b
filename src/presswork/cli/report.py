# SPDX-License-Identifier: Apache-2.0
"""The command `report`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from presswork.cli.terminal import console, exit_on
from presswork.results import OutputError, Result

NAME = "report.html"
"""File name of the page in an output folder."""


def report(
    folders: Annotated[list[Path], typer.Argument(help="Output folders.", show_default=False)],
    out: Annotated[
        Path | None, typer.Option(help=f"The page; default: DIR/{NAME}; of several runs: comparison/{NAME}.")
    ] = None,
    size: Annotated[
        float,
        typer.Option(min=2, help="Megabytes at most; what does not fit is left out, and named."),
    ] = 20.0,
) -> None:
    """Write one page for the browser: the part in 3D with its fields over time, curves, forming limit, case.

    The page holds everything and needs no network, so it can be sent by mail. Several folders are compared in one page.
    """
    from presswork.report import write_report

    with exit_on(OutputError):
        results = [Result(folder) for folder in folders]
        path = write_report(results, out or _default_path(folders), budget=int(1e6 * size))
    console().print(f"{path}, {path.stat().st_size / 1e6:.1f} MB", markup=False)


def _default_path(folders: list[Path]) -> Path:
    """Return where the page goes; a folder for a comparison is made."""
    if len(folders) == 1:
        return folders[0] / NAME
    folder = Path("comparison")
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise OutputError(
            f"{folder} cannot be created: {error.strerror or error}; give the page's path by --out"
        ) from error
    return folder / NAME
