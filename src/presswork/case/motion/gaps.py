# SPDX-License-Identifier: Apache-2.0
"""Gaps of tools where they start, and points on their profiles."""

from __future__ import annotations

import numpy as np

from presswork import _core
from presswork.geometry.blocked_motion import look_at
from presswork.geometry.pose import start_profile
from presswork.geometry.segments import TURN, X0, X1, sample_arc
from presswork.model import FloatArray, Profile, Tool

SPACED = 200
"""Points of a profile, at least."""
CHORD = 1e-4
"""How far chords are off an arc, over its radius."""


def measure_gap(tool: Tool, points: FloatArray, reach: float) -> FloatArray:
    """Return the gap of a tool where it starts at points (n, d) [mm]: negative in its metal, infinite out of reach."""
    if isinstance(tool.shape, Profile):
        gap, _, other_face, *_ = _core.touch_profile(start_profile(tool), np.ascontiguousarray(points))
        near = np.minimum(gap, other_face)
        return np.where(np.abs(near) < reach, near, np.inf)
    return np.asarray(look_at(tool)(points, reach)[0])


def walk_profile(tool: Tool) -> FloatArray:
    """Return points all along a profile where it starts (n, 2) [mm]."""
    segments = start_profile(tool)
    lengths = np.linalg.norm(segments[:, X1] - segments[:, X0], axis=1)
    apart = max(float(lengths.sum()) / SPACED, 1e-9)
    points = []
    for segment, length in zip(segments, lengths, strict=True):
        if segment[TURN] != 0.0:
            points.append(sample_arc(segment, CHORD * float(np.linalg.norm(segment[X0] - segment[4:6]))))
        else:
            parts = np.linspace(0.0, 1.0, int(length / apart) + 2)[:, None]
            points.append((1.0 - parts) * segment[X0] + parts * segment[X1])
    return np.concatenate(points)
