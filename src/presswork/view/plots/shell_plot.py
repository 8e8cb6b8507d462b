# SPDX-License-Identifier: Apache-2.0
"""Pictures of a deformed sheet or solid in space."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from presswork.formability import ZONES
from presswork.model import FloatArray
from presswork.post import find_skin
from presswork.post.section import cut_tool
from presswork.results import Result, ResultMesh
from presswork.view.cells import outline_blocks
from presswork.view.crack_mark import describe_first_crack, find_first_crack
from presswork.view.extremes import describe_extremes
from presswork.view.faces import draw_faces
from presswork.view.mirror import IMAGES, Mirror
from presswork.view.style import COLOURS, ZONE_COLOURS, describe_step, label_field, new_figure, require_matplotlib

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
_LIGHT = np.array([0.35, -0.5, 0.8])


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
    Tools are drawn as sections along x and y. Point fields are shown as the mean of a cell's nodes; of a vector the
    length is shown. scale: factor on the displacement. view: elevation and azimuth [degree]. mirror: planes through the
    origin, normal to x, y or both. value_range: that of the colours, by default that of the values; frame: corners of
    what is shown [mm], by default of the body.
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
    scaled = None if values is None else scale_colours(values, value_range, diverging=field in DIVERGING)
    colours = _colours(values, outlines, scaled, by_zone=field == ZONE_FIELD)
    width = float(np.clip(10.0 / np.sqrt(n_faces), 0.04, 0.6)) if show_edges else 0.0
    signs = [(x, y, 1) for x, y in IMAGES[mirror]]
    low = np.min([(points * sign).min(axis=0) for sign in signs], axis=0)
    high = np.max([(points * sign).max(axis=0) for sign in signs], axis=0)
    low, high = (low, high) if frame is None else frame
    frame_axes(ax, low, high)
    blocks = [block * sign for sign in signs for block in outlines]
    draw_faces(ax, blocks, np.tile(colours, (len(signs), 1)), width, _cut_tools(result, step, low, high))
    if field == ZONE_FIELD and values is not None:
        _add_zone_legend(figure, values)
    elif field is not None and values is not None and scaled is not None:
        ends = values if value_range is None else np.array(value_range)
        add_colour_bar(figure, ax, ends, scaled, label_field(result, field))
    title = str(result.info.get("title", "")).strip()
    magnified = "" if scale == 1.0 else f", displacement x {scale:g}"
    extremes = ""
    if values is not None and field != ZONE_FIELD:
        extremes = describe_extremes(values, np.concatenate([block.mean(axis=1) for block in outlines]))
    crack = find_first_crack(result, field) if field else None
    wording = describe_first_crack(crack).replace(" (x)", "") if crack else ""
    lines = (title, describe_step(result, step) + magnified, extremes, wording)
    figure.suptitle("\n".join(filter(None, lines)), fontsize="medium")  # a title of the axes would lie on the body
    return figure


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
        colours = to_rgba_array(ZONE_COLOURS)[values.astype(int)]
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

    counts = np.bincount(values.astype(int), minlength=len(ZONES))
    patches = [
        Patch(color=colour, label=f"{name} ({count})")
        for colour, name, count in zip(ZONE_COLOURS, ZONES, counts, strict=True)
    ]
    title = "zone (elements)"
    figure.legend(handles=patches, loc="outside lower center", ncols=3, frameon=False, fontsize="small", title=title)


def add_colour_bar(figure: Figure, ax: Axes3D, values: FloatArray, scaled: ScalarMappable, label: str) -> None:
    """Put a colour bar beside the sheet; of diverging colours from the smallest to the largest value, zero marked."""
    bar = figure.colorbar(scaled, ax=ax, shrink=0.6, pad=0.1)
    bar.set_label(label)
    finite = values[np.isfinite(values)]
    if scaled.get_cmap().name == DIVERGING_COLOURS and len(finite):
        low, high = min(float(finite.min()), 0.0), max(float(finite.max()), 0.0)
        bar.ax.set_ylim(low, high if high > low else low + 1.0)
        bar.ax.axhline(0.0, color="k", linewidth=1.2)
    bar.outline.set_linewidth(0.5)
