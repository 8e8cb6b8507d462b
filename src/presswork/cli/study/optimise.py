# SPDX-License-Identifier: Apache-2.0
"""The command `optimise`.

Exit status: 0 a case within the limits; 2 bad input; 3 no run keeps the limits; 130 interrupted.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from presswork.case.errors import CaseError
from presswork.cli.study.members import (
    BringBack,
    ClusterAddress,
    Jobs,
    MemberTimeout,
    Overwrite,
    Quiet,
    Resume,
    choose_cluster,
    progress_shown,
)
from presswork.cli.terminal import GAVE_UP, INTERRUPTED, RunUserCode, console, exit_on
from presswork.results import OutputError
from presswork.study import ClusterError
from presswork.study.optimum.optimise import BEST, Optimum
from presswork.study.optimum.optimise import optimise as find_optimum
from presswork.study.optimum.study_file import Study, read_study


def optimise(
    study: Annotated[
        Path, typer.Argument(help="The study (TOML): case, variables, goals, limits.", show_default=False)
    ],
    output: Annotated[Path | None, typer.Option(help="Folder; default: the study's name with _optimum.")] = None,
    jobs: Jobs = 0,
    cluster: ClusterAddress = "",
    bring_back: BringBack = False,
    member_timeout: MemberTimeout = 0.0,
    resume: Resume = False,
    overwrite: Overwrite = False,
    quiet: Quiet = False,
    run_user_code: RunUserCode = False,
) -> None:
    """Find the best values of keys of a case, within bounds and limits, by runs in parallel."""
    folder = output or study.with_name(f"{study.stem}_optimum")
    with exit_on(CaseError, OutputError, ClusterError), progress_shown(study.stem, quiet) as show:
        found = find_optimum(
            study,
            folder,
            jobs=jobs,
            cluster=choose_cluster(cluster, bring_back, quiet),
            member_timeout=member_timeout or None,
            resume=resume,
            overwrite=overwrite,
            on_progress=show,
        )
    _report(found, read_study(study)[0])


def _report(found: Optimum, study: Study) -> None:
    """Print the best case, or why there is none."""
    if found.best is not None:
        values = ", ".join(
            f"{variable.names[0]} = {variable.write(found.best.values[variable.names[0]])}"
            for variable in study.variables
        )
        measures = ", ".join(f"{name} = {found.best.measures[name]:.6g}" for name in study.measures)
        typer.echo(f"best of {len(found.runs)} runs, {found.best.folder.name}: {values}; {measures}")
        typer.echo(f"its case: {found.folder / BEST}")
    if found.reason:
        console().print(f"{found.status.replace('_', ' ')}: {found.reason}", style="red", markup=False)
    if found.status != "completed":
        raise typer.Exit(GAVE_UP if found.status == "gave_up" else INTERRUPTED)
