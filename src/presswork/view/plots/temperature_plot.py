# SPDX-License-Identifier: Apache-2.0
"""Temperatures of a run against time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from presswork.results import Result
from presswork.view.style import break_at_parts, clean_axes, new_figure, require_matplotlib

if TYPE_CHECKING:
    from matplotlib.axes import Axes

NARROW = 0.12
"""Part of the time that a stage's name needs to lie."""
PROCESS_TIME = "process_time"
MEAN, LOW, HIGH = "temperature_mean", "temperature_min", "temperature_max"


def has_temperatures(history: dict[str, NDArray[Any]]) -> bool:
    """Return whether a run has computed temperatures, and has come as far as its first row."""
    return MEAN in history and len(history["time"]) > 0


def find_widest_step(result: Result) -> int:
    """Return the saved step with the widest range of temperature."""
    ranges = [float(np.ptp(result.field("nodal_temperature", step))) for step in range(len(result.times))]
    return int(np.argmax(ranges))


def plot_temperatures(result: Result, ax: Axes | None = None) -> Axes:
    """Draw the mean temperature [degrees C] over time [s] between the lowest and the highest, stage by stage.

    Time is that of the process, where the computation has another.
    """
    require_matplotlib()
    ax = new_figure(6.4, 4.2).subplots() if ax is None else ax
    history = result.history
    time = np.asarray(history[PROCESS_TIME if PROCESS_TIME in history else "time"], dtype=np.float64)
    shown = {name: break_at_parts(history, values) for name, values in history.items() if "temperature" in name}
    ax.fill_between(time, shown[LOW], shown[HIGH], color="tab:red", alpha=0.18, linewidth=0, label="lowest, highest")
    bodies = [name.removesuffix(f".{MEAN}") for name in history if name.endswith(f".{MEAN}")]
    for body in bodies:
        ax.plot(time, shown[f"{body}.{MEAN}"], linewidth=1.8, label=f"mean of {body}")
    if not bodies:
        ax.plot(time, shown[MEAN], color="tab:red", linewidth=1.8, label="mean")
    stages = np.asarray(history["stage"])
    for row in np.flatnonzero(stages[1:] != stages[:-1]):
        ax.axvline(time[row], color="0.6", linewidth=0.8, linestyle="--")
    if len(np.unique(stages)) > 1 and "part" not in history:
        for name in dict.fromkeys(stages.tolist()):
            first, last = time[stages == name][[0, -1]]
            upright = last - first < NARROW * time[-1]
            ax.text(
                0.5 * (first + last),
                1.0,
                name,
                transform=ax.get_xaxis_transform(),
                ha="center",
                va="top",
                rotation="vertical" if upright else "horizontal",
                color="0.4",
            )
    ax.set_xlabel("time [s]")
    ax.set_ylabel("temperature [degrees C]")
    ax.set_title(str(result.info.get("title", "")))
    ax.set_xlim(0.0, float(time[-1]))
    ax.legend(frameon=False)
    clean_axes(ax)
    return ax
