# SPDX-License-Identifier: Apache-2.0
"""Laps on pictures: where the surface has folded onto itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from presswork.results import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LAP = "lap"
MARKED = 0.5
"""Of the field, from which on a node counts as part of a lap."""


def mark_laps(ax: Axes, result: Result, step: int) -> str:
    """Mark the nodes on laps, where they are now; return the line that says so, or nothing."""
    if LAP not in result.field_names:
        return ""
    marked = np.asarray(result.field(LAP, step)) > MARKED
    if not marked.any():
        return ""
    x, y = result.points(step)[marked, :2].T
    ax.scatter(x, y, s=14, marker="o", c="#d1001f", edgecolors="white", linewidths=0.5, zorder=7, clip_on=False)
    return "lap (red)"
