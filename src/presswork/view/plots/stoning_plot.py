# SPDX-License-Identifier: Apache-2.0
"""The picture of a stoning: gaps over the plan of a panel, by what shows on paint."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from presswork.post.stoning import Stoning
from presswork.view.style import bare_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLOURS = ("#d9f0d3", "#ffe08a", "#f29f4b", "#c8102e")
"""Below what shows, up to half of what is refused, up to it, beyond."""


def plot_stoning(found: Stoning, *, shows: float, refused: float, title: str = "") -> Figure:
    """Draw the gaps; shows, refused: those from which they show on paint and are refused [mm]."""
    from matplotlib.colors import BoundaryNorm, ListedColormap

    wide, high = np.ptp(found.x), np.ptp(found.y)
    figure = bare_figure(7.2, float(np.clip(5.4 * high / max(wide, 1e-9) + 1.2, 2.6, 8.0)))
    ax = figure.subplots()
    largest, x, y = found.worst
    edges = [
        min(0.0, float(np.nanmin(found.gap))),
        shows,
        0.5 * (shows + refused),
        refused,
        max(1.5 * refused, largest),
    ]
    drawn = ax.pcolormesh(
        found.x, found.y, found.gap.T, cmap=ListedColormap(COLOURS), norm=BoundaryNorm(edges, 4), shading="nearest"
    )
    ax.plot(x, y, "kx", markersize=8)
    ax.set(aspect="equal", xlabel="x [mm]", ylabel="y [mm]")
    figure.colorbar(drawn, ax=ax, label="gap under the stone [mm]", shrink=0.8, format="%.3f", ticks=edges)
    worst = f"largest {largest:.3f} mm at ({x:.4g}, {y:.4g}) mm (x)"
    ax.set_title("\n".join(filter(None, (title, worst))), fontsize="medium")
    return figure
