# SPDX-License-Identifier: Apache-2.0
"""Pictures of results, and the message with their paths."""

from __future__ import annotations

from pathlib import Path

from presswork.cli.terminal import console
from presswork.results import Result


def draw(
    result: Result,
    out: Path | None,
    *,
    quiet: bool = False,
    fields: list[str] | None = None,
    steps: list[int] | None = None,
    sections: list[tuple[float, float, float]] | None = None,
    flow_lines: bool | None = None,
) -> None:
    """Draw the pictures of results. out: default: plots in the folder of results."""
    from presswork.view import plot_all

    try:
        paths = plot_all(result, out, fields, steps or "last", sections=sections or (), flow_lines=flow_lines)
    except ImportError as error:
        console().print(f"no pictures: {error}", markup=False)
        return
    if not quiet and paths:
        console().print(f"{len(paths)} pictures in {paths[0].parent}", markup=False)
    if not quiet and (verdict := result.summary.get("formability")):
        console().print(f"at the end: {verdict['verdict']}", markup=False)


def show(result: Result, *, plot: bool, report: bool, quiet: bool = False) -> None:
    """Leave the pictures and the page of a run beside its results, each if it is wanted."""
    if plot:
        draw(result, None, quiet=quiet)
    if report:
        write_page(result, quiet=quiet)


def write_page(result: Result, *, quiet: bool = False) -> None:
    """Write the page for the browser into the folder of results."""
    from presswork.report import write_report

    path = write_report(result)
    if not quiet:
        console().print(f"page for the browser: {path}", markup=False)


def overlay(results: list[Result], out: Path) -> None:
    """Draw several results over each other."""
    from presswork.view.plots.overlay_plot import plot_overlays

    try:
        paths = plot_overlays(results, out)
    except ImportError as error:
        console().print(f"no pictures: {error}", markup=False)
        return
    found = (
        f"{len(paths)} pictures in {out}" if paths else "nothing to draw over each other: these runs share no quantity"
    )
    console().print(found, markup=False)
