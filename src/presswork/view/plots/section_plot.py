# SPDX-License-Identifier: Apache-2.0
"""Pictures of a stamping along a section: sheet between tools, thickness from the middle to the edge; draw-in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from presswork.model import FloatArray
from presswork.post.section import (
    ORIGIN,
    cut_sheet,
    cut_tool,
    find_breaks,
    find_ray,
    find_sheets,
    measure_draw_in,
)
from presswork.results import Result, ResultError
from presswork.view.style import begin_at_zero, clean_axes, describe_step, is_released, new_figure, require_matplotlib

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_DRAW_IN_ANGLES = (0.0, 45.0, 90.0)
_ALIKE = 0.01
"""Part of the largest draw-in by which curves may differ and be drawn as one."""
_TOOL_COLOURS = ("0.45", "#8a5a2b", "#2b6a8a", "#5a8a2b")


def plot_section(
    result: Result,
    angle: float = 0.0,
    step: int = -1,
    *,
    start: tuple[float, float] = ORIGIN,
    figure: Figure | None = None,
) -> Figure:
    """Draw the section along the ray from `start` (x, y) [mm] at an angle from x [degree]; without a start, all of it.

    Sheet and tools above, thickness strain below. Raises ResultError where the ray misses the sheet.
    """
    require_matplotlib()
    from matplotlib.collections import LineCollection, PolyCollection

    figure = new_figure(7.0, 6.0) if figure is None else figure
    upper, lower = figure.subplots(2, 1, height_ratios=(2, 1))
    figure.set_layout_engine("constrained", w_pad=0.15)  # else the wider labels of the lower axes are cut
    radians = float(np.radians(angle))
    sheet = cut_sheet(result, radians, step, start=start, whole=start == ORIGIN)
    if len(sheet.distance) == 0:
        raise ResultError(f"the section from ({start[0]:g}, {start[1]:g}) mm at {angle:g} degrees misses the blank")
    lines = sheet.line
    thickness = result.field("thickness", step)[sheet.cell]
    turned, begin = find_ray(result, radians, step, start=start)
    for colour, tool in zip(_TOOL_COLOURS, result.tools_at_work(step), strict=False):
        cut = cut_tool(result, tool, turned, step, start=begin, whole=start == ORIGIN)
        upper.add_collection(LineCollection(list(cut), colors=colour, linewidths=1.0))
        upper.plot([], [], color=colour, label=tool)
    along = lines[:, 1] - lines[:, 0]
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.linalg.norm(along, axis=1)[:, None]
    half = 0.5 * thickness[:, None, None] * normal[:, None, :]
    faces = np.concatenate([lines + half, (lines - half)[:, ::-1]], axis=1)
    upper.add_collection(PolyCollection(list(faces), facecolor="#c03030", edgecolor="#c03030", linewidths=0.3))
    low, high = lines.reshape(-1, 2).min(axis=0), lines.reshape(-1, 2).max(axis=0)
    margin = 0.08 * float((high - low).max())
    is_half = start == ORIGIN and sheet.distance[0] >= 0.0
    left = 0.0 if is_half else float(low[0]) - margin
    upper.set(xlim=(left, high[0] + margin), ylim=(low[1] - margin, high[1] + margin))
    upper.set_aspect("equal")
    beginning = "the middle" if start == ORIGIN else f"({start[0]:g}, {start[1]:g}) mm"
    upper.set_xlabel(f"distance from {beginning} [mm]")
    upper.set_ylabel("z [mm]")
    if result.surfaces:
        upper.legend(frameon=False, fontsize="small", loc="upper left", bbox_to_anchor=(1.01, 1.0))
    title = str(result.info.get("title", "")).strip()
    upper.set_title(f"{title}\n{describe_step(result, step)}, section at {angle:g} degrees", fontsize="medium")
    ends = find_breaks(lines)
    strain = result.field("thickness_strain", step)[sheet.cell]
    distance = np.insert(sheet.distance, ends, np.nan)
    strain = np.insert(strain, ends, np.nan)  # no line goes over a hole
    lower.plot(distance, strain, ".-", linewidth=1.2, markersize=3)
    lower.set_xlabel(f"distance from {beginning} in the undeformed blank [mm]")
    lower.set_ylabel("thickness strain [–]")
    lower.axhline(0.0, color="0.5", linewidth=0.8)
    if is_half:
        lower.set_xlim(left=0.0)
    clean_axes(lower)
    return figure


def is_drawn_in(result: Result) -> bool:
    """Return whether a blank's edge has moved along x by the last step on the first mesh."""
    if result.info.get("analysis") == "solid":
        return False
    steps = [step for step in range(len(result.times)) if result.mesh_at(step) is result.mesh]
    size = float(np.ptp(result.mesh.points, axis=0).max())
    return any(abs(measure_draw_in(result, float(np.radians(a)), steps[-1])) > 1e-4 * size for a in _DRAW_IN_ANGLES)


def plot_draw_in(result: Result, *, figure: Figure | None = None) -> Figure:
    """Draw how far the blank's edge has come in along x, y and the diagonal against the stroke.

    Steps after trimming or springback are left out. For a press line it shows the operation that draws in most.
    """
    require_matplotlib()
    figure = new_figure(6.4, 4.2) if figure is None else figure
    ax = figure.subplots()
    course = trace_draw_in(result)
    for angles, come_in in course.curves:
        ax.plot(course.stroke, come_in, ".-", label=name_directions(angles), linewidth=1.6)
    ax.set_xlabel(f"{course.tool} stroke [mm]")
    ax.set_ylabel("draw-in [mm]")
    begin_at_zero(ax)
    ax.set_title(str(result.info.get("title", "")))
    ax.legend(frameon=False)
    clean_axes(ax)
    return figure


@dataclass(frozen=True)
class DrawInCourse:
    """How a blank's edge comes in over the stroke."""

    tool: str
    """The tool that moves most."""
    stroke: FloatArray
    """Its stroke at the saved steps on the first mesh before springback (n_steps,) [mm]."""
    curves: tuple[tuple[tuple[float, ...], FloatArray], ...]
    """Directions [degree] that draw in alike, and their draw-in (n_steps,) [mm]."""


def trace_draw_in(result: Result) -> DrawInCourse:
    """Return the draw-in along x, y and the diagonal over the stroke; of a press line in the operation with most."""
    steps = [step for step in range(len(result.times)) if result.mesh_at(step) is result.mesh]
    steps = [step for step in steps if not is_released(result, step)]
    sheets = find_sheets(result.mesh)
    found = {
        angle: np.array([measure_draw_in(result, float(np.radians(angle)), step, sheets=sheets) for step in steps])
        for angle in _DRAW_IN_ANGLES
    }
    if result.is_line:
        kept = _most_drawn_in([result.operation_at(step) for step in steps], list(found.values()))
        steps, found = steps[kept], {angle: come_in[kept] for angle, come_in in found.items()}
    displacements = {
        name: [
            np.subtract(result.surface_displacement(name, s), result.surface_displacement(name, steps[0]))
            for s in steps
        ]
        for name in result.tools_at_work(steps[-1])
    }
    strokes = {name: np.linalg.norm(displacement, axis=1) for name, displacement in displacements.items()}
    tool = max(strokes, key=lambda name: float(strokes[name][-1]))
    near = _ALIKE * max(float(np.abs(come_in).max()) for come_in in found.values())
    curves: list[tuple[list[float], FloatArray]] = []
    for angle, come_in in found.items():
        same = next((angles for angles, other in curves if np.abs(other - come_in).max() <= near), None)
        if same is None:
            curves.append(([angle], come_in))
        else:
            same.append(angle)
    return DrawInCourse(tool, strokes[tool], tuple((tuple(angles), come_in) for angles, come_in in curves))


def name_directions(angles: Sequence[float]) -> str:
    """Return directions in words.

    >>> name_directions([0.0, 90.0])
    'at 0 and 90 degrees'
    """
    return f"at {' and '.join(f'{angle:g}' for angle in angles)} degrees"


def _most_drawn_in(operations: Sequence[str], draw_in: Sequence[FloatArray]) -> slice:
    """Return the steps of the operation in which the edge comes in farthest, of the draw-in (n_steps,) by direction."""
    best, most = slice(0, len(operations)), -1.0
    for name in dict.fromkeys(operations):
        own = [i for i, each in enumerate(operations) if each == name]
        come_in = max(float(np.ptp(along[own])) for along in draw_in)
        if come_in > most:
            best, most = slice(own[0], own[-1] + 1), come_in
    return best
