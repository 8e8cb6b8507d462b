# SPDX-License-Identifier: Apache-2.0
"""The command `robust`.

Exit status: 0 all runs completed; 2 bad input; 3 a run gave up or died; 130 interrupted.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

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
from presswork.study.scatter.robust import ROBUST, Robustness
from presswork.study.scatter.robust import robust as find_robustness


def robust(
    study: Annotated[Path, typer.Argument(help="The study (TOML): case, inputs that scatter, limits.")],
    output: Annotated[Path | None, typer.Option(help="Folder; default: the study's name with _robust.")] = None,
    jobs: Jobs = 0,
    cluster: ClusterAddress = "",
    bring_back: BringBack = False,
    member_timeout: MemberTimeout = 0.0,
    resume: Resume = False,
    overwrite: Overwrite = False,
    quiet: Quiet = False,
    run_user_code: RunUserCode = False,
) -> None:
    """Find how often a process passes its limits when inputs scatter, and which input to hold tighter first."""
    folder = output or study.with_name(f"{study.stem}_robust")
    with exit_on(CaseError, OutputError, ClusterError), progress_shown(study.stem, quiet) as show:
        found = find_robustness(
            study,
            folder,
            jobs=jobs,
            cluster=choose_cluster(cluster, bring_back, quiet),
            member_timeout=member_timeout or None,
            resume=resume,
            overwrite=overwrite,
            on_progress=show,
        )
    _report(found, quiet)


def _report(found: Robustness, quiet: bool) -> None:
    """Print what every limit comes to, and exit with the status that follows."""
    for entry in found.data["limits"] if not quiet else ():
        typer.echo(describe_limit(entry, found.data["runs"]))
    for entry in found.data["maps"] if not quiet else ():
        typer.echo(_describe_map(entry))
    if not quiet:
        typer.echo(f"{found.sweep.folder / ROBUST}")
    if not found.is_complete:
        console().print("interrupted: continue with --resume", style="red")
        raise typer.Exit(INTERRUPTED)
    if found.data["failed"]:
        text = f"{found.data['failed']} of {found.data['runs']} runs failed, and count as beyond every limit"
        console().print(text, style="red", markup=False)
        raise typer.Exit(GAVE_UP)


def describe_limit(entry: dict[str, Any], runs: int) -> str:
    """Return a line on a limit: how many runs pass it, capability, and the input to hold tighter first."""
    limits = " ".join(f"{name.replace('_', ' ')} {entry[name]:g}" for name in ("at_least", "at_most") if name in entry)
    parts = [f"{entry['measure']} {limits}: {entry['beyond']} of {runs} runs beyond"]
    if "share_beyond_at_most" in entry:
        parts[0] += f" (with 95 % confidence at most {100 * entry['share_beyond_at_most']:.3g} %)"
    if "fault" in entry:
        parts.append(entry["fault"])
    elif "cpk" in entry:
        parts.append(f"Cpk {entry['cpk']:.2f}, at least {entry['cpk_at_least']:.2f}")
    if inputs := entry.get("inputs"):
        share, deviation = "share_beyond_with_half_its_scatter", "deviation_with_half_its_scatter"
        first = min(inputs, key=lambda each: (float(each[share]), float(each[deviation])))
        now, then = (
            100 * share for share in (entry["share_beyond_by_surrogate"], first["share_beyond_with_half_its_scatter"])
        )
        parts.append(f"{now:.3g} % beyond by the surrogate, {then:.3g} % with half the scatter of {first['key']}")
    elif "surrogate_explains" in entry:
        parts.append("a surrogate does not follow the runs: take more of them")
    return "; ".join(parts)


def _describe_map(entry: dict[str, Any]) -> str:
    """Return a line on a map."""
    if "worst_place" not in entry:
        return f"no map of {entry['field']}: {entry['fault']}"
    worst = entry["worst_place"]
    at = ", ".join(f"{x:.4g}" for x in worst["at_mm"])
    limits = " ".join(
        f"{name.replace('_', ' ')} {entry[name]:g} {entry['unit'].replace('1', '')}".strip()
        for name in ("at_least", "at_most")
        if name in entry
    )
    return f"{entry['field']} {limits}: {100 * worst['share_beyond']:.3g} % of the runs are beyond at ({at}) mm"
