# SPDX-License-Identifier: Apache-2.0
"""Pictures of the contact stress on a tool in space."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from presswork.model import FloatArray
from presswork.post.die_stress import DieStress, find_die_stress
from presswork.results import Result
from presswork.view.extremes import describe_extremes
from presswork.view.faces import draw_faces
from presswork.view.mirror import IMAGES, Mirror
from presswork.view.plots.shell_plot import add_colour_bar, fill_figure, find_normals, frame_axes, scale_colours, shade
from presswork.view.style import describe_step, new_figure, require_matplotlib

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d import Axes3D

STEEPEST = 70.0
"""Highest elevation of the view [degree]: from straight above depths are not seen."""
ASIDE = 30.0
"""Turn of the view from the tool's face [degree]."""
_BARE = (0.86, 0.86, 0.86, 1.0)


def plot_die_stress(
    result: Result, tool: str, step: int = -1, *, mirror: Mirror = "", figure: Figure | None = None
) -> Figure:
    """Draw a tool in space, seen from the workpiece, coloured by the pressure that acts on it.

    What the workpiece does not touch is grey. Raises ResultError as `find_die_stress` does.
    """
    require_matplotlib()
    found = _keep_images(find_die_stress(result, tool, step), mirror)
    figure = new_figure(7.0, 5.2) if figure is None else figure
    ax: Axes3D = figure.add_subplot(projection="3d")
    ax.set_proj_type("ortho")
    ax.view_init(*_find_view(found.corners, found.pressure))
    touched = found.pressure > 0.0
    scaled = scale_colours(np.append(found.pressure, 0.0), None, diverging=False)
    colours = np.array(scaled.to_rgba(found.pressure), dtype=np.float64)
    colours[~touched] = _BARE
    colours = shade(colours, find_normals(found.corners))
    signs = [(x, y, 1) for x, y in IMAGES[mirror]]
    blocks = [found.corners * sign for sign in signs]
    frame_axes(ax, np.min([b.min(axis=(0, 1)) for b in blocks], axis=0),
               np.max([b.max(axis=(0, 1)) for b in blocks], axis=0))  # fmt: skip
    title = str(result.info.get("title", "")).strip()
    head = [*filter(None, (title, f"contact pressure on {tool.replace('_', ' ')}, {describe_step(result, step)}"))]
    fill_figure(figure, ax, head, describe_extremes(found.pressure, found.corners.mean(axis=1)).partition(", min")[0])
    draw_faces(ax, blocks, np.tile(colours, (len(signs), 1)), 0.0)
    add_colour_bar(figure, ax, found.pressure, scaled, "contact pressure [MPa]")
    return figure


def _keep_images(found: DieStress, mirror: Mirror) -> DieStress:
    """Return the triangles on the side of the mirrors where the workpiece is computed; dies may be drawn whole."""
    middle = found.corners.mean(axis=1)
    kept = np.all([middle[:, "xy".index(axis)] >= 0.0 for axis in mirror] or [np.ones(len(middle), bool)], axis=0)
    return DieStress(found.corners[kept], found.pressure[kept])


def _find_view(corners: FloatArray, pressure: FloatArray) -> tuple[float, float]:
    """Return elevation and azimuth [degree] from which the side of the tool that is pressed is seen."""
    area = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    out = (area * (pressure[:, None] if pressure.any() else 1.0)).sum(axis=0)
    x, y, z = out / max(float(np.linalg.norm(out)), 1e-300)
    elevation = float(np.degrees(np.arcsin(z)))
    azimuth = float(np.degrees(np.arctan2(y, x))) + ASIDE if np.hypot(x, y) > 0.5 else -58.0
    return float(np.clip(np.sign(elevation) * (abs(elevation) - ASIDE), -STEEPEST, STEEPEST)), azimuth
