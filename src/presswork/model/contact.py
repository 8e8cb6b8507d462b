# SPDX-License-Identifier: Apache-2.0
"""Bodies, and their contact with each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.model.arrays import BoolArray, IntArray
from presswork.model.tool import ContactLaw


@dataclass(frozen=True)
class Body:
    """A body of its own: a run of the mesh's points and cell blocks that no other body uses."""

    name: str
    points: range
    blocks: range

    def owns(self, edges: IntArray) -> BoolArray:
        """Return which edges (n, 2 | 3) or faces (n, 3 | 4) belong to the body, shape (n,)."""
        return np.asarray((edges[:, 0] >= self.points.start) & (edges[:, 0] < self.points.stop), dtype=bool)


@dataclass(frozen=True)
class BodyContact:
    """Contact between two bodies, or of a body with itself where both are the same."""

    name: str
    between: tuple[int, int]
    """Indices into Model.bodies, as the case names them."""
    slave: int
    """Index of the body whose nodes carry the pressure: one of the two."""
    contact: ContactLaw
    m: float = 0.0
    mu: float = 0.0
    keeps_slave: bool = False
    """Whether the case names the slave; else it is chosen anew with every mesh (choose_slave)."""
    joint: bool = False
    """Whether interlock, neck and bottom of a joint of the two are measured."""
    by_itself: bool = False
    """Whether the run has switched it on where a body folds onto itself; it has no columns in the history."""

    @property
    def master(self) -> int:
        """The other body, or the same."""
        return self.between[1] if self.slave == self.between[0] else self.between[0]
