# SPDX-License-Identifier: Apache-2.0
"""The command `run`.

Exit status: 0 the whole process was computed; 2 bad input or output folder; 3 the solver gave up; 130 interrupted.
"""

from __future__ import annotations

import signal
from pathlib import Path
from typing import Annotated

import typer

from presswork import api
from presswork.cli.case_files import reading
from presswork.cli.computing import ending, finish, showing_progress
from presswork.cli.terminal import CaseFile, RunUserCode, Settings, console, exit_on
from presswork.ranks.world import RanksError, find_world


def run(
    case: CaseFile,
    output: Annotated[Path | None, typer.Option(help="Output folder; default: the case's name beside it.")] = None,
    set_: Settings = None,
    resume: Annotated[bool, typer.Option("--resume", help="Continue from the folder's checkpoint.")] = False,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace results in the folder.")] = False,
    threads: Annotated[
        int, typer.Option(min=0, help="Threads; 0 uses every core. The results do not depend on it.")
    ] = 0,
    device: Annotated[
        str | None,
        typer.Option(
            metavar="cpu|cuda|host",
            help="What computes the cycles of an explicit run: the CPU, an NVIDIA card, or the card's code on the CPU; "
            "as --set explicit.device=.",
        ),
    ] = None,
    plot: Annotated[bool, typer.Option(help="Draw the pictures at the end.")] = True,
    report: Annotated[bool, typer.Option(help="Write the page for the browser at the end.")] = True,
    quiet: Annotated[bool, typer.Option("--quiet", help="No progress, errors only.")] = False,
    run_user_code: RunUserCode = False,
) -> None:
    """Compute a case, draw its pictures and write its page for the browser."""
    folder = output or case.with_suffix("")
    with exit_on(RanksError):
        world = find_world()
    if world is not None and world.rank > 0:
        console().quiet = quiet = True
    with reading(folder):
        model = api.load(case, [*(set_ or []), *([f"explicit.device={device}"] if device else [])])
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    with ending(case):
        with showing_progress(model.title, quiet) as show:
            outcome = api.run(
                model,
                folder,
                overwrite=overwrite,
                resume=resume,
                threads=threads,
                on_increment=show,
                world=world,
            )
        if world is None or world.rank == 0:
            finish(outcome, plot=plot, report=report, quiet=quiet)
