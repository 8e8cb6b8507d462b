# SPDX-License-Identifier: Apache-2.0
"""The blank's outline: its size, and how it nests in a strip."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.model import FloatArray

_ANGLES = 180
"""Turns of the blank in the strip that are tried, over half a turn."""
_CORNERS = 200
"""Least number of corners of the outline that are tried to choose the turn."""


@dataclass(frozen=True)
class BlankOutline:
    """Closed polygons without their first point repeated: the outline, then holes."""

    loops: tuple[FloatArray, ...]
    """Each (n, 2) [mm]."""

    @property
    def area(self) -> float:
        """Net area [mm2]."""
        sizes = [abs(_signed_area(loop)) for loop in self.loops]
        return sizes[0] - sum(sizes[1:])

    @property
    def extent(self) -> tuple[float, float]:
        """Width along x and y [mm]."""
        width, height = np.ptp(self.loops[0], axis=0)
        return float(width), float(height)

    def mirrored(self, symmetry: tuple[bool, bool]) -> BlankOutline:
        """Return the whole outline of a half or a quarter that symmetry planes cut from it.

        Stretches of the outline along a symmetry plane are left out.
        """
        loops = list(self.loops)
        for axis, wanted in enumerate(symmetry):
            if wanted:
                loops = [whole for loop in loops for whole in _mirror(loop, axis)]
        return BlankOutline(tuple(loops))


def _signed_area(loop: FloatArray) -> float:
    x, y = loop.T
    return 0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))


def _mirror(loop: FloatArray, axis: int) -> list[FloatArray]:
    """Return a loop and its image, joined where it ends on the plane; or both, where it does not touch it."""
    flip = np.ones(2)
    flip[axis] = -1.0
    on_plane = np.abs(loop[:, axis]) < 1e-6 * float(np.ptp(loop, axis=0).max())
    if not on_plane.any():
        return [loop, (loop * flip)[::-1]]
    starts = np.flatnonzero(on_plane & ~np.roll(on_plane, -1))
    arcs = []
    for start in starts:
        arc = np.roll(loop, -start, axis=0)
        ends = np.flatnonzero(on_plane[np.arange(start + 1, start + len(loop) + 1) % len(loop)])
        arcs.append(arc[: ends[0] + 2] if ends[0] + 2 <= len(arc) else np.concatenate([arc, arc[:1]]))
    longest = max(arcs, key=len)
    return [np.concatenate([longest, (longest * flip)[::-1][1:-1]])]


@dataclass(frozen=True)
class Nesting:
    """One blank after the other in a strip."""

    angle: float
    """Angle by which the blank is turned, counter-clockwise [degrees]."""
    pitch: float
    """Feed of the strip for each blank [mm]."""
    width: float
    """Width of the strip [mm]."""
    utilisation: float
    """Net area of the blank over pitch x width."""


def nest(outline: BlankOutline, *, web: float = 0.0) -> Nesting:
    """Find the turn of the blank that wastes least of a strip with one row. web: left between blanks and at the
    strip's edges [mm].
    """
    best, least = 0.0, np.inf
    thinned = outline.loops[0][:: max(1, len(outline.loops[0]) // _CORNERS)]
    for angle in np.arange(_ANGLES) * (180.0 / _ANGLES):
        pitch, width = _strip(thinned, angle, web)
        if pitch * width < least * (1.0 - 1e-9):
            best, least = float(angle), pitch * width
    pitch, width = _strip(outline.loops[0], best, web)
    return Nesting(best, pitch, width, outline.area / (pitch * width))


def _strip(loop: FloatArray, angle: float, web: float) -> tuple[float, float]:
    """Return pitch and width of the strip for a polygon turned by the angle [degrees]."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    turned = loop @ np.array([[c, s], [-s, c]])
    return _pitch(turned) + web, float(np.ptp(turned[:, 1])) + 2.0 * web


def _pitch(loop: FloatArray) -> float:
    """Return the least shift along x that takes a polygon past itself: its longest span at one height.

    The span between the leftmost and rightmost crossing is longest at a corner's height.
    """
    after = np.roll(loop, -1, axis=0)
    low, high = np.minimum(loop[:, 1], after[:, 1]), np.maximum(loop[:, 1], after[:, 1])
    longest = 0.0
    for y in np.unique(loop[:, 1]):
        crossing = (low <= y) & (y <= high)
        a, b = loop[crossing], after[crossing]
        rise = b[:, 1] - a[:, 1]
        share = np.divide(y - a[:, 1], rise, out=np.zeros_like(rise), where=rise != 0.0)
        x = np.concatenate([a[:, 0] + share * (b[:, 0] - a[:, 0]), b[rise == 0.0, 0]])
        longest = max(longest, float(np.ptp(x)))
    return longest
