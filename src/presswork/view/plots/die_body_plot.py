# SPDX-License-Identifier: Apache-2.0
"""The picture of a die's body: von Mises's and the largest principal stress at the worst instant, and over the run."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from presswork.dies.study import DieStudy, largest_principal, name_part, von_mises
from presswork.model import FloatArray
from presswork.view.style import COLOURS, bare_figure, clean_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LEVELS = 16
SHOWN = 0.995
"""Part of the nodes up to whose stress colours reach; a corner would take them all."""
_TRIANGLES = ((0, 4, 7), (4, 1, 5), (5, 2, 6), (6, 3, 7), (4, 5, 7), (5, 6, 7))
"""Triangles between the nodes of a quadrilateral of eight."""


def plot_die(study: DieStudy) -> Figure:
    """Draw the worst instant of a die, and its largest stresses over the run where there are several instants."""
    worst = study.worst
    has_course = len(study.instants) > 1
    wide, high = np.ptp(study.structure.points, axis=0)
    panel = float(np.clip(4.0 * high / wide, 2.4, 6.0))
    figure = bare_figure(9.6, panel + (2.8 if has_course else 0.8))
    grid = figure.add_gridspec(2 if has_course else 1, 2, height_ratios=[panel, 2.0] if has_course else [1])
    values = (von_mises(worst.answer.stress), largest_principal(worst.answer.stress))
    labels = ("von Mises stress [MPa]", "largest principal stress [MPa], zero in white")
    for column, (value, label) in enumerate(zip(values, labels, strict=True)):
        _draw_stress(figure.add_subplot(grid[0, column]), study, value, label)
    if has_course:
        _draw_course(figure.add_subplot(grid[1, :]), study)
    force = ", ".join(f"{value / 1e3:.4g}" for value in worst.force)
    state = f"{study.tool} at {100 * worst.part:.0f} % of the run, force ({force}) kN"
    figure.suptitle("\n".join(filter(None, (study.title, state))), fontsize="medium")
    return figure


def _draw_stress(ax: Axes, study: DieStudy, values: FloatArray, label: str) -> None:
    """Draw a stress over all parts, with their outlines and the loads of the workpiece."""
    from matplotlib.tri import Triangulation

    points, structure = study.structure.points, study.structure
    low, high = np.quantile(values, [1.0 - SHOWN, SHOWN])
    levels = np.linspace(float(low), float(high) + 1e-6 * max(1.0, abs(float(high))), LEVELS + 1)
    for cells in structure.cells:
        net = Triangulation(
            points[:, 0], points[:, 1], np.concatenate([cells[:, list(corners)] for corners in _TRIANGLES])
        )
        drawn = ax.tricontourf(net, values, levels=levels, cmap=COLOURS, extend="both")
        if values.min() < 0.0 < values.max():
            ax.tricontour(net, values, levels=[0.0], colors="white", linewidths=0.9)
    for number in range(len(structure.cells)):
        for edge in structure.outlines[number]:
            ax.plot(*points[edge].T, color="black", linewidth=0.7)
    at = int(np.argmax(values))
    ax.plot(*points[at], "x", color="red", markersize=7)
    ax.set(aspect="equal", xlabel="x [mm]", ylabel="y [mm]", title=f"largest {values[at]:.4g} MPa")
    ax.title.set_fontsize("medium")
    assert ax.figure is not None
    ax.figure.colorbar(drawn, ax=ax, label=label, shrink=0.8, format="%.0f")


def _draw_course(ax: Axes, study: DieStudy) -> None:
    """Draw the largest stresses of each part over the run."""
    part = [100 * now.part for now in study.instants]
    judged = [study.judge(now.answer) for now in study.instants]
    for number in range(len(study.structure.cells)):
        name = name_part(number)
        (line,) = ax.plot(part, [each[number].von_mises.value for each in judged], ".-", label=f"{name}, von Mises")
        tension = [each[number].tension.value for each in judged]
        ax.plot(part, tension, ".--", color=line.get_color(), label=f"{name}, principal")
    ax.set(xlabel="part of the run [%]", ylabel="largest stress [MPa]")
    ax.legend(fontsize="small", ncols=2)
    clean_axes(ax)
