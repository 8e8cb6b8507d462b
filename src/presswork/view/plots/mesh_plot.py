# SPDX-License-Identifier: Apache-2.0
"""Pictures of the deformed workpiece: the mesh with a field on it, and contours beside the mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from presswork.fields.table import describe_field
from presswork.model import FloatArray, IndexArray, find_cell
from presswork.post import average_to_nodes
from presswork.results import Result
from presswork.view.cells import outline_cells, triangulate
from presswork.view.crack_mark import mark_first_crack
from presswork.view.extremes import describe_extremes, mark_extremes
from presswork.view.lap_mark import mark_laps
from presswork.view.limit_colours import find_stops, make_limit_colours
from presswork.view.mirror import IMAGES, Mirror
from presswork.view.plots.marked_points_plot import mark_points
from presswork.view.plots.tool_plot import draw_tools
from presswork.view.style import COLOURS, describe_step, label_field, new_figure, require_matplotlib, title_step

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Colormap, Norm
    from matplotlib.figure import Figure

_N_LEVELS = 16
_WIDE = 5.5  # inches: both extremes fit into one line of the title


def plot_mesh(
    result: Result,
    field: str | None = "effective_stress",
    step: int = -1,
    ax: Axes | None = None,
    *,
    mirror: Mirror = "",
    show_edges: bool = True,
    value_range: tuple[float, float] | None = None,
    frame: tuple[FloatArray, FloatArray] | None = None,
) -> Axes:
    """Draw the deformed mesh coloured by a cell or point field, with the tools; `field=None` draws the bare mesh.

    Cell fields are shown as they are, one colour a cell; of a vector the length is shown. value_range: that of the
    colours, by default that of the values; frame: corners of what is shown [mm], by default around the body.
    """
    ax = _axes(result, step, mirror) if ax is None else ax
    prepare_section(ax, result, step, mirror)
    if frame is not None:
        ax.set(xlim=(frame[0][0], frame[1][0]), ylim=(frame[0][1], frame[1][1]))
    ax.set_title(title_step(ax, result, step), fontsize="medium")
    points = result.points(step)
    outlines = outline_cells(result.mesh_at(step), points)
    if field is None:
        _draw_cells(ax, outlines, None, mirror, show_edges, bare=True)
        return ax
    values = result.scalar(field, step)
    if result.kind(field) == "point":
        colours, places = _shade_points(ax, result, values, step, mirror), points
        _draw_cells(ax, outlines, None, mirror, show_edges, bare=False)
    else:
        colours = _draw_cells(ax, outlines, values, mirror, show_edges, bare=False)
        places = np.array([outline.mean(axis=0) for outline in outlines])
    _colour_by_limit(ax, result, field, values)
    for drawn in ax.collections if value_range is not None else ():
        if drawn.get_array() is not None:
            drawn.set_clim(value_range)
    _label_extremes(ax, result, field, values, places, step)
    _add_colour_bar(ax, colours, label_field(result, field))
    return ax


def plot_contours(
    result: Result, field: str = "effective_stress", step: int = -1, ax: Axes | None = None, *, mirror: Mirror = ""
) -> Axes:
    """Draw filled contours of a field on the deformed body; cell fields are averaged to the nodes."""
    ax = _axes(result, step, mirror) if ax is None else ax
    prepare_section(ax, result, step, mirror)
    ax.set_title(title_step(ax, result, step), fontsize="medium")
    points, values = result.points(step), result.scalar(field, step)
    if result.kind(field) == "cell":
        values = average_to_nodes(points, [block.connectivity for block in result.mesh_at(step).blocks], values)
    triangles = triangulate(result.mesh_at(step))
    triangles = triangles[np.isfinite(values[triangles]).all(axis=1)]
    if len(triangles) == 0:
        ax.text(0.5, 0.5, "no finite values", transform=ax.transAxes, ha="center")
        return ax
    from matplotlib.tri import Triangulation

    levels, (colours, norm) = _levels(values), _find_colours(result, field, values)
    shown = np.clip(np.nan_to_num(values, nan=levels[0]), levels[0], levels[-1])
    for sign in IMAGES[mirror]:
        x, y = (points * sign).T
        net = Triangulation(x, y, triangles)
        drawn = ax.tricontourf(net, shown, levels=levels, cmap=colours, norm=norm, zorder=1)
        ax.tricontour(net, shown, levels=levels, colors="k", linewidths=0.25, zorder=1.5)
        draw_boundary(ax, result.mesh_at(step).boundary_edges, points, sign, mirror)
    _label_extremes(ax, result, field, values, points, step)
    _add_colour_bar(ax, drawn, label_field(result, field))
    return ax


def plot_mesh_and_contours(
    result: Result,
    field: str = "effective_stress",
    step: int = -1,
    *,
    mirror: Mirror = "",
    figure: Figure | None = None,
) -> Figure:
    """Draw the bare deformed mesh on the left and contours of a field on the right; the figure is sized to fit."""
    width, height = panel_size(result, step, mirror)
    figure = new_figure(2 * width, height + 0.8) if figure is None else figure
    figure.set_size_inches(2 * width, height + 0.8)
    figure.set_layout_engine("constrained", h_pad=0.18)  # else the labels below the axes are cut
    left, right = figure.subplots(1, 2, sharex=True, sharey=True)
    plot_mesh(result, None, step, left, mirror=mirror)
    plot_contours(result, field, step, right, mirror=mirror)
    moved = bool(result.field("displacement", step).any())
    left.set_title("deformed mesh" if moved else "mesh", fontsize="medium")
    faults = right.get_title().removeprefix(title_step(right, result, step, field)).lstrip()
    right.set_title(f"{describe_field(field)}\n{faults}".rstrip(), fontsize="medium")
    right.set_ylabel("")
    title = str(result.info.get("title", "")).strip()
    figure.suptitle(f"{title}\n{describe_step(result, step)}" if title else describe_step(result, step))
    return figure


def _axes(result: Result, step: int, mirror: Mirror) -> Axes:
    """Return the axes of a new figure of one panel."""
    return new_figure(*panel_size(result, step, mirror)).subplots()


def panel_size(result: Result, step: int, mirror: Mirror) -> tuple[float, float]:
    """Return width and height [inch] of a panel that suits the body."""
    low, high = _limits(result, step, mirror)
    aspect = (high[1] - low[1]) / (high[0] - low[0])
    width = float(np.clip(3.6 / aspect**0.5, 3.0, 6.0))
    return width + 1.4, float(np.clip(width * aspect, 2.0, 7.5)) + 1.1


def _limits(result: Result, step: int, mirror: Mirror) -> tuple[FloatArray, FloatArray]:
    """Return the corners of a frame around the body and its images."""
    points = np.concatenate([result.points(step) * sign for sign in IMAGES[mirror]])
    low, high = points.min(axis=0), points.max(axis=0)
    margin = 0.07 * float(np.max(high - low))
    return low - margin, high + margin


def prepare_section(ax: Axes, result: Result, step: int, mirror: Mirror) -> None:
    """Set frame, labels and aspect, and draw the tools and the marked points."""
    require_matplotlib()
    low, high = _limits(result, step, mirror)
    ax.set_aspect("equal")
    ax.set_xlim(low[0], high[0])
    ax.set_ylim(low[1], high[1])
    axisymmetric = result.info.get("analysis") == "axisymmetric"
    ax.set_xlabel("radius r [mm]" if axisymmetric else "x [mm]")
    ax.set_ylabel("height z [mm]" if axisymmetric else "y [mm]")
    draw_tools(ax, result, step, 0.05 * float(np.max(high - low)), IMAGES[mirror])
    mark_points(ax, result, step)


def _levels(values: FloatArray) -> FloatArray:
    """Return round contour levels that span the finite values."""
    from matplotlib.ticker import MaxNLocator

    finite = values[np.isfinite(values)]
    low, high = float(finite.min()), float(finite.max())
    if high - low <= 1e-9 * max(abs(low), abs(high)):
        half = 0.5 * abs(low) or 0.5
        return np.array([low - half, low + half])
    return np.asarray(MaxNLocator(_N_LEVELS, steps=[1, 2, 5, 10]).tick_values(low, high), dtype=np.float64)


def _draw_cells(
    ax: Axes, outlines: list[FloatArray], values: FloatArray | None, mirror: Mirror, show_edges: bool, *, bare: bool
) -> ScalarMappable:
    """Draw all cells, filled by value, with plain faces or with none."""
    from matplotlib.collections import PolyCollection

    width = float(np.clip(12.0 / np.sqrt(len(outlines)), 0.04, 0.7)) if show_edges else 0.0
    limits = None
    if values is not None and np.isfinite(values).any():
        limits = float(np.nanmin(values[np.isfinite(values)])), float(np.nanmax(values[np.isfinite(values)]))
    for sign in IMAGES[mirror]:
        cells = PolyCollection([outline * sign for outline in outlines], linewidths=width, zorder=1)
        cells.set_edgecolor("0.15" if show_edges else "none")
        if values is None:
            cells.set_facecolor("#e8eef5" if bare else "none")
        else:
            cells.set_array(np.ma.masked_invalid(values))
            cells.set_cmap(COLOURS)
            cells.set_clim(*(limits or (0.0, 1.0)))
            if not show_edges:
                cells.set_edgecolor("face")
                cells.set_linewidth(0.2)
        ax.add_collection(cells, autolim=False)
    return cells


def _colour_by_limit(ax: Axes, result: Result, field: str, values: FloatArray) -> None:
    """Colour what is drawn of a field that has a limit from green to red."""
    colours, norm = _find_colours(result, field, values)
    for drawn in ax.collections if norm is not None else ():
        if drawn.get_array() is not None:
            drawn.set(cmap=colours, norm=norm)


def _find_colours(result: Result, field: str, values: FloatArray) -> tuple[str | Colormap, Norm | None]:
    """Return the colours of a field and what takes values to them: from green to red where it has a limit."""
    finite = values[np.isfinite(values)]
    stops = find_stops(result, field, float(finite.min()), float(finite.max())) if len(finite) else []
    scaled = make_limit_colours(stops) if stops else None
    return (COLOURS, None) if scaled is None else (scaled.get_cmap(), scaled.norm)


def _label_extremes(ax: Axes, result: Result, field: str, values: FloatArray, places: FloatArray, step: int) -> None:
    """Mark the extremes of the values (n,) at their places (n, 2) [mm] and the first crack.

    The title has the field, the step and what is at fault; the extremes stand below.
    """
    mark_extremes(ax, values, places)
    crack = mark_first_crack(ax, result, field, step)
    faults = ", ".join(words for words in (crack, mark_laps(ax, result, step)) if words)
    extremes = describe_extremes(values, places)
    if ax.figure.bbox.width < _WIDE * ax.figure.dpi:
        extremes = extremes.replace("mm, min", "mm\nmin")
    ax.set_title(f"{title_step(ax, result, step, field)}\n{faults}".rstrip(), fontsize="medium")
    ax.set_xlabel(f"{ax.get_xlabel()}\n{extremes}".rstrip())


def _shade_points(ax: Axes, result: Result, values: FloatArray, step: int, mirror: Mirror) -> ScalarMappable:
    """Colour the body smoothly by values at its points (n_points,)."""
    from matplotlib.tri import Triangulation

    points, triangles = result.points(step), triangulate(result.mesh_at(step))
    shown = np.nan_to_num(values)
    for sign in IMAGES[mirror]:
        x, y = (points * sign).T
        net = Triangulation(x, y, triangles)
        drawn: ScalarMappable = ax.tripcolor(net, shown, shading="gouraud", cmap=COLOURS, zorder=0.9)
    return drawn


def draw_boundary(ax: Axes, edges: IndexArray, points: FloatArray, sign: tuple[int, int], mirror: Mirror) -> None:
    """Draw the edge of the body, or of one of its images, but for what lies in a mirror."""
    from matplotlib.collections import LineCollection

    for axis, name in enumerate("xy"):
        if name in mirror:
            edges = edges[np.any(np.abs(points[edges, axis]) > 1e-6 * np.ptp(points), axis=1)]
    lines = list(points[edges[:, find_cell(1, edges).ring]] * sign)
    ax.add_collection(LineCollection(lines, colors="0.15", linewidths=0.9, zorder=2), autolim=False)


def _add_colour_bar(ax: Axes, drawn: ScalarMappable, label: str) -> None:
    """Put a colour bar of the panel's height beside it."""
    bar = ax.figure.colorbar(drawn, cax=ax.inset_axes((1.03, 0.0, 0.035, 1.0)))
    bar.set_label(label)
    bar.outline.set_linewidth(0.5)
