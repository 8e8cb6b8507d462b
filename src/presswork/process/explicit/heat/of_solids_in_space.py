# SPDX-License-Identifier: Apache-2.0
"""Heat of solids in space in explicit dynamics: what differs from the plane."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from presswork.explicit.space_solids import ExplicitSpaceSolids
from presswork.explicit.space_walls import SpaceWall
from presswork.interaction.heat.forming_instant import Poses
from presswork.interaction.space.space_touch import PlacedSurface
from presswork.model import FloatArray, Model
from presswork.process.explicit.contacts import ContactsOfRun
from presswork.process.explicit.heat.of_solids import HeatOfSolids


class HeatOfSolidsInSpace(HeatOfSolids):
    """Heat of a model's bodies in space, beside the explicit loop."""

    def __init__(
        self,
        model: Model,
        solids: ExplicitSpaceSolids,
        walls: Sequence[SpaceWall],
        contacts: ContactsOfRun,
        threads: int,
        *,
        place_tool: Callable[[int], PlacedSurface],
    ) -> None:
        """place_tool: returns a tool's surface as it stands, by its number."""
        self._place_tool, self._space_solids = place_tool, solids
        super().__init__(model, solids, walls, contacts, threads)

    def _find_rise(self) -> list[FloatArray]:
        return list(self._space_solids.rise_at_points)

    def _set_given(self, given: list[FloatArray]) -> None:
        self._space_solids.degrees = given

    def _find_poses(self) -> Poses:
        return []

    def _find_gap(self, t: int, places: FloatArray, reach: float) -> FloatArray:
        return np.asarray(self._place_tool(t).nearest(places, reach)[0])
