# SPDX-License-Identifier: Apache-2.0
"""Nodes under constant shear that neither push nor lift off: the part of the shear that acts there.

Constant shear m k acts where a node is in contact and nowhere else, whatever the pressure. So a node may have no place:
held, its shear and that of the edges beside it drag it off the tool; released, without that shear, it comes back. The
equilibrium lies between, on the vertical branch of the law: the node touches, its normal force is zero, and a part of
the shear between 0 and 1 acts on the edges beside it. The part is looked for between two that have been tried (rule of
Illinois), and is kept in ContactArrays.shear_part, from which the next increment starts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.model import BoolArray, FloatArray

SMALLEST_STEP, LARGEST_STEP = 0.01, 0.5
"""Smallest and largest step of the part from one look to the next, as long as one end is not known."""
BEYOND = 1.5
"""Such steps are as many times longer than they seem to need, to find the other end."""
SOME = 1e-3
"""Push over the largest on a node, below which a part less than 1 is right."""
MARGIN = 0.1
"""Part of a bracket that a step keeps off its ends."""


@dataclass(frozen=True)
class Drag:
    """Friction of the candidates in an iteration."""

    force: FloatArray
    """Its size (n_candidates,) [N]."""
    used: FloatArray
    """Friction over the largest that the law allows (n_candidates,): smaller parts than that make a difference."""


class Grazing:
    """The nodes of one increment whose part of the shear is looked for, each between two parts tried before."""

    def __init__(self, n_candidates: int) -> None:
        # the part tried, and its push beyond the one wanted [N]: the largest that pushes, the smallest that pulls
        self._low, self._high = np.full((n_candidates, 2), np.nan), np.full((n_candidates, 2), np.nan)

    def begin_increment(self) -> None:
        """Forget what the increment before has tried."""
        self._low[:], self._high[:] = np.nan, np.nan

    def update(
        self, part: FloatArray, nodes: BoolArray, push: FloatArray, drag: Drag, *, tolerance: float, credible: float,
        largest: float,
    ) -> int:  # fmt: skip
        """Improve the parts of `nodes` (n_candidates,) in place; return how many are not right yet.

        push: on the nodes (n_candidates,) [N], negative pulls. tolerance: pull that counts as none [N]. credible: a
        push or pull below it counts as zero, since the residual is as large [N]. largest: push on a node [N].
        """
        enough = max(SOME * largest, tolerance)
        wrong = nodes & ((push < -tolerance) | ((push > enough) & (part < 1.0)))
        for i in np.nonzero(wrong & (np.abs(push) > credible))[0]:
            excess = float(push[i]) - 0.5 * enough
            used = float(part[i]) * (float(drag.used[i]) if excess < 0.0 else 1.0)
            part[i] = self._next(self._low[i], self._high[i], used, excess, float(drag.force[i]))
        return int(wrong.sum())

    def _next(self, low: FloatArray, high: FloatArray, part: float, excess: float, drag: float) -> float:
        """Return the part to try after one that pushes by an excess: the rule of Illinois between both ends."""
        if not (low[0] < part < high[0] or np.isnan(low[0]) or np.isnan(high[0])):
            low[:], high[:] = np.nan, np.nan  # other nodes have changed since: begin anew
        end, other = (low, high) if excess > 0.0 else (high, low)
        if (part - other[0]) * excess > 0.0:
            other[:] = np.nan
        before = end.copy()
        end[:] = part, excess
        if np.isnan(other[0]):
            return float(np.clip(part + self._first_step(part, excess, before, drag), 0.0, 1.0))
        if not np.isnan(before[0]):
            other[1] *= 0.5  # it has stayed: go farther towards it
        width = high[0] - low[0]
        between = low[0] + width * low[1] / (low[1] - high[1])
        return float(np.clip(between, low[0] + MARGIN * width, high[0] - MARGIN * width))

    def _first_step(self, part: float, excess: float, before: FloatArray, drag: float) -> float:
        """Return a step towards the other end, which is not known: by the secant, or as if all drag were push."""
        slope = (excess - before[1]) / (part - before[0]) if before[0] != part else 0.0
        guess = -BEYOND * excess / slope if slope < 0.0 else np.inf  # the friction does not follow the part yet
        if np.isnan(before[0]):
            guess = BEYOND * excess / max(drag, 1e-300)
        return float(np.copysign(np.clip(abs(guess), SMALLEST_STEP, LARGEST_STEP), excess))
