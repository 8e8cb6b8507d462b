# SPDX-License-Identifier: Apache-2.0
"""Contact stress along the contact surface."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np

from presswork.model import FloatArray
from presswork.post import Interface, trace_interface
from presswork.results import Result
from presswork.view.style import (
    COLOURS,
    Progress,
    begin_at_zero,
    clean_axes,
    find_history_row,
    find_turning_tool,
    measure_progress,
    new_figure,
    turned_by,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_N_CURVES = 6


def plot_interface(
    result: Result,
    tool: str | None = None,
    steps: Sequence[int] | None = None,
    *,
    x: Literal["radius", "arc_length"] | None = None,
    figure: Figure | None = None,
) -> Figure:
    """Draw contact pressure and, below it, contact shear along the contact surface, one curve per step.

    `steps` are by default six, equally spaced; a step without contact has no curve. `x` is by default the radius (the x
    coordinate) in axisymmetry, unless a wall has many nodes at one radius, and otherwise the arc length. Each connected
    part of the contact surface is a line of its own. Dashed is the largest shear that friction allows at the last step.
    """
    figure = new_figure(7.6, 6.0) if figure is None else figure
    figure.set_size_inches(7.6, 6.0)
    upper, lower = figure.subplots(2, 1, sharex=True)
    chosen = list(steps) if steps is not None else _spread(len(result.times))
    traces = {step: trace_interface(result, tool, step) for step in chosen}
    traces = {step: trace for step, trace in traces.items() if len(trace.nodes)}
    if x is None:
        x = "radius" if result.info.get("analysis") == "axisymmetric" and _spreads(traces.values()) else "arc_length"
    progress = {step: measure_progress(result, step) for step in traces}
    pressed = all(p is not None and p.reduction > -1e-3 for p in progress.values())
    for number, (step, trace) in enumerate(traces.items()):
        colour = _colour(number, len(traces))
        _draw(upper, trace, trace.contact_pressure, x, colour, _label(result, step, progress[step], pressed=pressed))
        _draw(lower, trace, trace.contact_shear, x, colour, "")
    if traces:
        _draw_limit(lower, list(traces.values())[-1], x)
    _finish(upper, lower, x, " r" if result.info.get("analysis") == "axisymmetric" else "")
    if traces:
        last = progress.get(len(result.times) - 1) or measure_progress(result, -1)
        working = {p.tool for p in progress.values() if p}
        title = f"{' or '.join(sorted(working))} stroke" if last else "time"
        if pressed and last:
            title += f",\n{last.direction} reduction"
        title = f"{roll} turned by" if (roll := find_turning_tool(result)) is not None else title
        curves = upper.get_legend_handles_labels()  # the friction limit has a legend of its own
        figure.legend(*curves, loc="outside right upper", frameon=False, title=title, alignment="left")
    what = f"contact with {tool}" if tool else "contact"
    lines = [*textwrap.wrap(str(result.info.get("title", "")), 60), what]
    upper.set_title("\n".join(lines), loc="left", fontsize="medium")
    return figure


def _spreads(traces: Iterable[Interface]) -> bool:
    """Return whether the radius distinguishes the nodes: along a cylindrical wall it does not."""
    return all(
        len(np.unique(np.round(trace.points[trace.patch == patch, 0], 6))) == (trace.patch == patch).sum()
        for trace in traces
        for patch in np.unique(trace.patch)
    )


def _spread(count: int) -> list[int]:
    """Return up to six steps, equally spaced after the first step, the last one among them."""
    return sorted({round(step) for step in np.linspace(0, count - 1, _N_CURVES + 1)[1:]})


def _label(result: Result, step: int, progress: Progress | None, *, pressed: bool) -> str:
    """Return a curve's label; pressed: the working tool shortens the body along its motion, as extrusion does not."""
    if (roll := find_turning_tool(result)) is not None:
        return f"{np.degrees(turned_by(result, roll, step)):.1f} degrees"
    if progress is None:
        return f"{result.times[step]:.4g} s"
    part = f"part {number}: " if (number := _part(result, step)) else ""
    return f"{part}{progress.stroke:.2f} mm" + (f", {100 * progress.reduction:.1f} %" if pressed else "")


def _part(result: Result, step: int) -> int:
    """Return the number of the part of a series at a saved step; 0 without a series."""
    return int(find_history_row(result, step).get("part", 0))


def _draw(ax: Axes, trace: Interface, values: FloatArray, x: str, colour: object, label: str) -> None:
    """Draw one step's curve, a line for each part; a part of one node is a dot."""
    along = trace.points[:, 0] if x == "radius" else trace.arc_length
    for patch in np.unique(trace.patch):
        of_patch = trace.patch == patch
        marker = "o" if of_patch.sum() == 1 else None
        ax.plot(
            along[of_patch], values[of_patch], color=colour, marker=marker, markersize=3, linewidth=1.6, label=label
        )
        label = ""


def _draw_limit(ax: Axes, trace: Interface, x: str) -> None:
    """Draw what friction allows, in both directions, dashed; nothing without friction."""
    if not trace.friction_limit.any():
        return
    along = trace.points[:, 0] if x == "radius" else trace.arc_length
    label = "friction limit, last step shown"
    for sign in (1.0, -1.0):
        for patch in np.unique(trace.patch):
            part = trace.patch == patch
            ax.plot(along[part], sign * trace.friction_limit[part], "--", color="0.35", linewidth=0.9, label=label)
            label = ""
    ax.legend(frameon=False, fontsize="small", loc="best")


def _colour(number: int, count: int) -> object:
    """Return the colour of a curve: dark for early steps, never too light to see."""
    import matplotlib

    return matplotlib.colormaps[COLOURS](0.88 * number / max(count - 1, 1))


def _finish(upper: Axes, lower: Axes, x: str, symbol: str) -> None:
    """Label both panels."""
    upper.set_ylabel("contact pressure [MPa]")
    lower.set_ylabel("contact shear [MPa]")
    lower.set_xlabel(f"radius{symbol} [mm]" if x == "radius" else "arc length along the contact surface [mm]")
    for ax in (upper, lower):
        clean_axes(ax)
        ax.margins(x=0.02)
    if upper.lines:
        begin_at_zero(upper, x=False)
    if not upper.lines:
        upper.text(0.5, 0.5, "no contact", transform=upper.transAxes, ha="center")
