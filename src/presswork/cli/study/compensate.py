# SPDX-License-Identifier: Apache-2.0
"""The command `compensate`.

Exit status: 0 the part is within the tolerance; 2 bad input; 3 the part is outside the tolerance; 130 interrupted."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from presswork.case import CaseError
from presswork.cli.study.members import MemberTimeout
from presswork.cli.terminal import GAVE_UP, INTERRUPTED, RunUserCode, console, refuse
from presswork.recorder import Progress as RunProgress
from presswork.results import OutputError
from presswork.study.compensate import CASE, Loop, compensate_springback


def compensate(
    case: Annotated[Path, typer.Argument(help="The stamping (TOML), with its springback table.", show_default=False)],
    target: Annotated[
        Path | None,
        typer.Option(help="A face or the middle of the wanted part, STL, STEP or IGES; default: the part as drawn."),
    ] = None,
    unit: Annotated[str, typer.Option(help="Unit of lengths in the target's STL file.")] = "mm",
    tolerance: Annotated[float, typer.Option(help="Largest distance of the part from its goal (mm).")] = 0.1,
    loops: Annotated[int, typer.Option(min=1, help="Corrections at most.")] = 6,
    fix_binder: Annotated[bool, typer.Option("--fix-binder", help="Leave the binder under holders as it is.")] = False,
    set_: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Change a key of the case, for all loops.")
    ] = None,
    output: Annotated[Path | None, typer.Option(help="Folder; default: the case's name with _compensate.")] = None,
    threads: Annotated[int, typer.Option(min=0, help="Threads; 0 uses every core.")] = 0,
    member_timeout: MemberTimeout = 0.0,
    resume: Annotated[bool, typer.Option("--resume", help="Keep the loops that are there and continue.")] = False,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace the search in the folder.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="No progress, errors only.")] = False,
    run_user_code: RunUserCode = False,
) -> None:
    """Correct the tools for springback, loop by loop, until the part has the shape it is drawn to."""
    folder = output or case.with_name(f"{case.stem}_compensate")
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    try:
        with Progress(*columns, console=console(), disable=quiet) as bar:
            task = bar.add_task(case.stem, total=1.0)

            def show(number: int, now: RunProgress) -> None:
                bar.update(task, completed=now.fraction, description=f"loop {number}: {now.text}")

            def report(loop: Loop, row: dict[str, Any]) -> None:
                if not quiet:
                    bar.console.print(_describe(loop, row, tolerance), markup=False)

            found = compensate_springback(
                case, folder, tolerance=tolerance, target=target, unit=unit, most=loops,
                fix_binder=fix_binder, settings=set_ or [],
                threads=threads, member_timeout=member_timeout or None, resume=resume, overwrite=overwrite,
                on_progress=show, on_loop=report,
            )  # fmt: skip
    except (CaseError, OutputError) as error:
        raise refuse(str(error)) from error
    if found.loops:
        best = found.best
        typer.echo(f"tools of loop {best.number}, {best.worst:.3g} mm off at most: {folder / CASE}")
        if best.undercut.angle > 0.0:
            console().print(f"warning: {_describe_undercut(best)}", style="yellow", markup=False)
    if found.status != "completed":
        console().print(f"{found.status.replace('_', ' ')}: {found.reason}", style="red", markup=False)
        raise typer.Exit(GAVE_UP if found.status == "gave_up" else INTERRUPTED)


def _describe(loop: Loop, row: dict[str, Any], tolerance: float) -> str:
    """Return a loop in a line."""
    rate = row["rms_over_last"]
    return (
        f"loop {loop.number}: {loop.worst:.3g} mm off at most, root mean square {row['rms_deviation_mm']:.3g} mm"
        f"{'' if rate is None else f' ({rate:.2g} of the last)'}, {row['share_within_percent']:.0f} % within "
        f"{tolerance:g} mm, {loop.seconds:.1f} s"
    )


def _describe_undercut(loop: Loop) -> str:
    cut = loop.undercut
    place = ", ".join(f"{x:.4g}" for x in cut.place)
    return f"{cut.tool} is undercut by {cut.angle:.2g} degrees near ({place}): the press cannot draw it out of the part"
