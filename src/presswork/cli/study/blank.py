# SPDX-License-Identifier: Apache-2.0
"""The command `blank`.

Exit status: 0 the flange fits; 2 bad input; 3 it does not fit; 130 interrupted."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from presswork.case import CaseError
from presswork.case.errors import Problem
from presswork.cli.study.members import BringBack, ClusterAddress, MemberTimeout, choose_cluster
from presswork.cli.terminal import GAVE_UP, INTERRUPTED, RunUserCode, console, refuse
from presswork.recorder import Progress as RunProgress
from presswork.results import OutputError
from presswork.study import ClusterError
from presswork.study.blank_shape import DRAWING, Draw, find_blank_shape, read_target, surround_opening


def blank(
    case: Annotated[Path, typer.Argument(help="The stamping (TOML); its blank is drawn first.", show_default=False)],
    target: Annotated[Path | None, typer.Option(help="The flange's outline from above: DXF or CSV.")] = None,
    flange_width: Annotated[
        float | None, typer.Option(help="Instead: a flange that reaches so far from the die's opening (mm).")
    ] = None,
    tolerance: Annotated[float, typer.Option(help="Largest distance of the drawn edge from the target (mm).")] = 0.5,
    draws: Annotated[int, typer.Option(min=1, help="Draws at most.")] = 8,
    damping: Annotated[float, typer.Option(help="Part of each correction that is made, up to 1.")] = 1.0,
    set_: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Change a key of the case, for all draws.")
    ] = None,
    output: Annotated[Path | None, typer.Option(help="Folder; default: the case's name with _blank.")] = None,
    threads: Annotated[int, typer.Option(min=0, help="Threads; 0 uses every core, or all of a worker.")] = 0,
    cluster: ClusterAddress = "",
    bring_back: BringBack = False,
    member_timeout: MemberTimeout = 0.0,
    resume: Annotated[bool, typer.Option("--resume", help="Keep the draws that are there and continue.")] = False,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace the search in the folder.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="No progress, errors only.")] = False,
    run_user_code: RunUserCode = False,
) -> None:
    """Find the blank whose drawn flange has the outline wanted: draw, correct, draw again."""
    folder = output or case.with_name(f"{case.stem}_blank")
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    try:
        if (target is None) == (flange_width is None):
            raise CaseError(
                [Problem("", "give either --target or --flange-width", "--target flange.dxf, for instance")]
            )
        wanted = read_target(target) if target else surround_opening(case, flange_width or 0.0, set_ or [])
        with Progress(*columns, console=console(), disable=quiet) as bar:
            task = bar.add_task(case.stem, total=1.0)

            def show(number: int, now: RunProgress) -> None:
                bar.update(task, completed=now.fraction, description=f"draw {number}: {now.text}")

            def report(draw: Draw) -> None:
                if not quiet:
                    share = 100.0 * float((abs(draw.fit.deviation) <= tolerance).mean())
                    text = f"{draw.fit.worst:.3g} mm off at most, {share:.0f} % within {tolerance:g} mm"
                    bar.console.print(f"draw {draw.number}: {text}, {draw.seconds:.1f} s", markup=False)

            found = find_blank_shape(
                case, wanted, folder, tolerance=tolerance, most=draws, damping=damping, settings=set_ or [],
                threads=threads, cluster=choose_cluster(cluster, bring_back, quiet),
                member_timeout=member_timeout or None, resume=resume, overwrite=overwrite,
                on_progress=show, on_draw=report,
            )  # fmt: skip
    except (CaseError, OutputError, ClusterError) as error:
        raise refuse(str(error)) from error
    if found.draws:
        worst = found.best.fit.worst
        typer.echo(f"blank of draw {found.best.number}, {worst:.3g} mm off at most: {folder / DRAWING}")
    if found.status != "completed":
        console().print(f"{found.status.replace('_', ' ')}: {found.reason}", style="red", markup=False)
        raise typer.Exit(GAVE_UP if found.status == "gave_up" else INTERRUPTED)
