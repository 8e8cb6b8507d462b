# SPDX-License-Identifier: Apache-2.0
"""Filling of a die: the gap between the die's profile and the workpiece."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.model import FloatArray, find_cell
from presswork.post.tool_profile import distance_to_profile, trace_profile
from presswork.results import Result, ResultError

_SAMPLES = 400


@dataclass(frozen=True)
class DieFill:
    """The cavity's wall at equal distances along the profile, and what is open before it."""

    points: FloatArray
    """Places on the die's profile in its present position (n, 2) [mm]."""
    gap: FloatArray
    """Distance from each place to the workpiece's surface (n,) [mm]."""
    filled: float
    """Part of the wall's area that lies within the tolerance of the workpiece, 0 to 1."""
    unfilled_volume: float
    """Unfilled volume between wall and workpiece [mm3]; round the axis in axisymmetry, for 1 mm of depth in plane
    strain."""


def measure_die_fill(
    result: Result, tool: str, step: int = -1, *, x_range: tuple[float, float], tolerance: float = 0.1
) -> DieFill:
    """Measure how far a die's cavity is filled at a saved step.

    `x_range` [mm]: the cavity is the part of the profile between these x (radii in axisymmetry), without the flash;
    `tolerance` [mm]: a gap below it counts as filled. The gap is the distance to the nearest straight edge of the
    deformed mesh; a chord that cuts a rounded die shows as a gap of its sagitta. The unfilled volume is the gap summed
    over the wall: exact for narrow gaps, too large in corners. Raises ResultError for an unknown tool or step, or if no
    part of the profile lies in the range.
    """
    low, high = x_range
    pieces = [_resample(line) for line in trace_profile(result.placed_tool(tool, step))]
    points = np.concatenate([middles for middles, _ in pieces])
    lengths = np.concatenate([length for _, length in pieces])
    axisymmetric = result.info.get("analysis") == "axisymmetric"
    inside = (points[:, 0] >= (max(low, 0.0) if axisymmetric else low)) & (points[:, 0] <= high)
    if not inside.any():
        raise ResultError(f"no part of tool {tool} lies between x = {low:g} and {high:g} mm")
    points, lengths = points[inside], lengths[inside]
    edges = result.mesh_at(step).boundary_edges
    surface = list(result.points(step)[edges[:, find_cell(1, edges).ring]])
    gap = distance_to_profile(points, surface)
    area = lengths * (2 * np.pi * np.abs(points[:, 0]) if axisymmetric else 1.0)
    return DieFill(points, gap, float(area[gap <= tolerance].sum() / area.sum()), float((gap * area).sum()))


def _resample(line: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the middles of short pieces of a polyline (n, 2), and the length of each (n,)."""
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    counts = np.maximum(np.ceil(steps / steps.sum() * _SAMPLES).astype(int), 1)
    fractions = np.concatenate([(np.arange(n) + 0.5) / n for n in counts])
    start, along = np.repeat(line[:-1], counts, axis=0), np.repeat(np.diff(line, axis=0), counts, axis=0)
    return start + fractions[:, None] * along, np.repeat(steps / counts, counts)
