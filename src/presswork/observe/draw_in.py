# SPDX-License-Identifier: Apache-2.0
"""Draw-in of a sheet's edge in directions that the case names, in the history.

A direction marks a point of the edge on the undeformed sheet; draw-in is how far that point has come inwards along the
direction, as post/section.py measures it from saved steps.
"""

from __future__ import annotations

import numpy as np

from presswork.mesh.outer_edge import find_outer_edge
from presswork.model import Model
from presswork.observe.contract import Observed, Observer, Row


class DrawIn(Observer):
    """The directions of a model, on its present mesh."""

    def __init__(self, model: Model) -> None:
        self._edges = []
        for direction in model.draw_in:
            found = find_outer_edge(model.mesh, direction.angle)
            assert found is not None, "the case was checked, and a mesh that is split keeps its edge"
            out = np.array([np.cos(direction.angle), np.sin(direction.angle)])
            self._edges.append((f"{direction.name}.draw_in", *found, out))

    def columns(self, run: Observed) -> list[str]:
        """Return one for each direction [mm]."""
        return [name for name, *_ in self._edges]

    def row(self, run: Observed, *, is_released: bool = False) -> Row:
        """Return how far the edge has come inwards."""
        if not self._edges:
            return {}
        moved = run.positions()[:, :2] - run.model.mesh.points[:, :2]
        return {name: -float(share @ moved[nodes] @ out) for name, nodes, share, out in self._edges}
