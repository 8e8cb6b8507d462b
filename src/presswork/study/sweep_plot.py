# SPDX-License-Identifier: Apache-2.0
"""force_stroke.png: one curve a member, coloured in the order of the members."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from presswork.results import OutputError
from presswork.view import plot_history
from presswork.view.plots.history_plot import find_moving_tools
from presswork.view.style import COLOURS, save_picture

if TYPE_CHECKING:
    from presswork.study.sweep import MemberResult

PICTURE = "force_stroke.png"
_ENTRIES_A_COLUMN = 16
_MOST_VALUES = 64
"""In a legend: beyond, it would hide the curves."""


def draw_curves(members: Sequence[MemberResult], folder: Path) -> Path | None:
    """Draw force against stroke of all members that have come anywhere; None if there are none, or no matplotlib."""
    drawn = [member for member in members if _has_curve(member)]
    if not drawn:
        return None
    try:
        import matplotlib as mpl
        from matplotlib.figure import Figure
    except ImportError:
        return None
    figure = Figure(figsize=(7.5, 4.6), layout="constrained")
    ax = figure.subplots()
    plot_history([member.result for member in drawn], ax=ax, labels=[_name(member) for member in drawn])
    tools = len(ax.lines) // len(drawn)
    colours = mpl.colormaps[COLOURS](np.linspace(0, 0.92, len(drawn)))
    for i, line in enumerate(ax.lines):
        line.set(color=colours[min(i // tools, len(drawn) - 1)], linestyle=("-", "--", ":")[i % tools % 3])
    if len(ax.lines) == 1:
        ax.lines[0].set_label(_name(drawn[0]))
    if ax.get_legend_handles_labels()[1] and len(drawn) * len(drawn[0].values) <= _MOST_VALUES:
        ax.legend(
            frameon=False,
            fontsize="small",
            ncols=-(-len(ax.lines) // _ENTRIES_A_COLUMN),
            loc="upper left",
            bbox_to_anchor=(1.0, 1.0),
        )
    return save_picture(figure, folder / PICTURE)


def _has_curve(member: MemberResult) -> bool:
    if member.status in ("bad_input", "waiting"):
        return False
    try:
        return bool(find_moving_tools(member.result.history))
    except OutputError:
        return False


def _name(member: MemberResult) -> str:
    """Return the varied values, keys cut to their last part: `m = 0.2`; how it ended if not well, and its warnings."""
    name = ", ".join(f"{key.rpartition('.')[2]} = {_short(value)}" for key, value in member.values.items())
    notes = [] if member.status == "completed" else [member.status.replace("_", " ")]
    if count := len(member.warnings):
        notes.append("1 warning" if count == 1 else f"{count} warnings")
    return f"{name} ({', '.join(notes)})" if notes else name


def _short(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
