# SPDX-License-Identifier: Apache-2.0
"""The command `sweep`.

Exit status: 0 all completed; 2 bad input; 3 a member gave up or died; 130 interrupted.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from presswork.case.errors import CaseError, Problem
from presswork.cli.study.members import (
    BringBack,
    ClusterAddress,
    Jobs,
    MemberTimeout,
    Overwrite,
    Quiet,
    Resume,
    Settings,
    choose_cluster,
    progress_shown,
)
from presswork.cli.terminal import BAD_INPUT, GAVE_UP, INTERRUPTED, RunUserCode, console, exit_on
from presswork.results import OutputError
from presswork.study import ClusterError
from presswork.study.sweep import TABLE, MemberResult, SweepResult, run_sweep
from presswork.study.table import require_pyarrow, write_parquet
from presswork.study.vary import parse_variation


def sweep(
    case: Annotated[Path, typer.Argument(help="The case file (TOML).", show_default=False)],
    vary: Annotated[
        list[str],
        typer.Option(
            "--vary",
            metavar="KEY=A:B:N | KEY=V1,V2",
            help="N values from A to B, or a list; several --vary give every combination.",
            show_default=False,
        ),
    ],
    set_: Settings = None,
    output: Annotated[Path | None, typer.Option(help="Folder; default: the case's name with _sweep.")] = None,
    column: Annotated[
        list[str] | None,
        typer.Option(
            metavar="max:FIELD | min:FIELD | last:HISTORY",
            help="One more column of the table: extreme of a field at the last step, or of a column of history.csv.",
        ),
    ] = None,
    jobs: Jobs = 0,
    cluster: ClusterAddress = "",
    bring_back: BringBack = False,
    member_timeout: MemberTimeout = 0.0,
    table_format: Annotated[
        Literal["csv", "parquet"], typer.Option(help="parquet: leave table.parquet beside table.csv.")
    ] = "csv",
    resume: Resume = False,
    overwrite: Overwrite = False,
    quiet: Quiet = False,
    run_user_code: RunUserCode = False,
) -> None:
    """Run a family of cases in parallel, and leave one table and one picture."""
    folder = output or case.with_name(f"{case.stem}_sweep")
    with exit_on(CaseError, OutputError, ClusterError):
        if table_format == "parquet":
            require_pyarrow()  # before anything is run
        varied: dict[str, list[Any]] = {}
        for text in vary:
            key, values = parse_variation(text)
            if key in varied:
                raise CaseError([Problem(key, "varied twice", "give all its values in one --vary")], case)
            varied[key] = values
        with progress_shown(case.stem, quiet) as show:
            result = run_sweep(
                case,
                varied,
                folder,
                settings=set_ or [],
                columns=column or [],
                jobs=jobs,
                cluster=choose_cluster(cluster, bring_back, quiet),
                member_timeout=member_timeout or None,
                resume=resume,
                overwrite=overwrite,
                on_progress=show,
            )
        if table_format == "parquet":
            write_parquet(result.folder / TABLE.replace("csv", "parquet"), result.rows)
    _report_members(result, quiet)


def _report_members(result: SweepResult, quiet: bool) -> None:
    """Print which members did not complete and what their runs warn of, and exit with the status that follows."""
    for member in result.members:
        if member.status in ("bad_input", "gave_up", "failed"):
            status = member.status.replace("_", " ")
            text = f"{member.folder.name} ({_name_values(member)}): {status}: {member.reason}"
            console().print(text, style="red", markup=False)
        for warning in member.warnings:
            text = f"{member.folder.name} ({_name_values(member)}): warning: {warning}"
            console().print(text, style="yellow", markup=False)
    alike: dict[str, list[str]] = {}
    for fault in result.faults:
        alike.setdefault(re.sub(r"member_\d+", "", fault), []).append(fault)
    for faults in alike.values():
        more = f" (so in {len(faults)} members)" if len(faults) > 1 else ""
        console().print(f"no column {faults[0]}{more}", style="red", markup=False)
    counts = result.counts
    if not quiet:
        console().print(
            f"{counts['completed']} of {len(result.members)} completed; {result.folder / TABLE}", markup=False
        )
    if result.interrupted:
        console().print(
            f"interrupted: continue with --resume; {result.folder / TABLE} shows how far it is", style="red"
        )
        raise typer.Exit(INTERRUPTED)
    if counts["gave_up"] or counts["failed"]:
        raise typer.Exit(GAVE_UP)
    if counts["bad_input"] or result.faults:
        raise typer.Exit(BAD_INPUT)


def _name_values(member: MemberResult) -> str:
    """Return the varied keys of a member with their values."""
    return ", ".join(f"{key} = {value}" for key, value in member.values.items())
