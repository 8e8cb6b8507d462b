# SPDX-License-Identifier: Apache-2.0
"""Laps on pictures: where the surface has folded onto itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from presswork.model import CELLS
from presswork.results import Result
from presswork.view.cells import triangulate

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LAP, RED = "lap", "#d1001f"
MARKED = 0.5
"""Value of the field from which on a node counts as part of a lap."""


def mark_laps(ax: Axes, result: Result, step: int) -> str:
    """Mark the nodes on laps, where they are now, and join neighbours; return the line that reports them, if any."""
    if LAP not in result.field_names:
        return ""
    marked = np.asarray(result.field(LAP, step)) > MARKED
    if not marked.any():
        return ""
    from matplotlib.collections import LineCollection

    points, triangles = result.points(step)[:, :2], triangulate(result.mesh_at(step))
    sides = np.concatenate([triangles[:, [i, j]] for i, j in CELLS["tri3"].edges])
    ax.add_collection(LineCollection(list(points[sides[marked[sides].all(axis=1)]]), colors=RED, zorder=6))
    x, y = points[marked].T
    ax.scatter(x, y, s=14, marker="o", c=RED, edgecolors="white", linewidths=0.5, zorder=7, clip_on=False)
    return "lap (red)"
