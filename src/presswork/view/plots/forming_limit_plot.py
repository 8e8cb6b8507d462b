# SPDX-License-Identifier: Apache-2.0
"""The forming limit diagram of a part: strains of all elements below the curve of its sheet, coloured by zone."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np

from presswork.formability import ZONES, Formability
from presswork.post.formability import judge_cells, judge_part, list_other_limits
from presswork.results import Result
from presswork.view.style import ZONE_COLOURS, clean_axes, describe_step, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_GREY = "0.35"
_LABEL = 0.3
"""Part of the diagram's width that the name of a strain path takes at most."""


def plot_forming_limit(
    result: Result, step: int = -1, *, judged: Formability | None = None, figure: Figure | None = None
) -> Figure:
    """Draw major against minor strain of every element, the limit curve and the line of its safety margin.

    judged: the limit to judge by; without it that of the run. Without a curve the strains are drawn alone.
    Raises ResultError for a body that is no sheet.
    """
    figure = new_figure(7.0, 5.2) if figure is None else figure
    verdict, cells = judge_part(result, step, judged), judge_cells(result, step, judged)
    others = [] if judged is not None else list_other_limits(result)
    judged = result.formability if judged is None else judged
    major, minor = result.field("major_strain_middle", step), result.field("minor_strain_middle", step)
    ax = figure.subplots()
    if "formability_zone" in cells:
        for number, name in enumerate(ZONES):
            own = cells["formability_zone"] == number
            label = f"{name} ({own.sum()})"
            ax.plot(minor[own], major[own], "o", color=ZONE_COLOURS[number], markersize=3, label=label)
        if (own := np.isnan(cells["formability_zone"])).any():
            ax.plot(minor[own], major[own], "o", color=_GREY, markersize=3, label=f"not judged ({own.sum()})")
    else:
        ax.plot(minor, major, "o", color=_GREY, markersize=3, label="no forming limit given")
    top = 1.1 * max(float(major.max()), 0.1 if judged.curve is None else judged.curve.lowest()[1])
    left, right = min(1.1 * float(minor.min()), -0.4 * top), max(1.1 * float(minor.max()), 0.4 * top)
    if judged.curve is not None:
        _draw_curve(ax, judged, left, right)
        beside = float(judged.curve.limit(np.array([max(float(minor.max()), 0.0)]))[0])
        top = max(top, 1.35 * judged.curve.lowest()[1], 1.1 * beside)
    for style, (name, other) in zip(itertools.cycle((":", "-.")), others, strict=False):
        ax.plot(other.minor, other.major, "k", linestyle=style, linewidth=1.2, label=f"limit of {name}")
        top = max(top, 1.35 * other.lowest()[1])
    r = judged.r
    for height, slope, text in (
        (0.97, -(1 + r) / r, f"tension, r = {r:.3g}"),
        (0.86, -1.0, "thickens"),
        (0.97, 1.0, "balanced"),
    ):
        ax.plot([0.0, top / slope], [0.0, top], color="0.75", linewidth=0.8, zorder=0)
        end = min(top, slope * (left if slope < 0 else right))
        place = (height * end / slope, height * end)
        fits = place[0] > left + _LABEL * (right - left)  # left of its line
        box = {"facecolor": "white", "edgecolor": "none", "pad": 0.5, "alpha": 0.8}
        ax.annotate(text, place, color="0.4", fontsize=7, ha="right" if fits else "left", va="top", bbox=box)
    ax.set_xlim(left, right)
    ax.set_ylim(min(0.0, float(major.min())), top)
    ax.set_xlabel("minor true strain [–]")
    ax.set_ylabel("major true strain [–]")
    title = str(result.info.get("title", "")).strip()
    ax.set_title("\n".join(filter(None, (title, describe_step(result, step)))), fontsize="medium")
    wording = f"{verdict.failing} of {len(major)} elements above the limit" if verdict.margin else "no forming limit"
    ax.legend(frameon=False, fontsize="small", loc="center left", bbox_to_anchor=(1.0, 0.5), title=wording)
    clean_axes(ax)
    return figure


def _draw_curve(ax: Axes, judged: Formability, left: float, right: float) -> None:
    """Draw the curve from end to end, dashed where it is drawn on beyond its points, and its margin."""
    curve = judged.curve
    assert curve is not None
    inside = np.linspace(max(left, curve.minor[0]), min(right, curve.minor[-1]), 200)
    ax.plot(inside, curve.limit(inside), color="k", linewidth=1.6, label=curve.method)
    reserve = f"safety margin {100 * judged.safety_margin:g} %"
    ax.plot(inside, (1 - judged.safety_margin) * curve.limit(inside), "--", color="k", linewidth=1.0, label=reserve)
    for low, high in ((left, curve.minor[0]), (curve.minor[-1], right)):
        if low < high:
            beyond = np.linspace(low, high, 50)
            ax.plot(beyond, curve.limit(beyond), ":", color="k", linewidth=1.0)
