# SPDX-License-Identifier: Apache-2.0
"""Pictures of a deformed sheet or solid in space."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from presswork.fields.table import describe_field
from presswork.formability import PATH_MARGINS, ZONES
from presswork.model import FloatArray
from presswork.post import find_skin
from presswork.post.section import cut_tool
from presswork.post.weld_lines import find_welds
from presswork.results import Result, ResultMesh
from presswork.view.cells import outline_blocks
from presswork.view.crack_mark import describe_first_crack, find_first_crack, place_first_crack
from presswork.view.extremes import describe_extremes
from presswork.view.faces import draw_faces, find_projection
from presswork.view.limit_colours import find_stops, make_limit_colours
from presswork.view.mirror import IMAGES, Mirror
from presswork.view.style import COLOURS, ZONE_COLOURS, describe_step, label_field, new_figure, require_matplotlib
from presswork.view.whole_tools import TOOL_COLOURS, DrawnTool, find_tool_faces, view_direction

if TYPE_CHECKING:
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d import Axes3D

_TOOL_GREYS = ("0.2", "#8a5a2b", "#2b6a8a", "#5a8a2b")
_TOOL_SECTIONS = (0.0, 90.0, 180.0, 270.0)
"""Half planes in which tools are drawn [degree]: whole surfaces would hide the sheet."""
ZONE_FIELD = "formability_zone"
DIVERGING = ("thinning", "thickness_strain", "deviation")
"""Fields whose sign matters."""
DIVERGING_COLOURS = "RdBu_r"
_JUDGED = (ZONE_FIELD, "forming_limit_margin", *PATH_MARGINS, "fold_ratio")
"""Fields whose picture repeats the verdict of the run."""
_NOT_JUDGED = "#ffffff"
"""Colour of cells whose material has no forming limit."""
_WELD = "#c2007a"
"""Colour of weld lines."""
_LIGHT = np.array([0.35, -0.5, 0.8])
_WIDTH, _SQUARE, _LEFT = 7.0, 5.6, 0.1
"""Width of a figure, side of the axes in space in it, and what is left of them [inch]."""
_FILLED, _FILLED_UP = 0.82, 1.1
"""Parts of that side that the body's frame fills across and, where it is taller, upwards."""
_ABOVE, _LABELS, _LINE, _GAP, _ZONES_HEIGHT = 0.25, 0.6, 0.2, 0.16, 0.75
"""Room above the frame, for labels of axes below it, a line of text, beside lines, the legend of zones [inch]."""
_BAR, _BAR_LEFT = 2.4, 6.05
"""Length of the colour bar, and where it stands [inch]."""


def plot_shell(
    result: Result,
    field: str | None = "effective_stress",
    step: int = -1,
    *,
    mirror: Mirror = "",
    scale: float = 1.0,
    view: tuple[float, float] = (28.0, -58.0),
    show_edges: bool = True,
    value_range: tuple[float, float] | None = None,
    frame: tuple[FloatArray, FloatArray] | None = None,
    figure: Figure | None = None,
) -> Figure:
    """Draw the deformed sheet, or the surface of a solid, coloured by a field and shaded by its slope.

    `field=None` draws the bare mesh.
    Tools behind the part are drawn whole, all tools as sections along x and y, too. Point fields are shown as the
    mean of a cell's nodes; of a vector the length is shown. scale: factor on the displacement. view: elevation and
    azimuth [degree]. mirror: planes through the origin, normal to x, y or both. value_range: that of the colours,
    by default that of the values; frame: corners of what is shown [mm], by default of the body.
    """
    require_matplotlib()
    figure = new_figure(7.0, 5.2) if figure is None else figure
    ax: Axes3D = figure.add_subplot(projection="3d")
    ax.set_proj_type("ortho")
    ax.view_init(*view)
    mesh, moved = result.mesh_at(step), result.points(step)
    points = mesh.points + scale * (moved - mesh.points)
    skin, owner = find_skin(mesh)
    outlines = outline_blocks(skin, points)
    n_faces = sum(len(block) for block in outlines)
    values = None if field is None else _face_values(result, field, step, skin, owner)
    scaled = None if values is None or field is None else _choose_colours(result, field, values, value_range)
    colours = _colours(values, outlines, scaled, by_zone=field == ZONE_FIELD)
    width = float(np.clip(10.0 / np.sqrt(n_faces), 0.04, 0.6)) if show_edges else 0.0
    signs = [(x, y, 1) for x, y in IMAGES[mirror]]
    low = np.min([(points * sign).min(axis=0) for sign in signs], axis=0)
    high = np.max([(points * sign).max(axis=0) for sign in signs], axis=0)
    low, high = (low, high) if frame is None else frame
    magnified = "" if scale == 1.0 else f", displacement x {scale:g}"
    shown = f"{describe_field(field)}, " if field else ""
    title = str(result.info.get("title", "")).strip()
    head = [*filter(None, (title, f"{shown}{describe_step(result, step)}{magnified}"))]
    foot = "" if values is None or field is None else _describe_values(result, field, step, values, outlines)
    by_zone = field == ZONE_FIELD and values is not None
    frame_axes(ax, low, high)
    fill_figure(figure, ax, head, foot, below=_ZONES_HEIGHT if by_zone else 0.0)
    blocks = [block * sign for sign in signs for block in outlines]
    tools = _draw_tools(ax, result, step, [points * sign for sign in signs], low, high)
    draw_faces(ax, blocks, np.tile(colours, (len(signs), 1)), width, _cut_tools(result, step, low, high), tools)
    _draw_welds(ax, result, step, [points * sign for sign in signs])
    if by_zone and values is not None:
        _add_zone_legend(figure, values)
    elif field is not None and values is not None and scaled is not None:
        ends = values if value_range is None else np.array(value_range)
        add_colour_bar(figure, ax, ends, scaled, label_field(result, field))
        _mark_first_crack(ax, result, field, step, points)
    return figure


def _draw_welds(ax: Axes3D, result: Result, step: int, images: Sequence[FloatArray]) -> None:
    """Draw the weld lines of a welded blank on top of all; images: of its points, whole and mirrored (n_points, 3)."""
    if not result.zones:
        return
    from mpl_toolkits.mplot3d.art3d import Line3DCollection

    edges = find_welds(result, step)
    ax.computed_zorder = False  # else the faces around hide them
    for points in images:
        for colour, line in (("white", 3.0), (_WELD, 1.6)):
            ax.add_collection3d(Line3DCollection(points[edges], colors=colour, linewidths=line, zorder=15))


def _choose_colours(
    result: Result, field: str, values: FloatArray, value_range: tuple[float, float] | None
) -> ScalarMappable:
    """Return the colours of a field: by its limit, from green to red, where it has one."""
    finite = values[np.isfinite(values)]
    low, high = value_range or ((float(finite.min()), float(finite.max())) if len(finite) else (0.0, 1.0))
    stops = find_stops(result, field, low, high)
    return make_limit_colours(stops) if stops else scale_colours(values, value_range, diverging=field in DIVERGING)


def _describe_values(result: Result, field: str, step: int, values: FloatArray, outlines: list[FloatArray]) -> str:
    """Return what stands below the picture of a field: its extremes, the first crack, and the verdict of a limit."""
    crack = find_first_crack(result, field)
    extremes = describe_extremes(values, np.concatenate([block.mean(axis=1) for block in outlines]))
    lines = ["" if field == ZONE_FIELD else extremes, describe_first_crack(crack) if crack else ""]
    if field in _JUDGED and step % len(result.times) == len(result.times) - 1:
        lines.append(_describe_verdict(result, field))
    return "\n".join(filter(None, lines))


def _describe_verdict(result: Result, field: str) -> str:
    """Return what the run found by the end of forming: of folds or of the forming limit; empty if nothing."""
    found = result.summary.get("formability", {})
    if field == "fold_ratio":
        count = found.get("folds")
        return "" if count is None else f"{count or 'no'} fold{'' if count == 1 else 's'} of the whole part"
    return str(found.get("verdict", "")).partition(";")[0]


def _mark_first_crack(ax: Axes3D, result: Result, field: str, step: int, points: FloatArray) -> None:
    """Mark where a crack first began by a cross on top of all."""
    crack = find_first_crack(result, field)
    place = None if crack is None else place_first_crack(result, crack, step, points)
    if place is None:
        return
    ax.computed_zorder = False  # else the faces around hide it
    for size, colour, line in ((110, "white", 4.0), (80, "#d1001f", 2.2)):
        ax.scatter(*place[:, None], s=size, marker="x", c=colour, linewidths=line, zorder=20, depthshade=False)


def fill_figure(figure: Figure, ax: Axes3D, head: Sequence[str], foot: str, *, below: float = 0.0) -> None:
    """Size a figure by what is drawn in space in it, with lines of title above and of figures below.

    ax: orthographic axes whose frame is set; below: room for a legend [inch]. The axes are a square that may reach over
    the ends of the figure: only its middle is filled.
    """
    figure.set_layout_engine("none")
    figure.set_size_inches(_WIDTH, _WIDTH)
    ax.set_position((0.0, 0.0, _SQUARE / _WIDTH, _SQUARE / _WIDTH))
    ends = np.array([ax.get_xlim(), ax.get_ylim(), ax.get_zlim()])
    corners = np.array([[x, y, z, 1.0] for x in ends[0] for y in ends[1] for z in ends[2]])
    size = np.zeros(2)
    for zoom in (1.0, 0.0):
        ax.set_box_aspect(np.ptp(ends, axis=1), zoom=zoom or float(min(_FILLED / size[0], _FILLED_UP / size[1])))
        places = ax.transData.transform(corners @ find_projection(ax).T)
        size = np.ptp(places, axis=0) / (figure.dpi * _SQUARE)
    up = float(size[1]) * _SQUARE
    above, under = _LINE * len(head) + _GAP, below + (_LINE * (1 + foot.count("\n")) + _GAP if foot else _GAP)
    height = up + _ABOVE + _LABELS + above + under
    figure.set_size_inches(_WIDTH, height)
    bottom = under + _LABELS + 0.5 * up - 0.5 * _SQUARE
    ax.set_position((_LEFT / _WIDTH, bottom / height, _SQUARE / _WIDTH, _SQUARE / height))
    figure.suptitle("\n".join(head), fontsize="medium", y=1.0 - 0.5 * _GAP / height)
    if foot:
        figure.supxlabel(foot, fontsize="small", y=(below + 0.5 * _GAP) / height)


def scale_colours(values: FloatArray, value_range: tuple[float, float] | None, *, diverging: bool) -> ScalarMappable:
    """Return the colours of the values; of a diverging field zero is in the middle, and white."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    finite = values[np.isfinite(values)]
    low, high = value_range or ((float(finite.min()), float(finite.max())) if len(finite) else (0.0, 1.0))
    if diverging:
        largest = max(abs(low), abs(high)) or 1.0
        return ScalarMappable(Normalize(-largest, largest), DIVERGING_COLOURS)
    return ScalarMappable(Normalize(low, high if high > low else low + 1.0), COLOURS)


def _draw_tools(
    ax: Axes3D, result: Result, step: int, images: Sequence[FloatArray], low: FloatArray, high: FloatArray
) -> list[DrawnTool]:
    """Return the tools that are drawn whole. images: points of the part, whole and mirrored (n_points, 3) [mm]."""
    from matplotlib.colors import to_rgba

    part, towards, found = np.concatenate(images), view_direction(ax), []
    for number, tool in enumerate(result.tools_at_work(step)):
        corners, opacity = find_tool_faces(result, tool, step, part, low, high, towards)
        if len(corners):
            colours = np.tile(to_rgba(TOOL_COLOURS[number % len(TOOL_COLOURS)], opacity), (len(corners), 1))
            found.append(DrawnTool(corners, shade(colours, find_normals(corners))))
    return sorted(found, key=lambda tool: float(tool.colours[0, 3]))


def _cut_tools(result: Result, step: int, low: FloatArray, high: FloatArray) -> list[tuple[FloatArray, str]]:
    """Return lines (n, 2, 3) and colours where planes through the middle of the sheet's frame cut the tools."""
    margin = 0.15 * float((high - low).max())
    found = []
    for grey, tool in zip(_TOOL_GREYS, result.tools_at_work(step), strict=False):
        for angle in np.radians(_TOOL_SECTIONS):
            lines = cut_tool(result, tool, float(angle), step)
            space = np.concatenate([lines[..., :1] * (np.cos(angle), np.sin(angle)), lines[..., 1:]], axis=2)
            kept = _clip(space, low - margin, high + margin)
            if len(kept):  # a strip's tools do not reach every plane
                found.append((kept, grey))
    return found


def _clip(lines: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """Return the parts of lines (n, 2, 3) inside a box."""
    start, along = lines[:, :1], lines[:, 1:] - lines[:, :1]
    along = np.where(np.abs(along) < 1e-12, 1e-12, along)
    at = np.stack([(low - start) / along, (high - start) / along])
    first, last = np.maximum(at.min(axis=0).max(axis=2), 0.0), np.minimum(at.max(axis=0).min(axis=2), 1.0)
    kept = (first < last)[:, 0]
    ends = np.stack([first[kept], last[kept]], axis=1)
    return np.asarray(start[kept] + ends * along[kept])


def _face_values(
    result: Result, field: str, step: int, skin: ResultMesh, owner: NDArray[np.int32] | None
) -> FloatArray:
    """Return a field as one number per face of the skin: of its cell, or the mean of its nodes."""
    values = result.scalar(field, step)
    if result.kind(field) == "cell":
        return values if owner is None else values[owner]
    return np.concatenate([values[block.connectivity].mean(axis=1) for block in skin.blocks])


def _colours(
    values: FloatArray | None, outlines: list[FloatArray], scaled: ScalarMappable | None, *, by_zone: bool
) -> FloatArray:
    """Return red, green, blue and opacity of each face, darker where it turns away from the light."""
    from matplotlib.colors import to_rgba_array

    if values is None or scaled is None:
        colours = np.tile([0.82, 0.87, 0.93, 1.0], (sum(len(block) for block in outlines), 1))
    elif by_zone:
        colours = to_rgba_array([*ZONE_COLOURS, _NOT_JUDGED])[np.where(np.isnan(values), -1, values).astype(int)]
    else:
        colours = np.array(scaled.to_rgba(values), dtype=np.float64)
    return shade(colours, np.concatenate([find_normals(block) for block in outlines]))


def shade(colours: FloatArray, normals: FloatArray) -> FloatArray:
    """Return colours of faces (n, 4) darker where their unit normals (n, 3) turn away from the light."""
    light = _LIGHT / np.linalg.norm(_LIGHT)
    shaded = colours.copy()
    shaded[:, :3] *= (0.72 + 0.28 * np.abs(normals @ light))[:, None]
    return shaded


def find_normals(outlines: FloatArray) -> FloatArray:
    """Return the unit normal of each outline (n, k, 3)."""
    around = outlines - outlines.mean(axis=1, keepdims=True)
    normals = np.cross(around, np.roll(around, -1, axis=1)).sum(axis=1)
    return np.asarray(normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300))


def frame_axes(ax: Axes3D, low: FloatArray, high: FloatArray, zoom: float = 1.0) -> None:
    """Set limits and labels, with the same scale along all axes; a zoom below 1 leaves room for neighbours."""
    from matplotlib.ticker import MaxNLocator

    size = high - low
    margin = 0.03 * float(size.max())
    ax.set(xlim=(low[0] - margin, high[0] + margin), ylim=(low[1] - margin, high[1] + margin))
    ax.set_zlim(low[2] - margin, high[2] + margin)
    ax.set_box_aspect(size + 2 * margin, zoom=zoom * (0.72 if size[2] > size[:2].max() else 1.0))  # a tall body: labels
    slender = 0.5 * (size.sum() - size) < 0.4 * size  # along such an axis matplotlib puts the label on the numbers
    for set_label, name, far in zip((ax.set_xlabel, ax.set_ylabel, ax.set_zlabel), "xyz", slender, strict=True):
        set_label(f"{name} [mm]", labelpad=(4.0 if name == "z" else 11.0) + (28.0 if far else 0.0))
    ax.tick_params(labelsize="x-small")
    for axis, part in zip((ax.xaxis, ax.yaxis, ax.zaxis), size / size.max(), strict=True):
        axis.set_major_locator(MaxNLocator(int(np.clip(10 * part, 1, 5))))  # where an axis is short, numbers collide
        axis.pane.set_alpha(0.0)
    ax.grid(visible=False)


def _add_zone_legend(figure: Figure, values: FloatArray) -> None:
    """Name the zones below the sheet, with the number of elements in each."""
    from matplotlib.patches import Patch

    counts = np.bincount(values[np.isfinite(values)].astype(int), minlength=len(ZONES))
    patches = [
        Patch(color=colour, label=f"{name} ({count})")
        for colour, name, count in zip(ZONE_COLOURS, ZONES, counts, strict=True)
    ]
    if n := int(np.isnan(values).sum()):
        patches.append(Patch(facecolor=_NOT_JUDGED, edgecolor="0.5", label=f"not judged ({n})"))
    title = "zone (elements)"
    figure.legend(handles=patches, loc="lower center", ncols=3, frameon=False, fontsize="small", title=title)


def add_colour_bar(figure: Figure, ax: Axes3D, values: FloatArray, scaled: ScalarMappable, label: str) -> None:
    """Put a colour bar beside the sheet; of diverging colours from the smallest to the largest value, zero marked."""
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    if not isinstance(figure.get_layout_engine(), ConstrainedLayoutEngine):  # fill_figure has sized it
        height = float(figure.get_figheight())
        middle = ax.get_position().y0 * height + 0.5 * _SQUARE
        head = _LINE * (1 + figure.get_suptitle().count("\n")) + _GAP
        length = min(_BAR, 2.0 * (height - head - middle) - 0.1)
        place = (_BAR_LEFT / _WIDTH, (middle - 0.5 * length) / height, 0.16 / _WIDTH, length / height)
        bar = figure.colorbar(scaled, cax=figure.add_axes(place))
    else:
        bar = figure.colorbar(scaled, ax=ax, shrink=0.6, pad=0.1)
    bar.set_label(label)
    finite = values[np.isfinite(values)]
    if scaled.get_cmap().name == DIVERGING_COLOURS and len(finite):
        low, high = min(float(finite.min()), 0.0), max(float(finite.max()), 0.0)
        bar.ax.set_ylim(low, high if high > low else low + 1.0)
        bar.ax.axhline(0.0, color="k", linewidth=1.2)
    bar.outline.set_linewidth(0.5)
