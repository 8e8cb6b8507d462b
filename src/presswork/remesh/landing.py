# SPDX-License-Identifier: Apache-2.0
"""Small cells where a free surface comes to lie on a tool, or on another body.

Contact is at nodes, so the area in contact grows by an edge whenever a node lands: the force lags before it and is
ahead after it, by 3 to 6 % where a die is nearly full. So edges are short where the contact ends and the free surface
comes nearer to the tool at less than 60 degrees, and on the free surface in proportion to its gap: what lands next has
the shortest ones.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from presswork import _core
from presswork.model import BoolArray, FloatArray
from presswork.remesh.size_field import SizeSources

OF_GAP = 0.5
"""Edge of the free surface over its gap to the tool."""
STEEP = np.sin(np.radians(60.0))
"""Gap of the first free node over its edge, beyond which the surface stands on the tool rather than lands on it."""
REACH = 3.0
"""Way along the free surface from the contact on, over the largest size."""
MOST_SHARE = 0.01
"""Part of a tool's force that an edge may add when its node lands, wherever LEAST allows."""
LEAST = 0.5
"""Least size over the smallest one, where an edge adds more."""


def find_closing(
    points: FloatArray, moved: FloatArray, profiles: Sequence[FloatArray], before: Sequence[FloatArray]
) -> BoolArray:
    """Mark the points that have come nearer to each profile (n_profiles, n).

    points, moved: where they are and by what they have moved (n, 2) [mm]; profiles, before: of tools and of other
    bodies where they are, and where they were.
    """
    closing = np.zeros((len(profiles), len(points)), dtype=bool)
    now, then = np.ascontiguousarray(points), np.ascontiguousarray(points - moved)
    for own, profile, profile_then in zip(closing, profiles, before, strict=True):
        gap, gap_then = (
            _core.touch_profile(np.ascontiguousarray(segments), at)[0]
            for segments, at in ((profile, now), (profile_then, then))
        )
        own[:] = np.isfinite(gap) & (gap < gap_then)
    return closing


def draw_outline(line: FloatArray) -> FloatArray:
    """Return a closed line (n, 2) [mm], the metal on its left, as a profile on which another body lands (n, 7)."""
    back = line[::-1]
    return np.column_stack([back, np.roll(back, -1, axis=0), np.zeros((len(line), 3))])


def find_landings(
    line: FloatArray, held: BoolArray, free: BoolArray, profile: FloatArray, share: FloatArray, *,
    smallest: float, largest: float,
) -> SizeSources:  # fmt: skip
    """Return the sizes wanted where a closed line (n, 2) comes to lie on a placed profile.

    held: nodes that this tool, or any other body, holds (n,); free: nodes that nothing holds and that come nearer to
    it (n,); share: of the tool's force, at each node (n,); smallest, largest: sizes of cells [mm]. Where fewer than
    three nodes touch no cell is made smaller: more of them would share in a contact that has just begun, and the force
    would change.
    """
    n = len(line)
    gap = np.maximum(_core.touch_profile(np.ascontiguousarray(profile), np.ascontiguousarray(line))[0], 0.0)
    length = np.linalg.norm(np.roll(line, -1, axis=0) - line, axis=1)
    size = np.full(n, np.inf)
    for step in (1, -1):
        three = held & np.roll(held, step) & np.roll(held, 2 * step)
        for end in np.flatnonzero(three & np.roll(free, -step)).tolist():
            ahead = (end + step * np.arange(n)) % n
            distance = np.cumsum(length[ahead if step == 1 else ahead - 1])
            if gap[ahead[1]] > STEEP * distance[0]:
                continue
            goes_on = free[ahead[1:]] & (distance[:-1] < REACH * largest)
            own = ahead[: 1 + int(np.argmin(np.append(goes_on, False)))]
            back = (end - step * np.arange(4)) % n
            least = _find_least(share[back[:3]], length[back if step == 1 else back - 1], smallest)
            size[own] = np.minimum(size[own], np.clip(OF_GAP * gap[own], least, largest))
    lands = np.isfinite(size)
    return SizeSources(line[lands], size[lands])


def _find_least(share: FloatArray, length: FloatArray, smallest: float) -> float:
    """Return the size with which an edge that lands adds MOST_SHARE of a tool's force, at most the smallest one [mm].

    share: of that force, at the last three nodes in contact (3,); length: of the edges beside them, from the one that
    lands next on (4,) [mm].
    """
    distance = float(length @ [0.5, 1.0, 1.0, 0.5])
    return float(np.clip(MOST_SHARE * distance / max(float(share.sum()), 1e-12), LEAST * smallest, smallest))
