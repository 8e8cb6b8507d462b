# SPDX-License-Identifier: Apache-2.0
"""robust.png: how each measure scatters about its limits, and which input makes it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from presswork.study.scatter.study_file import ScatterStudy
from presswork.study.sweep import SweepResult

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PICTURE = "robust.png"
_INSIDE, _BEYOND, _TOTAL = "#1f6fb2", "#c8102e", "#9aa3ad"
_MOST = 6
"""Limits that are drawn."""


def draw_robustness(study: ScatterStudy, data: Mapping[str, Any], sweep: SweepResult, folder: Path) -> Path | None:
    """Draw the first limits; None without matplotlib, or where no run has a measure."""
    entries = [entry for entry in data["limits"] if "mean" in entry][:_MOST]
    try:
        from presswork.view.style import bare_figure, save_picture
    except ImportError:
        return None
    if not entries:
        return None
    figure = bare_figure(9.6, 0.6 + 3.2 * len(entries))
    for (left, right), entry in zip(figure.subplots(len(entries), 2, squeeze=False), entries, strict=True):
        values = [row.get(entry["measure"]) for row in sweep.rows]
        _draw_values(left, entry, np.array([value for value in values if isinstance(value, int | float)], dtype=float))
        _draw_inputs(right, entry)
    figure.suptitle(f"{data['runs']} runs of {study.case}, {data['failed']} failed", fontsize="medium")
    return save_picture(figure, folder / PICTURE)


def _draw_values(ax: Axes, entry: Mapping[str, Any], values: np.ndarray[Any, np.dtype[np.float64]]) -> None:
    """Draw a histogram with its limits."""
    ax.hist(values, bins=min(max(len(values) // 5, 5), 30), color=_INSIDE)
    for name in ("at_least", "at_most"):
        if name in entry:
            ax.axvline(entry[name], color=_BEYOND, linewidth=1.6, linestyle="--")
    ax.set(xlabel=entry["measure"], ylabel="runs")
    text = f"beyond: {entry['beyond']} of {len(values) + entry['runs_without']}"
    ax.set_title(f"{text}; Cpk {entry['cpk']:.2f}, at least {entry['cpk_at_least']:.2f}", fontsize="small")


def _draw_inputs(ax: Axes, entry: Mapping[str, Any]) -> None:
    """Draw what each input makes of the variance, or of the share beyond the limit."""
    inputs = entry.get("inputs", [])
    if not inputs:
        text = entry.get("fault", "the surrogate does not follow the runs").replace(": ", ":\n")
        ax.text(0.5, 0.5, text, ha="center", va="center", fontsize="small")
        ax.set_axis_off()
        return
    names, places = [".".join(each["key"].split(".")[-2:]) for each in inputs], np.arange(len(inputs))
    if "total_order" in inputs[0]:
        ax.barh(places, [each["total_order"] for each in inputs], color=_TOTAL, label="with interactions")
        ax.barh(places, [max(each["first_order"], 0.0) for each in inputs], 0.5, color=_INSIDE, label="by itself")
        ax.set_xlabel("part of the variance")
        ax.legend(fontsize="small", frameon=False)
    else:
        share = entry["share_beyond_by_surrogate"]
        ax.barh(places, [100 * each["share_beyond_with_half_its_scatter"] for each in inputs], color=_INSIDE)
        ax.axvline(100 * share, color=_BEYOND, linewidth=1.2)
        ax.set_xlabel("beyond with half its scatter [%]; line: as it is")
    ax.set_yticks(places, names, fontsize="small")
    ax.invert_yaxis()
