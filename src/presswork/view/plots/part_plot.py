# SPDX-License-Identifier: Apache-2.0
"""A part that cannot be drawn, with what lies under it coloured."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from presswork.model import BoolArray, FloatArray, IntArray
from presswork.view.plots.shell_plot import frame_axes
from presswork.view.style import require_matplotlib, save_picture

if TYPE_CHECKING:
    from mpl_toolkits.mplot3d import Axes3D

_COLOURS = np.array([[0.72, 0.74, 0.76], [0.78, 0.06, 0.18]])
"""Colours of the part and of undercut regions."""


def draw_undercut(points: FloatArray, triangles: IntArray, over: BoolArray, path: Path) -> None:
    """Draw a part from above and from below, its undercut triangles in red, as a PNG.

    points (n_points, 3) [mm], the punch's direction -z; triangles (n, 3); over: which are undercut (n,). Raises
    OutputError, and ImportError without matplotlib.
    """
    require_matplotlib()
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    figure = Figure(figsize=(9.6, 4.8), layout="constrained")
    corners = points[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    slope = np.abs(normal[:, 2]) / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
    shade = (0.6 + 0.4 * slope)[:, None]
    colours = _COLOURS[over.astype(int)] * shade
    width = float(np.clip(10.0 / np.sqrt(len(triangles)), 0.04, 0.6))
    worst = corners[over].mean(axis=(0, 1)) - corners.mean(axis=(0, 1))
    azimuth = float(np.degrees(np.arctan2(worst[1], worst[0]))) + 25.0
    for number, (name, elevation) in enumerate((("from above", 28.0), ("from below", -28.0)), start=1):
        ax: Axes3D = figure.add_subplot(1, 2, number, projection="3d")
        ax.set_proj_type("ortho")
        ax.view_init(elevation, azimuth)
        faces = Poly3DCollection(corners, facecolors=colours, edgecolors=(0.1, 0.1, 0.1, 0.5), linewidths=width)
        ax.add_collection3d(faces)
        frame_axes(ax, points.min(axis=0), points.max(axis=0))
        ax.set_title(name, fontsize="small")
    figure.suptitle(
        f"{int(over.sum())} of {len(over)} triangles are undercut (red): along the draw direction -z they lie under it",
        fontsize="medium",
    )
    save_picture(figure, path, needed_bytes=500_000)
