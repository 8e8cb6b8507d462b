# SPDX-License-Identifier: Apache-2.0
"""deviation.png: the part of the tools as drawn and of the best ones, by how far it lies off, and loop by loop."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from presswork.model import FloatArray
from presswork.study.compensation_goal import Goal
from presswork.view.faces import draw_faces
from presswork.view.plots.shell_plot import find_normals, frame_axes, scale_colours, shade
from presswork.view.style import clean_axes, save_picture

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d import Axes3D

    from presswork.study.compensate import Loop

PICTURE = "deviation.png"


def draw_deviation(goal: Goal, loops: Sequence[Loop], tolerance: float, folder: Path) -> Path | None:
    """Draw the wanted part coloured by the deviation of the first and the best loop, and the loops; None without
    matplotlib.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        return None
    best = min(loops, key=lambda loop: loop.worst)
    figure = Figure(figsize=(12.0, 4.4), layout="constrained")
    maps, course = np.asarray(figure.subfigures(1, 2, width_ratios=(2.0, 1.0)))
    shown = [loops[0]] if best.number == 0 else [loops[0], best]
    for number, loop in enumerate(shown, 1):
        _draw_map(maps, (1, len(shown), number), goal, loop)
    ax = course.subplots()
    numbers = [loop.number for loop in loops]
    share = goal.weight / goal.weight.sum()
    ax.semilogy(numbers, [loop.worst for loop in loops], "o-", color="C3", label="largest")
    rms = [float(np.sqrt(share @ loop.misfit.deviation**2)) for loop in loops]
    ax.semilogy(numbers, rms, "s-", color="0.35", label="root mean square")
    ax.axhline(tolerance, color="k", linestyle="--", linewidth=0.9, label="tolerance")
    ax.set(xlabel="loop", ylabel="deviation [mm]", xticks=numbers)
    ax.legend(frameon=False, fontsize="small")
    clean_axes(ax)
    return save_picture(figure, folder / PICTURE)


def _draw_map(figure: Figure, place: tuple[int, int, int], goal: Goal, loop: Loop) -> None:
    """Draw the wanted part coloured by a loop's deviation."""
    number = np.full(len(goal.points), -1)
    number[goal.is_part] = np.arange(len(goal.wanted))
    triangles = number[goal.triangles]
    triangles = triangles[(triangles >= 0).all(axis=1)]
    corners: FloatArray = goal.wanted[triangles]
    values = loop.misfit.deviation[triangles].mean(axis=1)
    largest = loop.worst or 1.0
    scaled = scale_colours(values, (-largest, largest), diverging=True)
    ax: Axes3D = figure.add_subplot(*place, projection="3d")
    ax.set_proj_type("ortho")
    ax.view_init(28.0, -58.0)
    frame_axes(ax, goal.wanted.min(axis=0), goal.wanted.max(axis=0), zoom=0.85)
    colours = shade(np.array(scaled.to_rgba(values), dtype=np.float64), find_normals(corners))
    draw_faces(ax, [corners], colours, 0.0)
    name = "tools as drawn" if loop.number == 0 else f"loop {loop.number}"
    ax.set_title(f"{name}: {loop.worst:.3g} mm off at most", fontsize="medium", y=0.9)
    bar = figure.colorbar(scaled, ax=ax, shrink=0.6, pad=0.1, orientation="horizontal")
    bar.set_label("deviation [mm]")
