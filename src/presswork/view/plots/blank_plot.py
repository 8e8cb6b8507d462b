# SPDX-License-Identifier: Apache-2.0
"""A part's outline seen from above, within that of its blank."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from presswork.model import FloatArray
from presswork.results import Result
from presswork.view.mirror import IMAGES, Mirror
from presswork.view.style import new_figure, require_matplotlib

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def plot_blank(result: Result, *, mirror: Mirror = "", figure: Figure | None = None) -> Figure:
    """Draw the rims of the blank and of the part, mirrored by planes normal to x, y or both.

    Edges on a plane that mirrors are left out.
    """
    require_matplotlib()
    figure = new_figure(6.4, 5.6) if figure is None else figure
    ax = figure.subplots()
    edges = result.mesh.boundary_edges[:, :2]
    for step, style, label in ((0, "C0-", "blank"), (-1, "C3--", "part, from above")):
        points = result.points(step)[:, :2]
        kept = _off_planes(points, edges, mirror)
        for number, sign in enumerate(IMAGES[mirror]):
            lines = points[kept] * sign
            x, y = (np.column_stack([lines[..., k], np.full(len(lines), np.nan)]).ravel() for k in (0, 1))
            ax.plot(x, y, style, linewidth=1.2, label=label if number == 0 else None)
    size = np.ptp(result.points(0)[:, :2], axis=0) * [2 if axis in mirror else 1 for axis in "xy"]
    ax.set_aspect("equal")
    ax.set_xlabel("x [mm]")
    ax.set_ylabel("y [mm]")
    ax.set_title(
        f"{str(result.info.get('title', '')).strip()}\nblank {size[0]:.1f} x {size[1]:.1f} mm", fontsize="medium"
    )
    ax.legend(fontsize="small", loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False)
    return figure


def _off_planes(points: FloatArray, edges: np.ndarray, mirror: Mirror) -> np.ndarray:
    """Return the edges that do not lie on a plane that mirrors."""
    size = float(np.ptp(points, axis=0).max())
    on_plane = np.zeros(len(edges), dtype=bool)
    for axis, name in enumerate("xy"):
        if name in mirror:
            on_plane |= (np.abs(points[edges, axis]) < 1e-3 * size).all(axis=1)
    return edges[~on_plane]
