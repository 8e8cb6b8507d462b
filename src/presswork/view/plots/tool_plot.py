# SPDX-License-Identifier: Apache-2.0
"""Draw rigid tools: a thick line with the hatched metal behind it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from presswork.model import FloatArray
from presswork.post import trace_profile
from presswork.results import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_tools(ax: Axes, result: Result, step: int, width: float, signs: Sequence[tuple[int, int]]) -> None:
    """Draw all tools where they are at a step; the hatched band is `width` [mm] wide, mirrored images by `signs`."""
    for name in result.tools:
        for line in trace_profile(result.placed_tool(name, step)):
            band = np.concatenate([line, offset_to_right(line, width)[::-1]])
            for sign in signs:
                ax.fill(*(band * sign).T, facecolor="0.93", edgecolor="0.6", hatch="////", linewidth=0, zorder=0.5)
                ax.plot(*(line * sign).T, color="0.15", linewidth=1.8, solid_capstyle="butt", zorder=3)


def offset_to_right(line: FloatArray, distance: float) -> FloatArray:
    """Return the polyline (n, 2) shifted to its right by `distance`, corners mitred up to twice the distance."""
    along = np.diff(line, axis=0)
    normals = np.column_stack([along[:, 1], -along[:, 0]]) / np.linalg.norm(along, axis=1)[:, None]
    before, after = np.vstack([normals[:1], normals]), np.vstack([normals, normals[-1:]])
    mean = before + after
    mitre = mean / np.maximum(0.5 * np.sum(mean**2, axis=1), 0.5)[:, None]
    return np.asarray(line + distance * mitre, dtype=np.float64)
