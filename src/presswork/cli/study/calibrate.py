# SPDX-License-Identifier: Apache-2.0
"""The commands `calibrate ...`. Exit status: 0 all completed; 2 bad input; 130 interrupted."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

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
from presswork.cli.terminal import INTERRUPTED, RunUserCode, console, exit_on
from presswork.outcome import StartError
from presswork.results import OutputError, ResultError
from presswork.study import ClusterError
from presswork.study.calibrate import SYMBOLS, BorePlace, Calibration, FrictionLaw, calibrate_ring
from presswork.study.calibrate_curve import MOST_RUNS, calibrate_curve
from presswork.study.calibrate_damage import calibrate_damage

app = typer.Typer(help="Find a parameter from measured tests.", no_args_is_help=True, add_completion=False)


@app.callback()
def _calibrate() -> None:
    """Find a parameter from measured tests."""


@app.command()
def ring(
    measured: Annotated[
        Path,
        typer.Argument(
            help="CSV with height_reduction (or height_reduction_percent) and bore_ratio (or bore_diameter_mm).",
            show_default=False,
        ),
    ],
    case: Annotated[Path, typer.Option(help="The ring compression (TOML).", show_default=False)],
    law: Annotated[FrictionLaw, typer.Option(help="Constant shear (m) or Coulomb (mu).")] = "shear",
    values: Annotated[
        str, typer.Option(metavar="V1,V2,...", help="Friction values of the curves; default: ten of them.")
    ] = "",
    bore: Annotated[
        BorePlace, typer.Option(help="What was measured: mean over the height, or at mid-height.")
    ] = "mean",
    set_: Settings = None,
    output: Annotated[Path | None, typer.Option(help="Folder; default: measured file's name, _calibration.")] = None,
    jobs: Jobs = 0,
    cluster: ClusterAddress = "",
    bring_back: BringBack = False,
    member_timeout: MemberTimeout = 0.0,
    resume: Resume = False,
    overwrite: Overwrite = False,
    quiet: Quiet = False,
    run_user_code: RunUserCode = False,
) -> None:
    """Fit friction to a measured ring test: the value, its 95 % confidence, and the picture."""
    folder = output or measured.with_name(f"{measured.stem}_calibration")
    with exit_on(CaseError, OutputError, ClusterError), progress_shown("calibration curves", quiet) as show:
        calibration = calibrate_ring(
            measured,
            case,
            folder,
            law=law,
            values=_read_values(values),
            bore=bore,
            settings=set_ or [],
            jobs=jobs,
            cluster=choose_cluster(cluster, bring_back, quiet),
            member_timeout=member_timeout or None,
            resume=resume,
            overwrite=overwrite,
            on_progress=show,
        )
    if calibration is None:
        console().print("interrupted: continue with --resume", style="red")
        raise typer.Exit(INTERRUPTED)
    _report_fit(calibration)


@app.command()
def damage(
    test: Annotated[Path, typer.Argument(help="The test: a case file, or the folder of its run.", show_default=False)],
    stroke: Annotated[float, typer.Option(help="Stroke of the tool at the first crack (mm).", show_default=False)],
    tool: Annotated[str, typer.Option(help="Name of that tool, if several move.")] = "",
    criterion: Annotated[str, typer.Option(help="Criterion of fracture.")] = "cockcroft_latham",
    at: Annotated[
        str,
        typer.Option(metavar="X,Y[,Z]", help="Place of the crack in the formed part (mm); else the largest counts."),
    ] = "",
    set_: Settings = None,
    output: Annotated[Path | None, typer.Option(help="Folder of the run; default: the case's name, _damage.")] = None,
    run_user_code: RunUserCode = False,
) -> None:
    """Estimate the critical damage of a material from the stroke of first crack in a test."""
    with exit_on(CaseError, OutputError, ResultError):
        try:
            place = [float(part) for part in at.split(",") if part.strip()]
        except ValueError:
            raise CaseError([Problem("--at", f"`{at}` is not a place", "write --at 12.5,0.2")]) from None
        found = calibrate_damage(
            test, stroke, tool=tool, criterion=criterion, at=place, folder=output, settings=set_ or []
        )
    where = ", ".join(f"{x:.4g}" for x in found.place)
    typer.echo(f"critical = {found.value:.4f} ({found.criterion}, {found.tool} at {found.stroke:g} mm, ({where}) mm)")


@app.command()
def curve(
    measured: Annotated[
        Path,
        typer.Argument(
            help="CSV of two columns named as in history.csv, e.g. punch.stroke,punch.force.", show_default=False
        ),
    ],
    case: Annotated[Path, typer.Option(help="The test (TOML); its numbers are the first guess.", show_default=False)],
    fit: Annotated[
        list[str], typer.Option(metavar="KEY", help="Number of the case to find; repeat for more.", show_default=False)
    ],
    most_runs: Annotated[int, typer.Option(min=1, help="Runs at most.")] = MOST_RUNS,
    set_: Settings = None,
    output: Annotated[Path | None, typer.Option(help="Folder; default: measured file's name, _calibration.")] = None,
    overwrite: Overwrite = False,
    quiet: Quiet = False,
    run_user_code: RunUserCode = False,
) -> None:
    """Find numbers of a case from a measured curve, by the derivatives of its runs."""

    def report(number: int, values: Mapping[str, float], misfit: float) -> None:
        if not quiet:
            listed = ", ".join(f"{key} = {value:.6g}" for key, value in values.items())
            console().print(f"run {number}: misfit {misfit:.2e}; {listed}", markup=False)

    with exit_on(CaseError, OutputError, StartError):
        found = calibrate_curve(
            measured,
            case,
            output or measured.with_name(f"{measured.stem}_calibration"),
            keys=fit,
            settings=set_ or [],
            most_runs=most_runs,
            overwrite=overwrite,
            on_run=report,
        )
    for key, value in found.values.items():
        typer.echo(f"{key} = {value:.6g} +- {found.interval[key]:.2g}")
    typer.echo(f"misfit {found.misfit:.2e} of the largest value, {found.runs} runs")
    for warning in found.warnings:
        typer.echo(f"warning: {warning}")
    console().print(f"calibration.json in {found.folder}", markup=False)


def _read_values(text: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",") if part.strip()]
    except ValueError:
        raise CaseError([Problem("--values", f"`{text}` are not numbers", "write --values 0,0.1,0.2")]) from None


def _report_fit(calibration: Calibration) -> None:
    fit = calibration.fit
    symbol = SYMBOLS[calibration.law]
    text = f"{symbol} = {fit.friction:.4f}"
    if len(fit.residuals) > 1:
        low, high = fit.interval
        text += f", 95 % confidence {low:.4f} to {high:.4f}; scatter of the bore ratio {fit.scatter:.4f}"
    typer.echo(f"{text}; {len(fit.residuals)} point{'s' * (len(fit.residuals) > 1)}")
    for warning in fit.warnings:
        typer.echo(f"warning: {warning}")
    console().print(f"calibration.png and calibration.json in {calibration.folder}", markup=False)
