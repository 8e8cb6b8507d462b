# SPDX-License-Identifier: Apache-2.0
"""Sharp corners of tools, rounded by a radius that cells can follow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from presswork.case.tools.profile import ProfileError, round_corner
from presswork.geometry.segments import TURN, X0, X1
from presswork.model import FloatArray, Profile, Tool

SHARP = np.radians(30.0)
"""Turn of a profile from which on an edge cannot lie round a corner."""


def round_outer_corners(tools: Sequence[Tool], radius: float) -> tuple[Tool, ...]:
    """Return tools whose sharp corners that point into the metal have a radius [mm].

    Metal that flows round a sharp corner has an edge across it on any mesh, and the corner cuts into the edge. Corners
    between two lines are rounded where both are long enough.
    """
    return tuple(_round_tool(tool, radius) for tool in tools)


def _round_tool(tool: Tool, radius: float) -> Tool:
    if not isinstance(tool.shape, Profile):
        return tool
    rows, of = _round_rows(tool.shape.segments, radius)
    m, mu = (value[of] if isinstance(value, np.ndarray) else value for value in (tool.friction.m, tool.friction.mu))
    friction = replace(tool.friction, m=m, mu=mu)
    return replace(tool, shape=Profile(np.array(rows)), friction=friction)


def _round_rows(segments: FloatArray, radius: float) -> tuple[list[FloatArray], list[int]]:
    """Return the segments with arcs between them, and the segment before that each comes from."""
    rows, of = [segments[0].copy()], [0]
    for i, segment in enumerate(segments[1:], start=1):
        after = segment.copy()
        if rows[-1][TURN] == 0.0 and after[TURN] == 0.0 and _turn(rows[-1], after) < -SHARP:
            try:
                arc = round_corner(rows[-1], after, radius, i)
            except ProfileError:
                pass
            else:
                rows.append(arc)
                of.append(i - 1)
        rows.append(after)
        of.append(i)
    return rows, of


def _turn(before: FloatArray, after: FloatArray) -> float:
    """Return the turn from a line to the next one [rad], negative where the tool's metal points into free space."""
    a, b = before[X1] - before[X0], after[X1] - after[X0]
    return float(np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b))
