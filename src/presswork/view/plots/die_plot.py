# SPDX-License-Identifier: Apache-2.0
"""Pictures of tools that conduct heat: temperature in workpiece and tools, and the tools' peaks from part to part."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from presswork.model import find_cell
from presswork.results import Result
from presswork.view.cells import triangulate
from presswork.view.mirror import IMAGES, Mirror
from presswork.view.style import COLOURS, clean_axes, describe_step, new_figure, require_matplotlib

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_LEVELS = 16
PEAK = ".temperature_max"


def plot_dies(result: Result, step: int = -1, *, mirror: Mirror = "", figure: Figure | None = None) -> Figure:
    """Draw the temperature in the workpiece and in the tools with meshes, each on a scale of its own."""
    require_matplotlib()
    from matplotlib.ticker import MaxNLocator
    from matplotlib.tri import Triangulation

    figure = new_figure(6.0, 5.6) if figure is None else figure
    figure.set_size_inches(6.0, 5.6)
    ax = figure.subplots()
    mesh, points = result.mesh_at(step), result.points(step)
    body = [(points, triangulate(mesh), result.field("nodal_temperature", step))]
    dies = [
        (place, np.concatenate([cells[:, corners] for corners in find_cell(2, cells).pieces]), values)
        for place, cells, values in result.dies(step).values()
    ]
    for group, colours, name in ((body, COLOURS, "workpiece"), (dies, "inferno", "tools")):
        every = np.concatenate([values for *_, values in group])
        low, high = float(every.min()), float(every.max())
        levels = MaxNLocator(_LEVELS).tick_values(low, max(high, low + 1.0))
        for place, triangles, values in group:
            for sign in IMAGES[mirror]:
                x, y = (place * sign).T
                drawn = ax.tricontourf(Triangulation(x, y, triangles), values, levels=levels, cmap=colours)
        figure.colorbar(drawn, ax=ax, label=f"{name} [degrees C]", shrink=0.8)
    for sign in IMAGES[mirror]:
        ax.plot(*(points[mesh.boundary_edges[:, :2]] * sign).transpose(2, 1, 0), color="k", linewidth=0.6)
    ax.set_aspect("equal")
    axisymmetric = result.info.get("analysis") == "axisymmetric"
    ax.set_xlabel("radius r [mm]" if axisymmetric else "x [mm]")
    ax.set_ylabel("height z [mm]" if axisymmetric else "y [mm]")
    title = str(result.info.get("title", "")).strip()
    figure.suptitle(f"{title}\n{describe_step(result, step)}".strip(), fontsize="medium")
    return figure


def plot_parts(result: Result, figure: Figure | None = None) -> Figure:
    """Draw the highest temperature of each tool over a part, and when its first increment ends, against the part."""
    require_matplotlib()
    from matplotlib.ticker import MaxNLocator

    figure = new_figure(6.0, 4.0) if figure is None else figure
    ax, history = figure.subplots(), result.history
    parts = np.asarray(history["part"], dtype=int)
    numbers = np.unique(parts)
    for name in (name for name in history if name.endswith(PEAK)):
        values = np.asarray(history[name], dtype=float)
        peak = [values[parts == part].max() for part in numbers]
        first = [values[parts == part][0] for part in numbers]
        (line,) = ax.plot(numbers, peak, "o-", label=f"{name.removesuffix(PEAK)}, peak")
        ax.plot(numbers, first, "o--", color=line.get_color(), fillstyle="none",
                label=f"{name.removesuffix(PEAK)}, hottest place as the part begins")  # fmt: skip
    ax.set_xlabel("part")
    ax.set_ylabel("temperature of the tool [degrees C]")
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    ax.set_title(str(result.info.get("title", "")))
    ax.legend(frameon=False, fontsize="small")
    clean_axes(ax)
    return figure
