# SPDX-License-Identifier: Apache-2.0
"""Several runs in one picture: force curves, sections, forming limit diagrams, contact stress."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from presswork.post import trace_interface
from presswork.post.section import cut_sheet
from presswork.results import Result
from presswork.view.plots.history_plot import find_moving_tools, name_runs, plot_history
from presswork.view.style import bare_figure, clean_axes, create_folder, require_matplotlib, save_picture

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def plot_overlays(results: Sequence[Result], folder: Path) -> list[Path]:
    """Draw runs over each other at their last steps, as PNG, and return the paths.

    Force against stroke where tools move; of sheets the section along x with its thickness strain, and strains below
    the forming limits; of solids contact pressure and shear of every tool that all have. What not all runs have is left
    out.
    """
    require_matplotlib()
    create_folder(folder)
    names = name_runs(results)
    figures: dict[str, Figure] = {}
    if all(find_moving_tools(result.history) for result in results):
        figure = bare_figure(7.2, 4.6)
        plot_history(results, ax=figure.subplots(), labels=names)
        figures["force_stroke"] = figure
    if all({"thickness_strain", "major_strain_middle"} <= set(result.field_names) for result in results):
        figures["section"] = _overlay_sections(results, names)
        figures["forming_limit"] = _overlay_strains(results, names)
    if all("contact_pressure" in result.field_names for result in results):
        for tool in [name for name in results[0].tools if all(name in result.tools for result in results)]:
            figures[f"interface_{tool}"] = _overlay_interfaces(results, names, tool)
    return [save_picture(figure, folder / f"{name}.png") for name, figure in figures.items() if _has_lines(figure)]


def _has_lines(figure: Figure) -> bool:
    return any(ax.lines for ax in figure.axes)


def _overlay_sections(results: Sequence[Result], names: Sequence[str]) -> Figure:
    """Draw shapes above, thickness strain below."""
    figure = bare_figure(7.4, 6.0)
    upper, lower = figure.subplots(2, 1, height_ratios=(2, 1))
    for number, (result, name) in enumerate(zip(results, names, strict=True)):
        sheet = cut_sheet(result, whole=True)
        if len(sheet.distance) == 0:
            continue
        shape = np.concatenate([sheet.line[:, 0], sheet.line[-1:, 1]])
        upper.plot(*shape.T, color=f"C{number}", linewidth=1.5, label=name)
        strain = result.field("thickness_strain")[sheet.cell]
        lower.plot(sheet.distance, strain, ".-", color=f"C{number}", linewidth=1.2, markersize=3)
    upper.set_aspect("equal")
    upper.set(xlabel="distance from the middle [mm]", ylabel="z [mm]", title="section at 0 degrees")
    lower.set(xlabel="distance from the middle in the undeformed blank [mm]", ylabel="thickness strain [–]")
    lower.axhline(0.0, color="0.5", linewidth=0.8)
    upper.legend(frameon=False, fontsize="small", loc="upper left", bbox_to_anchor=(1.01, 1.0))
    for ax in (upper, lower):
        clean_axes(ax)
    return figure


def _overlay_strains(results: Sequence[Result], names: Sequence[str]) -> Figure:
    """Draw the strains of every run, and each forming limit once."""
    figure = bare_figure(7.2, 5.2)
    ax = figure.subplots()
    drawn: list[bytes] = []
    for number, (result, name) in enumerate(zip(results, names, strict=True)):
        minor, major = (result.field(f"{which}_strain_middle") for which in ("minor", "major"))
        ax.plot(minor, major, "o", color=f"C{number}", markersize=2.5, alpha=0.6, label=name)
        curve = result.formability.curve
        key = b"" if curve is None else curve.minor.tobytes() + curve.major.tobytes()
        if curve is not None and key not in drawn:
            ax.plot(curve.minor, curve.major, color="k" if not drawn else f"C{number}", label=f"limit: {curve.method}")
            drawn.append(key)
    ax.set(xlabel="minor true strain [–]", ylabel="major true strain [–]")
    ax.set_ylim(bottom=min(0.0, ax.get_ylim()[0]))
    ax.axvline(0.0, color="0.7", linewidth=0.8)
    ax.legend(frameon=False, fontsize="small", loc="upper left", bbox_to_anchor=(1.01, 1.0))
    clean_axes(ax)
    return figure


def _overlay_interfaces(results: Sequence[Result], names: Sequence[str], tool: str) -> Figure:
    """Draw contact pressure and shear of one tool along the arc."""
    figure = bare_figure(7.4, 6.0)
    axes = figure.subplots(2, 1, sharex=True)
    for number, (result, name) in enumerate(zip(results, names, strict=True)):
        trace = trace_interface(result, tool)
        for patch in np.unique(trace.patch):
            own = trace.patch == patch
            for ax, values in zip(axes, (trace.contact_pressure, trace.contact_shear), strict=True):
                ax.plot(trace.points[own, 0], values[own], color=f"C{number}", linewidth=1.5, label=name)
            name = ""
    axes[0].set(ylabel="contact pressure [MPa]", title=f"contact with {tool}, last steps")
    axes[0].set_ylim(bottom=0.0)
    is_ring = results[0].info.get("analysis") == "axisymmetric"
    axes[1].set(ylabel="contact shear [MPa]", xlabel="radius r [mm]" if is_ring else "x [mm]")
    axes[0].legend(frameon=False, fontsize="small", loc="upper left", bbox_to_anchor=(1.01, 1.0))
    for ax in axes:
        clean_axes(ax)
    return figure
