# SPDX-License-Identifier: Apache-2.0
"""Force and speed of the ram of a press, over its stroke and over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from presswork.model import FloatArray
from presswork.results import Result
from presswork.view.plots.history_plot import find_moving_tools
from presswork.view.style import begin_at_zero, clean_axes, new_figure, require_matplotlib

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FORCE, SPEED = "tab:blue", "tab:orange"


def has_ram(history: dict[str, NDArray[Any]]) -> bool:
    """Return whether a ram has moved in a run."""
    return "ram_speed" in history and bool(np.any(history["ram_speed"] > 0.0))


def plot_ram(result: Result, figure: Figure | None = None) -> Figure:
    """Draw force [kN] and speed [mm/s] of the ram.

    Over the stroke of the tool that it moves [mm], and over the time that it works [ms].

    Time in which no ram works, such as that between blows, is left out; dashed lines part the stages. A dotted line is
    the force that the press bears.
    """
    require_matplotlib()
    figure = new_figure(9.6, 4.2) if figure is None else figure
    history = result.history
    stages = np.asarray(history["stage"])
    begins = np.append(0.0, history["time"][:-1])
    works = _find_works(history)
    stroke, tools = find_ram_strokes(history)
    of = f" of {tools[0]}" if len(tools) == 1 else ""
    time = 1e3 * np.cumsum(np.where(works, history["time"] - begins, 0.0))
    axes: list[Axes] = list(figure.subplots(1, 2))
    for ax, abscissa, label in zip(axes, (stroke, time), (f"stroke{of} [mm]", "time at work [ms]"), strict=True):
        other = ax.twinx()
        for name in dict.fromkeys(stages[works].tolist()):
            rows = stages == name
            ax.plot(abscissa[rows], 1e-3 * history["ram_force"][rows], color=FORCE, linewidth=1.8)
            if "ram_force_borne" in history:
                ax.plot(abscissa[rows], 1e-3 * history["ram_force_borne"][rows], color=FORCE, linestyle=":")
            other.plot(abscissa[rows], history["ram_speed"][rows], color=SPEED, linewidth=1.4)
            if np.flatnonzero(rows)[-1] < np.flatnonzero(works)[-1]:
                ax.axvline(abscissa[rows][-1], color="0.7", linewidth=0.8, linestyle="--")
        ax.set_xlabel(label)
        ax.set_ylabel("force on the ram [kN]", color=FORCE)
        other.set_ylabel("speed of the ram [mm/s]", color=SPEED)
        begin_at_zero(ax)
        other.set_ylim(bottom=0.0)
        clean_axes(ax)
        other.spines["top"].set_visible(False)
    figure.suptitle(str(result.info.get("title", "")), fontsize="medium")
    return figure


def find_ram_strokes(history: dict[str, NDArray[Any]]) -> tuple[FloatArray, list[str]]:
    """Return the stroke of the tool that moves most in each stage that a ram drives (n_rows,), and these tools.

    It is zero in the other stages.
    """
    stages, works = np.asarray(history["stage"]), _find_works(history)
    stroke, tools = np.zeros(len(stages)), []
    for name in dict.fromkeys(stages[works].tolist()):
        rows = stages == name
        tool = max(find_moving_tools(history), key=lambda t: float(np.ptp(history[f"{t}.stroke"][rows])))
        stroke[rows] = history[f"{tool}.stroke"][rows]
        tools.append(tool)
    return stroke, list(dict.fromkeys(tools))


def _find_works(history: dict[str, NDArray[Any]]) -> NDArray[np.bool_]:
    """Return the rows of stages that a ram drives (n_rows,)."""
    stages = np.asarray(history["stage"])
    driven = [name for name in dict.fromkeys(stages.tolist()) if np.any(history["ram_speed"][stages == name] > 0.0)]
    return np.asarray(np.isin(stages, driven))
