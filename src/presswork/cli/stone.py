# SPDX-License-Identifier: Apache-2.0
"""The command `stone`."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
import typer

from presswork.cli.terminal import console, exit_on
from presswork.results import OutputError, Result, ResultError

if TYPE_CHECKING:
    from presswork.post.stoning import Stoning


def stone(
    folder: Annotated[Path, typer.Argument(help="Output folder of a run of a sheet.", show_default=False)],
    length: Annotated[float, typer.Option(help="Length of the stone [mm].")] = 100.0,
    direction: Annotated[Literal["x", "y", "both"], typer.Option(help="Along which it is drawn.")] = "both",
    side: Annotated[Literal["top", "bottom"], typer.Option(help="Face that is seen: top is that of larger z.")] = "top",
    spacing: Annotated[float, typer.Option(help="Spacing of the places that are judged [mm].")] = 2.0,
    step: Annotated[int, typer.Option(help="Saved step, from 0, or from the end: -1.")] = -1,
    less_formed: Annotated[
        bool, typer.Option(help="Take off the gaps of the part as it was formed, before springback.")
    ] = False,
    mirror: Annotated[
        Literal["", "x", "y", "xy"],
        typer.Option(help="Symmetry planes through the origin that cut the part; those of stampings are known."),
    ] = "",
    shows: Annotated[float, typer.Option(help="Gap that shows on paint [mm].")] = 0.02,
    refused: Annotated[float, typer.Option(help="Gap for which a panel is refused [mm].")] = 0.1,
) -> None:
    """Draw a stone over a panel: where it would not touch, and by how much.

    Writes stoning_x.csv and stoning_y.csv to the folder, and pictures of them beside its others.
    """
    from presswork.post.stoning import stone as draw_stone

    with exit_on(OutputError):
        if not 0.0 < shows < refused:
            raise ResultError(f"shows = {shows:g} mm, refused = {refused:g} mm: give 0 < shows < refused")
        result = Result(folder)
        for along in ("x", "y") if direction == "both" else (direction,):
            found = draw_stone(
                result, length=length, direction=along, side=side, spacing=spacing, step=step, less_formed=less_formed,
                mirror=mirror,
            )  # fmt: skip
            _write(found, folder / f"stoning_{along}.csv")
            title = f"stone of {length:g} mm along {along}, {side}" + (", less as formed" if less_formed else "")
            _draw(found, folder, f"stoning_{along}.png", shows, refused, title)
            known = found.gap[np.isfinite(found.gap)]
            largest, x, y = found.worst
            shares = (f"{100 * (known > gap).mean():.3g} % of the places beyond {gap:g} mm" for gap in (shows, refused))
            beyond = ", ".join(shares)
            console().print(f"{title}: largest gap {largest:.4f} mm at ({x:.4g}, {y:.4g}) mm; {beyond}", markup=False)


def _write(found: Stoning, path: Path) -> None:
    """Write places and gaps [mm]."""
    from presswork.results.whole_file import write_whole

    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["x_mm", "y_mm", "gap_mm"])
    for i, j in np.argwhere(np.isfinite(found.gap)):
        writer.writerow([f"{found.x[i]:.6g}", f"{found.y[j]:.6g}", f"{found.gap[i, j]:.6f}"])
    write_whole(path, text.getvalue().encode())


def _draw(found: Stoning, folder: Path, name: str, shows: float, refused: float, title: str) -> None:
    """Write the picture, where matplotlib is there."""
    try:
        from presswork.view.plots.stoning_plot import plot_stoning
        from presswork.view.style import create_folder, save_picture
    except ImportError:
        return
    create_folder(folder / "plots")
    save_picture(plot_stoning(found, shows=shows, refused=refused, title=title), folder / "plots" / name)
