# SPDX-License-Identifier: Apache-2.0
"""A section before and after springback in one picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from presswork.model import FloatArray
from presswork.post.section import find_breaks
from presswork.post.springback import SectionSpringback, measure_springback
from presswork.results import Result, ResultError
from presswork.view.style import clean_axes, new_figure, require_matplotlib

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_SHOWN = 0.1
"""Size at which the largest movement is drawn, about, over the size of the section."""
_FACTORS = np.array([1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0])


def plot_springback(
    result: Result,
    angle: float = 0.0,
    step: int = -1,
    *,
    start: tuple[float, float] = (0.0, 0.0),
    exaggeration: float | None = None,
    figure: Figure | None = None,
) -> Figure:
    """Draw a section as formed and after springback, with the walls' angles and curl radii; see measure_springback.

    exaggeration: factor on the movement; by default one that shows it. Raises ResultError if nothing has sprung back.
    """
    require_matplotlib()
    figure = new_figure(7.4, 4.8) if figure is None else figure
    found = measure_springback(result, float(np.radians(angle)), step, start=start)
    if len(found.formed.distance) == 0:
        raise ResultError(f"the section at {angle:g} degrees misses the part")
    breaks = find_breaks(found.formed.line)
    formed, free = _trace(found.formed.line, breaks), _trace(found.free.line, breaks)
    moved = float(np.nanmax(np.linalg.norm(free - formed, axis=1)))
    if exaggeration is None:
        wanted = _SHOWN * float(np.ptp(found.formed.line, axis=(0, 1)).max()) / max(moved, 1e-300)
        exaggeration = float(_FACTORS[max(wanted, 1.0) >= _FACTORS][-1])
    ax = figure.subplots()
    ax.plot(*formed.T, color="0.45", linewidth=1.6, label="as formed")
    ax.plot(*free.T, color="C3", linewidth=1.6, label="after springback")
    if exaggeration > 1:
        shown = formed + exaggeration * (free - formed)
        ax.plot(*shown.T, "--", color="C3", linewidth=1.2, label=f"after springback, movement x {exaggeration:g}")
    ax.set_aspect("equal")
    ax.set(xlabel="distance along the section [mm]", ylabel="z [mm]")
    title = str(result.info.get("title", "")).strip()
    ax.set_title(f"{title}\nspringback, section at {angle:g} degrees: {moved:.3g} mm at most", fontsize="medium")
    ax.legend(frameon=False, fontsize="small", loc="upper left", bbox_to_anchor=(1.01, 1.0))
    if text := _describe(found):
        ax.annotate(text, (1.02, 0.0), xycoords="axes fraction", fontsize="small", va="bottom", annotation_clip=False)
    clean_axes(ax)
    return figure


def _trace(line: FloatArray, breaks: NDArray[np.intp]) -> FloatArray:
    """Return the section as polylines (m, 2), NaN between them, of its pieces (n, 2, 2)."""
    gap = np.full((1, 2), np.nan)
    return np.concatenate([part for own in np.split(line, breaks) for part in (own[:, 0], own[-1:, 1], gap)])


def _describe(found: SectionSpringback) -> str:
    """Return what the walls' angles and radii were and are."""
    lines = []
    for number, (formed, free) in enumerate(found.walls, 1):
        lines.append(f"wall {number}" if len(found.walls) > 1 else "wall, formed to free")
        for name in ("bottom", "flange"):
            before, after = getattr(formed, f"{name}_angle"), getattr(free, f"{name}_angle")
            if before is not None and after is not None:
                lines.append(f"to {name}: {before:.1f}° to {after:.1f}°")
        radius = free.curl_radius
        lines.append("straight" if np.isinf(radius) else f"curl radius {radius:.4g} mm")
    return "\n".join(lines)
