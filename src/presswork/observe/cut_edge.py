# SPDX-License-Identifier: Apache-2.0
"""The edge that a crack leaves on a piece of sheet: roll-over, sheared zone, fracture and burr (VDI 2906).

Heights are along the punch's motion, from the sheet's surfaces as they would be at the edge: straight lines through
their nodes one to two heights of the crack away. Where a mouth of the crack lies inside the thickness, the tool has
sheared the edge from there back to the roll-over, which begins where the edge leaves the wall. What stands out of a
surface beside a mouth is a burr.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.model import BoolArray, FloatArray, IndexArray

AWAY = (1.0, 2.0)
"""Way from the mouth to the nodes of the surface, over the height of the crack."""
NEAR = 0.25
"""Way from the mouth within which a burr may stand, over the height of the crack."""
OFF_WALL = 0.01
"""How far the edge lies off its wall where the roll-over begins, over the thickness."""
STRAIGHT = 0.03
"""How far nodes of a surface may lie off their line, over the height of the crack."""
LEAST_NODES = 3
"""Nodes of a surface through which its line is drawn, at least."""


@dataclass(frozen=True)
class CutEdge:
    """Heights of the zones of an edge [mm]."""

    rollover: float
    sheared: float
    fracture: float
    burr: float
    thickness: float


@dataclass(frozen=True)
class _Side:
    """What lies beyond one mouth of the crack."""

    surface: float
    """Height of the surface at the edge [mm]."""
    inside: float
    """How far the mouth lies inside the surface; negative: outside [mm]."""
    rollover: float
    burr: float
    """How far the edge stands out of the surface [mm]."""


def measure_cut_edge(loop: FloatArray, cracked: BoolArray, direction: FloatArray) -> CutEdge | None:
    """Return the zones of the edge of a piece; None: its crack does not go through, or it has no flat surfaces.

    loop: its outline, closed, the metal on its left (n, 2) [mm]; cracked: nodes on the faces of cracks (n,); direction:
    in which the tool cuts, of length 1 (2,).
    """
    runs = _find_runs(cracked)
    if not runs:
        return None
    height, across = loop @ direction, loop @ np.array([-direction[1], direction[0]])
    first, last = max(runs, key=lambda run: float(np.ptp(height[_between(run, len(loop))])))
    extent = abs(float(height[last] - height[first]))
    along = np.arange(len(loop))
    one = _measure_side(height, across, (first - along) % len(loop), float(height[last]), extent)
    other = _measure_side(height, across, (last + along) % len(loop), float(height[first]), extent)
    if one is None or other is None:
        return None
    thickness = abs(one.surface - other.surface)
    inside = sum(max(side.inside, 0.0) for side in (one, other))
    rollover = sum(side.rollover for side in (one, other))
    return CutEdge(rollover, inside - rollover, thickness - inside, max(one.burr, other.burr), thickness)


def _find_runs(cracked: BoolArray) -> list[tuple[int, int]]:
    """Return first and last of each run of marked nodes of a loop (n,)."""
    if cracked.all():
        return []
    starts = np.flatnonzero(cracked & ~np.roll(cracked, 1))
    ends = np.flatnonzero(cracked & ~np.roll(cracked, -1))
    return [(int(start), int(min(ends, key=lambda end: (end - start) % len(cracked)))) for start in starts]


def _between(run: tuple[int, int], n: int) -> IndexArray:
    first, last = run
    return (first + np.arange((last - first) % n + 1)) % n


def _measure_side(
    height: FloatArray, across: FloatArray, walk: IndexArray, opposite: float, extent: float
) -> _Side | None:
    """Return what lies beyond a mouth, where a walk along the outline begins; opposite: height of the other mouth."""
    h, c = height[walk], across[walk]
    along = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(h), np.diff(c)))])
    flat = np.flatnonzero((along > AWAY[0] * extent) & (along < AWAY[1] * extent))
    if len(flat) < LEAST_NODES or np.ptp(h[flat]) > np.ptp(c[flat]):
        return None
    slope, level = np.polyfit(c[flat] - c[0], h[flat], 1)
    if np.abs(level + slope * (c[flat] - c[0]) - h[flat]).max() > STRAIGHT * extent:
        return None
    surface = float(level)
    outwards = np.sign(surface - opposite) or 1.0
    inside = float(outwards * (surface - h[0]))
    near = (along < NEAR * extent) | (along > along[-1] - NEAR * extent)  # on this side of the mouth, and on the crack
    burr = max(0.0, float((outwards * (h[near] - surface)).max()))
    if inside <= 0.0:
        return _Side(surface, inside, 0.0, burr)
    upto = int(flat[0])
    away = np.sign(c[flat].mean() - c[0])  # from the wall into the sheet
    off = away * (c[:upto] - c[:upto][np.argmin(away * c[:upto])]) > OFF_WALL * extent
    wall_ends = max(int(np.argmax(off & (outwards * (h[:upto] - h[0]) > 0.0))) - 1, 0) if off.any() else 0
    end = float(np.clip(outwards * (surface - h[wall_ends]), 0.0, inside))
    return _Side(surface, inside, end, burr)
