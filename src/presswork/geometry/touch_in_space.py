# SPDX-License-Identifier: Apache-2.0
"""Where a tool in space first touches points as it moves along a line."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from presswork.model import FloatArray

MOST_STEPS = 2000
TOUCHING = 1e-9
"""Of the size of what is touched: a gap that counts as closed."""
LEAST = 1e-3
"""Of the same size: the least step of a point that stays beside the tool."""
FARTHEST = 1e4
"""Sizes beyond which a tool that has not touched never does."""
AGAINST = 1e-3
"""Part of the tool's normal along its way from which it comes towards a node, and does not glide past it."""


def find_touch_in_space(
    nearest: Callable[[FloatArray, float], tuple[FloatArray, FloatArray]], nodes: FloatArray, way: FloatArray
) -> float | None:
    """Return how far a tool goes along `way` (3,), of length 1, until it touches a node (n, 3) [mm]; None: never.

    nearest: returns gap (n,) and normal (n, 3) of the tool at points, infinite gaps beyond a reach [mm]. Every node is
    taken towards the tool by its own gap again and again, since the tool can be no nearer, and halves its last step
    where that has led inside.
    """
    size = float(np.linalg.norm(np.ptp(nodes, axis=0)))
    gone, step = np.zeros(len(nodes)), np.zeros(len(nodes))
    waits, first = np.ones(len(nodes), dtype=bool), FARTHEST * size
    for _ in range(MOST_STEPS):
        waits &= gone < first
        if not waits.any():
            break
        gap, normal = nearest(nodes[waits] - gone[waits, None] * way, math.inf)
        index = np.flatnonzero(waits)
        comes = normal @ way > AGAINST
        inside = (gap < -TOUCHING * size) & comes
        gone[index[inside]] -= 0.5 * step[index[inside]]
        step[index[inside]] *= 0.5
        touches = (np.abs(gap) <= TOUCHING * size) & comes
        touches |= inside & (step[index] <= TOUCHING * size)
        if touches.any():
            first = min(first, float(gone[index[touches]].min()))
        on = ~inside & ~touches
        step[index[on]] = np.maximum(gap[on], LEAST * size)
        gone[index[on]] += step[index[on]]
        waits[index[touches | (on & ~np.isfinite(gap))]] = False
    return first if first < FARTHEST * size else None
