# SPDX-License-Identifier: Apache-2.0
"""Nodes under constant shear that neither push nor lift off: the part of the shear that acts there.

Constant shear m k acts where a node is in contact and nowhere else, whatever the pressure. So a node may have no place:
held, its shear and that of the edges beside it drag it off the tool; let go, without that shear, it comes back. The
equilibrium lies between, on the vertical branch of the law: the node touches, its normal force is zero, and a part of
the shear between 0 and 1 acts on the edges beside it. The part is found by the secant rule from one iteration to the
next, and is kept in State.shear_part, from which the next increment starts.
"""

from __future__ import annotations

import numpy as np

from presswork.model import BoolArray, FloatArray

LARGEST_STEP = 0.5
"""Of the part, from one iteration to the next."""
SOME = 1e-3
"""Push over the largest on a node, below which a part less than 1 is right."""


class Grazing:
    """The nodes of one increment whose part of the shear is looked for."""

    def __init__(self, n_candidates: int) -> None:
        self._part = np.full(n_candidates, np.nan)  # where each was last looked at, nan: not yet in this increment
        self._push = np.zeros(n_candidates)

    def begin_increment(self) -> None:
        """Forget what the increment before has tried."""
        self._part[:] = np.nan

    def update(self, part: FloatArray, nodes: BoolArray, push: FloatArray, tolerance: float, largest: float) -> int:
        """Improve the parts of `nodes` (n_candidates,) in place; return how many have changed.

        push: on the nodes (n_candidates,) [N], negative pulls. tolerance: pull that counts as none [N].
        largest: push on a node [N].
        """
        enough = SOME * largest
        wrong = nodes & ((push < -tolerance) | ((push > max(enough, tolerance)) & (part < 1.0)))
        places = np.nonzero(wrong)[0]
        for i in places:
            known = np.isfinite(self._part[i]) and abs(part[i] - self._part[i]) > 1e-9
            slope = (push[i] - self._push[i]) / (part[i] - self._part[i]) if known else 0.0
            step = (0.5 * enough - push[i]) / slope if slope < 0.0 else np.sign(push[i]) * LARGEST_STEP
            self._part[i], self._push[i] = part[i], push[i]
            part[i] = np.clip(part[i] + np.clip(step, -LARGEST_STEP, LARGEST_STEP), 0.0, 1.0)
        return len(places)
