# SPDX-License-Identifier: Apache-2.0
"""Laps: places where the surface of a body has folded onto itself, which is a fault of the part.

They exert no force. A node is marked when its body touches itself there (contact of a body with itself). Marks go with
the material. What lies inside the metal, where new meshes have left folds out, process/mesh_change/seams.py follows.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from presswork.interaction.bodies.body_contact import BodyContacts
from presswork.interaction.bodies.body_surfaces import InterfaceArrays
from presswork.interaction.contract import Interaction
from presswork.model import FloatArray, Model
from presswork.state import RUN, SURFACE, Arrays, OnNewMesh, State


@dataclass
class LapArrays(Arrays):
    """Where laps are."""

    owner = "laps"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {"mark": SURFACE, "begun": RUN}
    mark: FloatArray
    """1 at nodes on a lap, 0 elsewhere (n_points,)."""
    begun: float
    """Time of the first [s]; -1: there is none."""


class LapMarks(Interaction):
    """The laps of one run; what persists lies in the State."""

    def __init__(self, model: Model, bodies: BodyContacts) -> None:
        self._n_points, self._bodies = len(model.mesh.points), bodies

    def at_rest(self) -> tuple[Arrays, ...]:
        """Return the arrays of bodies without laps."""
        return (LapArrays(np.zeros(self._n_points), -1.0),)

    def commit(self, state_n: State, trial: State, step: Any) -> None:
        """Mark the nodes at which bodies touch themselves."""
        for interface in self._bodies.interfaces:
            if interface.is_self:
                pushes = trial[InterfaceArrays].pressure[interface.places] > 0.0
                if pushes.any():
                    laps = trial[LapArrays]
                    laps.mark[interface.nodes[pushes]] = 1.0
                    laps.begun = step.time_n if laps.begun < 0.0 else laps.begun
