# SPDX-License-Identifier: Apache-2.0
"""Style of all pictures: figures, colours, labels with units, and names of saved steps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from presswork.fields.table import describe_field
from presswork.model import FloatArray
from presswork.results import OutputError, Result
from presswork.results.whole_file import explain_write_error, replace_whole
from presswork.view.tool_course import find_course

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Text

COLOURS = "viridis"
ZONE_COLOURS = ("#3a9d4a", "#f2b134", "#c8102e", "#b8bcc2", "#7fb2e5", "#2b4c9b")
"""Colours of formability.ZONES: green, amber, red towards cracks, grey for small strains, blues towards wrinkles."""
DPI = 150
MARGIN = 0.1
"""White around what is drawn [inch]."""
_LETTER = 0.088
"""Width of a figure for each letter of its title, with the space beside the axes [inch]."""
WHITE = 0xFFFFFFFF
"""A white pixel, of four bytes."""


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure [inch] that notebooks and plt.show() know. Raises ImportError if matplotlib is missing."""
    require_matplotlib()
    from matplotlib import pyplot

    return pyplot.figure(figsize=(width, height), layout="constrained")


def save_picture(figure: Figure, path: Path, *, needed_bytes: int = 200_000) -> Path:
    """Write a PNG in the place of what is there; needed_bytes: free on the disk. Raises OutputError.

    The figure is drawn once and its white margin cut to MARGIN; matplotlib's tight bounding box would draw it twice.
    """
    from matplotlib.image import imsave

    picture = _cut_margin(draw_pixels(figure))
    with replace_whole(path, needed_bytes=needed_bytes) as file:
        imsave(file, picture, format="png", dpi=DPI, pil_kwargs={"compress_level": 3})
    return path


def draw_pixels(figure: Figure) -> NDArray[np.uint8]:
    """Return the pixels of a figure (n_rows, n_columns, 4); red, green, blue and opacity."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    canvas, dpi = figure.canvas, figure.dpi
    try:
        figure.set_dpi(DPI)
        drawing = FigureCanvasAgg(figure)
        _break_titles(figure)
        drawing.draw()  # type: ignore[no-untyped-call]
        return np.asarray(drawing.buffer_rgba())  # type: ignore[no-untyped-call]
    finally:
        figure.set_canvas(canvas)
        figure.set_dpi(dpi)


def _break_titles(figure: Figure) -> None:
    """Break lines of titles that do not fit between the sides of a figure; it has its canvas and dpi."""
    width = float(figure.bbox.width)
    titles = [t for ax in figure.axes for t in (ax.title, ax._left_title)]  # type: ignore[attr-defined]
    titles += [figure._suptitle] if figure._suptitle else []  # type: ignore[attr-defined]
    if not any(_longest(t) * _LETTER > 0.5 * width / figure.dpi for t in titles):
        return  # without the layout, which takes as long as the picture
    figure.draw_without_rendering()
    for title in titles:
        box = title.get_window_extent()
        if box.x0 >= 0.0 and box.x1 <= width:
            continue
        middle = 0.5 * (box.x0 + box.x1)
        room = width - box.x0 if title.get_horizontalalignment() == "left" else 2.0 * min(middle, width - middle)
        letters = max(int(_longest(title) * room / box.width), 1)
        title.set_text("\n".join(part for line in title.get_text().split("\n") for part in wrap(line, letters)))


def _longest(title: Text) -> int:
    """Return the number of letters of the longest line."""
    return max(len(line) for line in title.get_text().split("\n"))


def _cut_margin(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return the part of a picture that is not white, in a white margin."""
    inked = picture.view(np.uint32)[..., 0] != WHITE
    places = [np.flatnonzero(inked.any(axis=axis)) for axis in (1, 0)]
    rows, columns = (slice(ink[0], ink[-1] + 1) if len(ink) else slice(None) for ink in places)
    margin = round(MARGIN * DPI)
    return np.pad(picture[rows, columns], ((margin, margin), (margin, margin), (0, 0)), constant_values=255)


def require_matplotlib() -> None:
    """Raise ImportError with the remedy if matplotlib is missing."""
    try:
        import matplotlib  # noqa: F401
    except ImportError as error:
        raise ImportError('pictures need matplotlib: pip install "presswork[plot]"') from error


def label_field(result: Result, name: str) -> str:
    """Return a field's name in words with its unit, as "effective stress [MPa]"."""
    text = describe_field(name)
    unit = result.unit(name)
    return f"{text} [{'–' if unit == '1' else unit}]" if unit else text


@dataclass(frozen=True)
class Progress:
    """Progress of the process at a saved step."""

    tool: str
    """The tool that works at this step."""
    stroke: float
    """Its displacement [mm]."""
    direction: str
    """"height" or "width": the extent of the body along the stroke."""
    reduction: float
    """Reduction of the whole body's extent, as a fraction."""


def measure_progress(result: Result, step: int) -> Progress | None:
    """Return the stroke and the body's reduction along it; None if no tool moves in the whole run."""
    course = find_course(result)
    at, tool = step % len(result.times), course.find_working(step)
    if tool is None:
        return None
    moved = result.tool_displacement(tool, step) - result.tool_displacement(tool, 0)
    if course.strokes is not None:
        moved = result.tool_displacement(tool, at) - result.tool_displacement(tool, max(at - 1, 0))
    axis = int(np.argmax(np.abs(moved)))
    extent = float(np.ptp(result.points(step)[:, axis])) / float(np.ptp(result.mesh.points[:, axis]))
    stroke = course.measure_stroke(tool, step)
    if stroke is None:
        stroke = float(np.linalg.norm(result.tool_displacement(tool, step)))
    return Progress(tool, stroke, ("width", "height")[axis], 1 - extent)


def find_turning_tool(result: Result) -> str | None:
    """Return the tool that has turned most by the last step; None if none turns."""
    angles = {name: turned_by(result, name, -1) for name in (*result.tools, *result.surfaces)}
    tool = max(angles, key=lambda name: angles[name], default=None)
    return tool if tool is not None and angles[tool] > 0 else None


def turned_by(result: Result, tool: str, step: int) -> float:
    """Return the angle by which a tool has turned since the start, without its sign [rad]."""
    if tool in result.tools:
        return abs(result.tool_pose(tool, step).angle)
    return float(np.linalg.norm(result.surface_motion(tool, step)[1]))


def is_released(result: Result, step: int) -> bool:
    """Return whether the part has sprung back by this step."""
    return "springback" in result.field_names and bool(result.field("springback", step).any())


def describe_step(result: Result, step: int) -> str:
    """Return what distinguishes a step: a roll's angle, stroke and reduction, or the time if no tool moves."""
    if result.is_onestep:
        return "part" if step % len(result.times) else "blank"
    course = find_course(result)
    if result.surfaces and (tool := course.find_working(step)) is not None:
        stroked = course.measure_stroke(tool, step)
        travelled = np.linalg.norm(result.surface_displacement(tool, step)) if stroked is None else stroked
        stroke = (
            f"{tool} stroke {travelled:.2f} mm" if travelled or not result.is_line else _describe_laid(result, step)
        )
        return f"{stroke}, after springback" if is_released(result, step) else stroke
    if (roll := find_turning_tool(result)) is not None:
        return f"{roll} turned by {np.degrees(turned_by(result, roll, step)):.1f} degrees"
    if result.is_line:
        return _describe_laid(result, step)
    progress = measure_progress(result, step)
    if progress is None:
        return _describe_load(result, step)
    text = f"{progress.tool} stroke {progress.stroke:.2f} mm"
    if progress.reduction < 0.005:
        return text
    return f"{text}, {progress.direction} of the workpiece reduced by {100 * progress.reduction:.1f} %"


def title_step(ax: Axes, result: Result, step: int, field: str | None = None) -> str:
    """Return what distinguishes a step, behind the name of a field, in lines where the figure is too narrow for one."""
    text, room = describe_step(result, step), ax.figure.bbox.width / ax.figure.dpi / _LETTER
    shown = f"{describe_field(field)}, {text}" if field else text
    if len(shown) <= room:
        return shown
    text = text.replace(", ", "\n", 1) if len(text) > room else text
    return f"{describe_field(field)}\n{text}" if field else text


def _describe_laid(result: Result, step: int) -> str:
    """Return the stage of a part between tools that have not moved, in words."""
    at = step % len(result.times)
    if at == 0:
        return "start"
    tools = result.tools_at_work(at)
    if tools != result.tools_at_work(at - 1):
        return f"laid in for {result.operation_at(at) or 'next tools'}"
    return str(find_history_row(result, at).get("stage", "")).replace("_", " ")


def _describe_load(result: Result, step: int) -> str:
    """Return how far the set that is moved farthest has come, the stage of a static run, or the time of another."""
    time = float(result.times[step])
    row = find_history_row(result, step)
    if time > 0.0 and row:
        moved = {name: float(row[name]) for name in row if ".displacement_" in name}
        if moved and any(moved.values()):
            name = max(moved, key=lambda n: abs(moved[n]))
            part, _, component = name.partition(".displacement_")
            return f"{part} displaced by {moved[name]:.4g} mm in {component}"
        if "iterations" in row:
            return f"stage {row['stage']}, time {time:.4g} s"
    return f"time {1e3 * time:.4g} ms" if 0 < time < 0.1 else f"time {time:.4g} s"


def find_history_row(result: Result, step: int) -> dict[str, Any]:
    """Return the history's values nearest in time to a saved step; nothing where the folder has no history."""
    try:
        history = result.history
    except OutputError:  # fields are drawn without one, too
        return {}
    times = np.asarray(history.get("time", ()))
    if not len(times):
        return {}
    row = int(np.abs(times - result.times[step]).argmin())
    return {name: values[row] for name, values in history.items()}


def begin_at_zero(ax: Axes, *, x: bool = True) -> None:
    """Start axes at zero if all values are positive, with a small margin at the other end."""
    for axis in ("x", "y") if x else ("y",):
        parts = [np.asarray(getattr(line, f"get_{axis}data")(), dtype=np.float64) for line in ax.lines]
        values = np.concatenate([np.zeros(0), *parts])
        values = values[np.isfinite(values)]
        if len(values) and values.min() >= -1e-6 * values.max() and values.max() > 0:
            getattr(ax, f"set_{axis}lim")(0.0, (1.02 if axis == "x" else 1.05) * values.max())


def bare_figure(width: float = 6.4, height: float = 4.2) -> Figure:
    """Return an empty figure [inch] that no window system is needed for."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def create_folder(folder: Path) -> None:
    """Create the folder for the pictures in an existing parent. Raises OutputError."""
    try:
        folder.mkdir(exist_ok=True)
    except FileNotFoundError as error:
        raise OutputError(f"{folder} cannot be created: its parent folder does not exist") from error
    except OSError as error:
        raise explain_write_error(error, folder, 0) from error


def name_part(result: Result) -> str:
    """Return how a run's energies and reactions are to be labelled: of which part of the whole they are; or nothing."""
    whole = float(result.info.get("whole", 1.0))
    if "whole" not in result.info:
        whole = 2.0 ** len(str(result.info.get("symmetry", "")))
    if whole <= 1.0:
        return ""
    name = {2.0: "half", 4.0: "quarter", 8.0: "eighth"}.get(whole, f"1/{whole:.6g}")
    return f"of the {name} computed"


def break_at_parts(history: Mapping[str, NDArray[Any]], values: NDArray[Any]) -> FloatArray:
    """Return values by row of the history, nan where a part of a series begins: no line goes from part to part."""
    broken = np.array(values, dtype=np.float64)
    if "part" in history:
        broken[1:][np.diff(np.asarray(history["part"], dtype=float)) > 0] = np.nan
    return broken


def clean_axes(ax: Axes) -> None:
    """Draw a light grid and no box in a diagram of curves."""
    ax.grid(True, color="0.9", linewidth=0.8)
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)
