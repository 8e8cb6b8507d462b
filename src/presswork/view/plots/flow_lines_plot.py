# SPDX-License-Identifier: Apache-2.0
"""Grain flow: lines that were straight in the undeformed section, drawn where their material is now.

Lines of one initial x (or radius) follow the fibres of bar stock whose axis is y; those of one initial y cross them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from presswork.model import FloatArray
from presswork.results import Result
from presswork.view.cells import triangulate
from presswork.view.lap_mark import mark_laps
from presswork.view.mirror import IMAGES, Mirror
from presswork.view.plots.mesh_plot import draw_boundary, panel_size, prepare_section
from presswork.view.style import new_figure, title_step

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.tri import Triangulation

LINES = 20
"""Lines of one family over the longer side of the undeformed body."""
_TITLE = 0.5  # inches, for the lines of the title
_FILL, _COLOURS, _WIDTHS = "#eef1f5", ("#1b3a6b", "#b06a2c"), (0.9, 0.6)


def space_lines(points: FloatArray) -> list[FloatArray]:
    """Return the places of the lines of each coordinate of the undeformed points (n_points, d) [mm].

    They are as far apart in all directions, within a whole number of lines, and none lies on the ends of the body.
    """
    low, extent = points.min(axis=0), np.ptp(points, axis=0)
    counts = np.maximum(np.rint(LINES * extent / extent.max()).astype(int), 1)
    return [a + (np.arange(n) + 0.5) * e / n for a, n, e in zip(low, counts, extent, strict=True)]


def flow_panel_size(result: Result, step: int, mirror: Mirror) -> tuple[float, float]:
    """Return width and height [inch] of a panel that suits the body and has room for the title."""
    width, height = panel_size(result, step, mirror)
    return width, height + _TITLE


def plot_flow_lines(result: Result, step: int = -1, ax: Axes | None = None, *, mirror: Mirror = "") -> Axes:
    """Draw the grain flow of a section (see is_section)."""
    if ax is None:
        ax = new_figure(*flow_panel_size(result, step, mirror)).subplots()
    prepare_section(ax, result, step, mirror)
    from matplotlib.colors import ListedColormap
    from matplotlib.tri import Triangulation

    mesh, points, places = result.mesh_at(step), result.points(step), space_lines(result.mesh.points)
    triangles = triangulate(mesh)
    for sign in IMAGES[mirror]:
        x, y = (points * sign).T
        net = Triangulation(x, y, triangles)
        ax.tripcolor(net, facecolors=np.zeros(len(triangles)), cmap=ListedColormap([_FILL]), zorder=0.9)
        finer, initial = _refine(net, mesh.points)
        for axis, (colour, width) in enumerate(zip(_COLOURS, _WIDTHS, strict=True)):
            ax.tricontour(
                finer, initial[:, axis], levels=places[axis], colors=colour, linewidths=width, zorder=2.0 - 0.1 * axis
            )
        draw_boundary(ax, mesh.boundary_edges, points, sign, mirror)
    names = ("radius", "height") if result.info.get("analysis") == "axisymmetric" else ("x", "y")
    extent = np.ptp(result.mesh.points, axis=0)
    notes = [
        f"initial {names[axis]} every {extent[axis] / len(places[axis]):.3g} mm ({word})"
        for axis, word in ((0, "blue"), (1, "brown"))
    ]
    fault = mark_laps(ax, result, step)
    ax.set_title("\n".join([title_step(ax, result, step), *notes, *([fault] if fault else [])]), fontsize="medium")
    return ax


def _refine(net: Triangulation, values: FloatArray) -> tuple[Triangulation, FloatArray]:
    """Return triangles split in 16 and values of nodes (n, m) there, quadratic in each, so that lines are smooth.

    In the middle of a side is the value of the cubic with the slopes at its ends; slopes at nodes are means of those of
    the triangles round them.
    """
    from matplotlib.tri import UniformTriRefiner

    corners = np.stack([net.x, net.y], axis=1)[net.triangles]
    sides = np.roll(corners, -1, axis=1) - corners  # the one that follows each corner
    double = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    across = np.roll(sides, -1, axis=1)  # opposite to each corner; its normal is the slope of the corner's share
    normals = np.stack([-across[..., 1], across[..., 0]], axis=-1)
    gradient = np.einsum("tad,tam->tdm", normals, values[net.triangles])  # times the area, twice
    weight = np.bincount(net.triangles.ravel(), np.repeat(double, 3), len(values))
    slopes = np.zeros((len(values), 2, values.shape[1]))
    for column in net.triangles.T:
        np.add.at(slopes, column, gradient)
    slopes /= np.where(weight == 0.0, 1.0, weight)[:, None, None]
    at, ahead = net.triangles, np.roll(net.triangles, -1, axis=1)
    middles = 0.5 * (values[at] + values[ahead]) + np.einsum("tad,tadm->tam", sides, slopes[at] - slopes[ahead]) / 8.0
    finer, home = UniformTriRefiner(net).refine_triangulation(return_tri_index=True, subdiv=2)
    away = np.stack([finer.x, finer.y], axis=1)[:, None] - corners[home]
    turned = away[..., 1] * across[home][..., 0] - away[..., 0] * across[home][..., 1]
    share = 1.0 + turned / np.where(double == 0.0, 1.0, double)[home][:, None]
    found = np.einsum("na,nam->nm", share * (2.0 * share - 1.0), values[net.triangles[home]])
    return finer, found + np.einsum("na,nam->nm", 4.0 * share * np.roll(share, -1, axis=1), middles[home])


def is_section(result: Result) -> bool:
    """Return whether the body is a section in the plane or in axisymmetry."""
    return bool(result.mesh.points.shape[1] == 2)


def has_remeshed(result: Result) -> bool:
    """Return whether the body got a new mesh in the run."""
    return bool(np.asarray(result.history.get("remeshes", 0)).any())
