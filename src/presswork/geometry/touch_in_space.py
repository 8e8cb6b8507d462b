# SPDX-License-Identifier: Apache-2.0
"""Where a tool in space first touches points as it moves along a line."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from presswork.model import FloatArray

MOST_STEPS = 2000
TOUCHING = 1e-9
"""Gap that counts as closed, over the size of the touched body."""
LEAST = 1e-3
"""Least step of a point that stays beside the tool, over the size of the touched body."""
FARTHEST = 1e4
"""Sizes beyond which a tool that has not touched never does."""
AGAINST = 1e-3
"""Component of the tool's normal along its motion from which on it comes towards a node, and does not glide past it."""

Nearest = Callable[[FloatArray, float], tuple[FloatArray, FloatArray]]
"""Returns gap (n,) and normal (n, 3) of a tool at points (n, 3), infinite gaps beyond a reach [mm]."""


def find_touch_in_space(nearest: Nearest, nodes: FloatArray, direction: FloatArray) -> float | None:
    """Return how far a tool goes along `way`, a unit vector (3,), until it touches a node (n, 3) [mm];
    None: never.

    Every node is taken towards the tool by its own gap again and again, since the tool can be no nearer, and halves its
    last step where that has led inside.
    """
    size = float(np.linalg.norm(np.ptp(nodes, axis=0)))
    gone, step = np.zeros(len(nodes)), np.zeros(len(nodes))
    waits, first = np.ones(len(nodes), dtype=bool), FARTHEST * size
    for _ in range(MOST_STEPS):
        index = np.flatnonzero(waits)
        waits[index] = gone[index] - step[index] < first
        index = np.flatnonzero(waits)
        if not len(index):
            break
        late = np.maximum(gone[index] - first, 0.0)  # the last step leads no farther than to the first touch
        gone[index] -= late
        step[index] -= late
        gap, normal = nearest(nodes[index] - gone[index, None] * direction, math.inf)
        comes = normal @ direction > AGAINST
        inside = (gap < -TOUCHING * size) & comes
        gone[index[inside]] -= 0.5 * step[index[inside]]
        step[index[inside]] *= 0.5
        touches = (np.abs(gap) <= TOUCHING * size) & comes
        touches |= inside & (step[index] <= TOUCHING * size)
        if touches.any():
            first = min(first, float(gone[index[touches]].min()))
        on = ~inside & ~touches & (gone[index] < first)
        waits[index[~inside & (gone[index] >= first)]] = False
        step[index[on]] = np.maximum(gap[on], LEAST * size)
        gone[index[on]] += step[index[on]]
        waits[index[touches | (on & ~np.isfinite(gap))]] = False
    return first if first < FARTHEST * size else None
