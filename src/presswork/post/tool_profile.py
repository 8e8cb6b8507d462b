# SPDX-License-Identifier: Apache-2.0
"""Tool profiles as polylines, and distances from them."""

from __future__ import annotations

import numpy as np

from presswork.model import FloatArray

_ARC_STEP = np.radians(3.0)
_AT_ONCE = 64
"""Pieces of a polyline whose distances are found together."""


def trace_profile(segments: FloatArray) -> list[FloatArray]:
    """Return a tool's profile as polylines, one for each connected run of segments, each (n, 2) [mm].

    `segments` (n_segments, 7) as in model.Tool. Arcs are divided so that a chord spans 3 degrees at most.
    """
    runs: list[list[FloatArray]] = []
    for segment in segments:
        line = _trace_segment(segment)
        size = max(1.0, float(np.abs(line).max()))
        if runs and np.allclose(runs[-1][-1][-1], line[0], atol=1e-9 * size):
            runs[-1].append(line[1:])
        else:
            runs.append([line])
    return [np.concatenate(run) for run in runs]


def distance_to_profile(points: FloatArray, profile: list[FloatArray]) -> FloatArray:
    """Return each point's distance to the nearest polyline [mm], shape (n_points,)."""
    nearest = np.full(len(points), np.inf)
    for line in profile:
        for first in range(0, len(line) - 1, _AT_ONCE):
            ends = line[first : first + _AT_ONCE + 1]
            along = np.diff(ends, axis=0)
            away = points[:, None] - ends[:-1]
            part = (away * along).sum(axis=2) / np.maximum((along**2).sum(axis=1), 1e-300)
            squares = ((away - np.clip(part, 0.0, 1.0)[..., None] * along) ** 2).sum(axis=2)
            nearest = np.minimum(nearest, np.sqrt(squares.min(axis=1)))
    return nearest


def _trace_segment(segment: FloatArray) -> FloatArray:
    """Return the points of one line or arc, ends included."""
    start, end, centre, turn = segment[0:2], segment[2:4], segment[4:6], segment[6]
    if turn == 0:
        return np.array([start, end])
    first, last = (np.arctan2(*(point - centre)[::-1]) for point in (start, end))
    sweep = (turn * (last - first)) % (2 * np.pi) or 2 * np.pi
    angles = first + turn * np.linspace(0.0, sweep, max(2, int(np.ceil(sweep / _ARC_STEP)) + 1))
    arc = centre + np.linalg.norm(start - centre) * np.column_stack([np.cos(angles), np.sin(angles)])
    arc[0], arc[-1] = start, end
    return np.asarray(arc, dtype=np.float64)
