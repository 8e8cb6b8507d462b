# SPDX-License-Identifier: Apache-2.0
"""Picture of a drawn sheet's outline, seen from above beside the blank's, and of its draw-in in every direction."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from presswork.model import FloatArray
from presswork.post.draw_in import measure_draw_in_around
from presswork.post.outline import trace_outline
from presswork.results import Result
from presswork.view.style import clean_axes, describe_step, new_figure, require_matplotlib

if TYPE_CHECKING:
    from matplotlib.figure import Figure


_WIDTH, _BELOW = 4.4, 3.0
"""Width of the outline, and height of the diagram below it with its labels [inch]."""


def plot_outline(result: Result, step: int = -1, *, figure: Figure | None = None) -> Figure:
    """Draw the edges of blank and part from above, and how far the outer one has come in by the angle from x."""
    require_matplotlib()
    from matplotlib.ticker import MaxNLocator, MultipleLocator

    figure = new_figure(6.4, 7.0) if figure is None else figure
    size = np.ptp(trace_outline(result, 0)[0], axis=0)
    height = float(np.clip(_WIDTH * size[1] / max(size[0], 1e-6 * size[1]), 0.6, 2.0 * _WIDTH))
    figure.set_size_inches(_WIDTH + 2.0, height + _BELOW)
    upper, lower = figure.subplots(2, 1, height_ratios=(height, 0.5 * _BELOW))
    for at, colour, style, label in ((0, "0.45", "--", "blank"), (step, "C3", "-", "part")):
        for number, loop in enumerate(trace_outline(result, at)):
            closed = np.vstack([loop, loop[:1]])
            name = label if number == 0 else None
            upper.plot(closed[:, 0], closed[:, 1], color=colour, linestyle=style, linewidth=1.4, label=name)
    for number, points in enumerate(find_beads(result, step)):
        upper.plot(*points.T, ".", color="#8a5a2b", markersize=2.0, label=None if number else "bead", zorder=0)
    upper.set_aspect("equal")
    upper.set(xlabel="x [mm]", ylabel="y [mm]")
    title = str(result.info.get("title", "")).strip()
    upper.set_title(f"{title}\n{describe_step(result, step)}, outline from above", fontsize="medium")
    upper.legend(fontsize="small", loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False)
    upper.yaxis.set_major_locator(MaxNLocator(int(np.clip(3 * height, 2, 9))))
    clean_axes(upper)
    rows = measure_draw_in_around(result, step)
    lower.plot(rows[:, 0], rows[:, 1], color="C3", linewidth=1.6)
    is_cut = result.mesh_at(step) is not result.mesh
    lower.set(xlabel="angle from x [degree]", ylabel="inside the blank [mm]" if is_cut else "draw-in [mm]")
    lower.xaxis.set_major_locator(MultipleLocator(15 if np.ptp(rows[:, 0]) <= 90 else 45))
    lower.margins(x=0.0)
    clean_axes(lower)
    return figure


def find_beads(result: Result, step: int) -> list[FloatArray]:
    """Return points of the lines of the drawbeads at a step in the plan (n, 2) [mm], of the whole part."""
    if "beads" not in result.info:
        return []
    names, rows = str(result.info["beads"]).split("\n"), np.asarray(result.info["bead_points"])
    own = result.operation_at(step)
    shown = [i for i, name in enumerate(names) if not own or name.startswith(f"{own}_")]
    lines = [rows[rows[:, 0] == i, 1:] for i in shown]
    for axis, plane in enumerate("xy"):
        if plane in str(result.info.get("symmetry", "")):
            away = np.where(np.arange(2) == axis, -1.0, 1.0)
            lines = [np.vstack([line, line * away]) for line in lines]
    return lines
