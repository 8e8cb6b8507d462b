# SPDX-License-Identifier: Apache-2.0
"""Marked points of the material: where they are in a picture, and what they have seen over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from presswork.fields.table import describe_field, find_unit
from presswork.results import OutputError, Result
from presswork.view.style import break_at_parts, clean_axes, new_figure, require_matplotlib

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

STRAIN = "equivalent_plastic_strain"
SHOWN = ("effective_stress", STRAIN, "temperature")
"""Quantities that are drawn over time, as far as there are such columns."""


def find_points(history: dict[str, NDArray[Any]]) -> list[str]:
    """Return the names of the marked points, those with a path and a strain of their own."""
    names = [name.removesuffix(f".{STRAIN}") for name in history if name.endswith(f".{STRAIN}")]
    return [name for name in names if f"{name}.x" in history]


def mark_points(ax: Axes, result: Result, step: int) -> None:
    """Draw the marked points of a section and their names where they are at a saved step."""
    try:
        history = result.history
    except OutputError:  # fields are drawn without one, too
        return
    names, time = find_points(history), float(result.times[step])
    if not names or time == 0.0 or not len(history["time"]):
        return
    row = int(np.abs(history["time"] - time).argmin())
    for name in names:
        place = history[f"{name}.x"][row], history[f"{name}.y"][row]
        ax.plot(*place, "o", markersize=5, markerfacecolor="white", markeredgecolor="#b0005a", zorder=8)
        ax.annotate(name, place, xytext=(4, 4), textcoords="offset points", fontsize="small", color="#b0005a", zorder=8)


def plot_points(result: Result, figure: Figure | None = None) -> Figure:
    """Draw stress, strain and temperature of the marked points over time [s]."""
    require_matplotlib()
    history = result.history
    names = find_points(history)
    shown = [quantity for quantity in SHOWN if f"{names[0]}.{quantity}" in history]
    figure = new_figure(6.4, 2.4 * len(shown)) if figure is None else figure
    figure.set_size_inches(6.4, 2.4 * len(shown) + 0.6)
    axes: list[Axes] = figure.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0].tolist()
    time = np.asarray(history["time"], dtype=np.float64)
    for ax, quantity in zip(axes, shown, strict=True):
        for name in names:
            ax.plot(time, break_at_parts(history, history[f"{name}.{quantity}"]), linewidth=1.6, label=name)
        unit = find_unit(quantity)
        ax.set_ylabel(f"{describe_field(quantity)} [{'–' if unit == '1' else unit}]", fontsize="small")
        clean_axes(ax)
    axes[0].set_title(str(result.info.get("title", "")))
    axes[0].legend(frameon=False, fontsize="small")
    axes[-1].set_xlabel("time [s]")
    axes[-1].set_xlim(0.0, float(time[-1]))
    return figure
