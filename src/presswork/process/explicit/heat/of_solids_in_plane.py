# SPDX-License-Identifier: Apache-2.0
"""Heat of solids in the plane in explicit dynamics: what differs from space."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from presswork import _core
from presswork.explicit.solids import ExplicitSolids
from presswork.explicit.walls import Wall
from presswork.geometry.pose import ToolPose, start_centre, start_profile
from presswork.interaction.heat.forming_instant import Poses
from presswork.model import FloatArray, Model
from presswork.process.explicit.contacts import ContactsOfRun
from presswork.process.explicit.heat.of_solids import HeatOfSolids


class HeatOfSolidsInPlane(HeatOfSolids):
    """Heat of a model's bodies in the plane, beside the explicit loop."""

    def __init__(
        self, model: Model, solids: ExplicitSolids, walls: Sequence[Wall], contacts: ContactsOfRun, threads: int
    ) -> None:
        """solids, walls, contacts: those of the explicit loop."""
        self._plane_solids, self._profiles = solids, walls
        self._ends = np.cumsum([len(block.connectivity) for block in model.mesh.blocks])[:-1]
        super().__init__(model, solids, walls, contacts, threads)

    def _find_rise(self) -> list[FloatArray]:
        return np.split(self._plane_solids.rise[:, None], self._ends)

    def _set_given(self, given: list[FloatArray]) -> None:
        self._plane_solids.prescribed_temperature = np.concatenate(given)[:, 0]

    def _find_poses(self) -> Poses:
        return [
            ToolPose(start_centre(tool), wall.displacement, 0.0)
            for tool, wall in zip(self._model.plane_tools, self._profiles, strict=True)
        ]

    def _find_gap(self, t: int, places: FloatArray, reach: float) -> FloatArray:
        local = np.ascontiguousarray(places - self._profiles[t].displacement)
        return np.asarray(_core.touch_profile(start_profile(self._model.plane_tools[t]), local)[0])
