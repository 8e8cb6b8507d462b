# SPDX-License-Identifier: Apache-2.0
"""The command `animate`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from presswork.cli.terminal import console, exit_on
from presswork.results import OutputError, Result
from presswork.results.folder import PLOTS, refuse_link


def animate(
    folder: Annotated[Path, typer.Argument(help="Output folder.", show_default=False)],
    field: Annotated[str | None, typer.Option(help="Field; default: the first that pictures show.")] = None,
    out: Annotated[
        Path | None,
        typer.Option(help="The film, .gif or .mp4; default: DIR/plots/FIELD.gif, without a field film.gif."),
    ] = None,
    seconds: Annotated[float, typer.Option(min=0.1, help="Length of the film.")] = 5.0,
) -> None:
    """Write a film of a run, GIF or MP4: the part with a field, a picture a saved step."""
    from presswork.view.animation import animate as write_film
    from presswork.view.style import create_folder

    with exit_on(OutputError, ImportError):
        result = Result(folder)
        if out is None:
            refuse_link(folder / PLOTS)
            create_folder(folder / PLOTS)
        path = write_film(result, out or folder / PLOTS / f"{field or 'film'}.gif", field, seconds=seconds)
    console().print(f"{path}, {path.stat().st_size / 1e6:.1f} MB", markup=False)
