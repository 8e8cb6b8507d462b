# SPDX-License-Identifier: Apache-2.0
"""The volume that cells lose as they deform, which new meshes give back."""

from __future__ import annotations

import numpy as np

from presswork.model import list_bodies
from presswork.process.implicit.increments import IncrementRun
from presswork.process.mesh_change.given_back import limit_lost


class LostVolume:
    """What the bodies of a run have lost since it began."""

    def __init__(self, run: IncrementRun) -> None:
        self._run = run
        volume = run.procedure.state.cells.volume
        self._first = [sum(float(volume[i].sum()) for i in body.blocks) for body in list_bodies(run.model)]

    def find(self, number: int) -> float:
        """Return the part of a body's volume that cells have lost beyond what their pressure explains."""
        model, cells, unloaded = self._run.model, self._run.procedure.state.cells, 0.0
        for block in list_bodies(model)[number].blocks:
            material = model.materials[model.mesh.blocks[block].material]
            if material.gtn is not None:  # its pores grow
                return 0.0
            stress, volume = cells.stress[block], cells.volume[block]
            dilatation = stress[..., :3].sum(axis=-1) * (1.0 - 2.0 * material.poisson) / material.young
            unloaded += float((volume * np.exp(-dilatation)).sum())
        if unloaded <= 0.0:  # products of its lengths vanish
            return 0.0
        return limit_lost(self._first[number], unloaded)
