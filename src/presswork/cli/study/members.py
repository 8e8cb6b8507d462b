# SPDX-License-Identifier: Apache-2.0
"""What the commands that run families of cases share: options, and one bar for all members."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Annotated

import typer
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from presswork.cli.terminal import console
from presswork.study import Cluster, ClusterError
from presswork.study.sweep import SweepProgress

Settings = Annotated[
    list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Change a key of the case, for all members.")
]
Jobs = Annotated[int, typer.Option(min=0, help="Members at a time; 0 for one a core. Each has one thread.")]
ClusterAddress = Annotated[
    str,
    typer.Option(
        "--cluster",
        metavar="ADDRESS | local",
        help="Compute on a Dask cluster: its scheduler, tcp://host:8786; or local.",
    ),
]
BringBack = Annotated[
    bool, typer.Option("--bring-back", help="Fetch results from workers of the cluster that do not see the folder.")
]
MemberTimeout = Annotated[
    float, typer.Option(min=0.0, metavar="SECONDS", help="Stop a member that takes longer; 0 for no limit.")
]
Resume = Annotated[bool, typer.Option("--resume", help="Keep completed members and continue the others.")]
Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace the members in the folder.")]
Quiet = Annotated[bool, typer.Option("--quiet", help="No progress, errors only.")]


def choose_cluster(address: str, bring_back: bool, quiet: bool) -> Cluster | None:
    """Return the cluster that the options name. Raises ClusterError."""
    if not address:
        if bring_back:
            raise ClusterError("--bring-back goes with --cluster: here results need no bringing back")
        return None

    def report(dashboard: str) -> None:
        if not quiet:
            console().print(f"dashboard of the cluster: {dashboard}", markup=False)

    return Cluster(address, bring_back, report)


@contextmanager
def progress_shown(title: str, quiet: bool) -> Iterator[Callable[[SweepProgress], None]]:
    """Give what shows one bar for all members."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console(), disable=quiet) as bar:
        task = bar.add_task(title, total=1.0)

        def show(progress: SweepProgress) -> None:
            counts = progress.counts
            bad = counts["gave_up"] + counts["failed"] + counts["bad_input"]
            text = f"{title}: {counts['completed']} of {progress.total} done, {counts['running']} running"
            bar.update(task, completed=progress.fraction, description=text + (f", {bad} failed" if bad else ""))

        yield show
