# SPDX-License-Identifier: Apache-2.0
"""The bodies of an explicit run where they are now: their nodes, what holds them, and their volumes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from presswork.model import BoolArray, FloatArray, list_bodies
from presswork.process.explicit.forming import ExplicitForming
from presswork.process.mesh_change.given_back import limit_lost

NEAR = 0.02
"""Gap of a node that counts as on a tool, over the smallest size of cells."""


def list_nodes(run: ExplicitForming) -> list[slice]:
    """Return the nodes of each body."""
    return [slice(body.points.start, body.points.stop) for body in list_bodies(run.model)]


def find_held(run: ExplicitForming) -> BoolArray:
    """Mark the components that supports hold now (n_points, d)."""
    model, d = run.model, run.model.dimension
    held = np.zeros((len(model.mesh.points), d), dtype=bool)
    for support in model.supports_in(min(run.next_stage, len(model.stages) - 1)):
        held[model.mesh.node_sets[support.node_set]] |= np.asarray(support.fix[:d])
    return held


class PlasticVolumes:
    """The volumes of the bodies of a run without their elastic part, and what they have lost since it began."""

    def __init__(self, run: ExplicitForming, find_volumes: Callable[[], list[FloatArray]]) -> None:
        """find_volumes: returns the volume of each cell of each block (n_cells,)."""
        self._run, self._find = run, find_volumes
        self._first = self.measure()

    def measure(self) -> list[float]:
        """Return the volume of each body, in the unit of its cells."""
        run, found = self._run, []
        for block, volume, stress in zip(
            run.model.mesh.blocks, self._find(), run.split(run.solids.stress), strict=True
        ):
            material = run.model.materials[block.material]
            dilatation = stress[:, :3].sum(axis=1) * (1.0 - 2.0 * material.poisson) / material.young
            found.append(float((volume * np.exp(-dilatation)).sum()))
        return found

    def find_lost(self, number: int = 0) -> float:
        """Return the part of a body's volume that is lost and can be given back."""
        if self._run.has_pores:  # they grow
            return 0.0
        return limit_lost(self._first[number], self.measure()[number])
