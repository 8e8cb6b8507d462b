# SPDX-License-Identifier: Apache-2.0
"""The wall of a die's cavity: the part of its profile between its flash lands.

A flash land is the deepest part of a die along its travel where it lies across the direction of travel: there the dies
come closest. The cavity is the rest of the profile in front of the workpiece, up to the first land on either side.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.geometry.profile_path import ProfilePath
from presswork.model import BoolArray, FloatArray

SAMPLES = 400
"""Pieces of equal length that a profile is divided into."""
LAND = 0.05
"""How much shallower a land may be than its deepest place, over the depth of a profile along its travel."""
ACROSS = 0.3
"""Largest cosine of the angle between a land and the direction of travel."""
LEAST_LAND, LEAST_WALL = 0.02, 0.5
"""Least length of a land over that of the wall, and of the wall over that of the longest land."""


@dataclass(frozen=True)
class CavityWall:
    """The wall of a cavity in pieces of equal length, where the profile is drawn."""

    places: FloatArray
    """Middles of the pieces (n, 2) [mm]."""
    piece: float
    """Length of each [mm]."""
    land: FloatArray
    """Places on the lands that end it (m, 2) [mm]."""


def find_cavity_wall(
    profile: FloatArray, direction: FloatArray, beside: FloatArray, plane: FloatArray | None = None
) -> CavityWall | None:
    """Return the wall of a die's cavity; None if the profile has no flash land, or no cavity.

    profile: segments (n, 7) as in model.Profile; direction: unit vector along which the die closes (2,); beside: the
    middle of the workpiece (2,) [mm], in front of which the cavity is; plane: a place on the axis, or on the symmetry
    plane along the stroke (2,) [mm], if there is one: no land lies between it and the middle.
    """
    line = ProfilePath(profile)
    piece = line.length / SAMPLES
    at = np.asarray((np.arange(SAMPLES) + 0.5) * piece, dtype=np.float64)
    places = line.at(at)
    along: FloatArray = line.at(at + 0.25 * piece) - line.at(at - 0.25 * piece)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    depth, sideways = places @ direction, np.array([-direction[1], direction[0]])
    is_land = (depth > depth.max() - LAND * np.ptp(depth)) & (np.abs(along @ direction) < ACROSS)
    across = (places - beside) @ sideways
    start = int(np.argmin(np.abs(across)))
    if is_land[start]:
        return None
    if plane is not None:
        is_land &= across * float((beside - plane) @ sideways) > 0.0
    if not is_land.any():
        return None
    first, last = _find_run(~is_land, start)
    lands = [_find_run(is_land, end) for end in (first - 1, last) if 0 <= end < SAMPLES]
    longest = max(end - begin for begin, end in lands)
    if longest < LEAST_LAND * (last - first) or last - first < LEAST_WALL * longest:
        return None
    land = np.concatenate([places[begin:end] for begin, end in lands])
    return CavityWall(places[first:last], piece, land)


def _find_run(is_inside: BoolArray, start: int) -> tuple[int, int]:
    """Return the first and one after the last of the run of marked entries round one of them."""
    outside = np.flatnonzero(~is_inside)
    before, after = outside[outside < start], outside[outside > start]
    return (int(before[-1]) + 1 if len(before) else 0), (int(after[0]) if len(after) else len(is_inside))
