# SPDX-License-Identifier: Apache-2.0
"""Heat of solids in space in explicit dynamics: what differs from the plane."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

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
        solids: Any,
        walls: Sequence[Any],
        contacts: ContactsOfRun,
        threads: int,
        *,
        place_tool: Callable[[int], PlacedSurface],
    ) -> None:
        """place_tool: returns a tool's surface as it stands, by its number."""
        self._place_tool = place_tool
        super().__init__(model, solids, walls, contacts, threads)

    def _find_rise(self) -> list[FloatArray]:
        return list(self._solids.rise_at_points)

    def _set_given(self, given: list[FloatArray]) -> None:
        self._solids.degrees = given

    def _find_poses(self) -> Poses:
        return []

    def _find_gap(self, t: int, places: FloatArray, reach: float) -> FloatArray:
        return np.asarray(self._place_tool(t).nearest(places, reach)[0])
