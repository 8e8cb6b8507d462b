# SPDX-License-Identifier: Apache-2.0
"""Narrow gaps between two bodies: small cells where a corner or a round of the other body is about to touch.

What tools ask for ahead of contact by their corners and radii (size_field.py), other bodies ask for by those of their
outlines, which the run itself shapes. They ask only until they touch: from then on contact ends somewhere, and what
lands there has small cells (landing.py).
"""

from __future__ import annotations

import numpy as np
import scipy

from presswork import _core
from presswork.model import BoolArray, FloatArray
from presswork.remesh.fill import SizeField
from presswork.remesh.landing import draw_outline
from presswork.remesh.size_field import GRADATION, OF_RADIUS, REACH, SizeSources

SHARP = np.radians(30.0)
"""Turn of an outline beyond which it has a corner, not a round."""
NARROW = 1.0
"""Gap over the length of the edge before it, below which a mesh is made while no force can change yet."""
TOO_LONG = 1.3
"""Such an edge over the size wanted there."""


def find_corners_ahead(
    line: FloatArray, free: BoolArray, outline: FloatArray, *, smallest: float, largest: float
) -> SizeSources:
    """Return the sizes wanted where corners and rounds of another body come nearer, before they touch.

    line: closed, the metal on its left (n, 2) [mm]; free: nodes that nothing holds and that come nearer to the other
    body (n,); outline: of that body, as draw_outline gives it (k, 7); smallest, largest: sizes of cells [mm]. Only what
    points out of the other body counts: a corner with the smallest size, a round with a quarter of its radius.
    """
    corner, along = outline[:, :2], outline[:, 2:4] - outline[:, :2]
    before, length = np.roll(along, 1, axis=0), np.linalg.norm(along, axis=1)
    turn = np.arctan2(before[:, 1] * along[:, 0] - before[:, 0] * along[:, 1], (before * along).sum(axis=1))
    radius = 0.5 * (length + np.roll(length, 1)) / np.maximum(turn, 1e-9)
    size = np.where(turn > SHARP, smallest, np.maximum(OF_RADIUS * radius, smallest))
    _, nearest = scipy.spatial.cKDTree(line).query(corner)
    gap = _core.touch_profile(draw_outline(line), np.ascontiguousarray(corner))[0]
    ahead = (size < largest) & (gap > 0.0) & (gap < REACH * largest) & free[nearest]
    return SizeSources(corner[ahead], size[ahead] + GRADATION * np.maximum(gap[ahead] - largest, 0.0))


def find_narrow_gap(
    line: FloatArray, free: BoolArray, outline: FloatArray, size: SizeField, *, wait: float = 1.0
) -> str | None:
    """Describe an edge of a closed line (n, 2) that is too long for the narrow gap to another body before it.

    free, outline: as in find_corners_ahead; wait: factor on the trigger.
    """
    after = np.roll(line, -1, axis=0)
    middle, length = np.ascontiguousarray(0.5 * (line + after)), np.linalg.norm(after - line, axis=1)
    gap = _core.touch_profile(outline, middle)[0]
    narrow = free & np.roll(free, -1) & (gap > 0.0) & (gap < NARROW * length)
    ratio = np.where(narrow, length / size(middle), 0.0)
    worst = int(np.argmax(ratio))
    if ratio[worst] <= wait * TOO_LONG:
        return None
    x, y = middle[worst]
    edge = f"an edge of {length[worst]:.2g} mm near ({x:.4g}, {y:.4g})"
    return f"a gap of {gap[worst]:.2g} mm to another body, narrow for {edge}"
