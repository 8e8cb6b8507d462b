# SPDX-License-Identifier: Apache-2.0
"""How far dies with a flash land are filled, and how thick the flash is: what the plane and space have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from presswork.model import FloatArray, Mesh, Model, Tool
from presswork.process.recording import Row
from presswork.process.tool_quantities import find_way


@dataclass(frozen=True)
class Die:
    """A tool that has a cavity and a flash land; places lie where the tool begins."""

    name: str
    places: FloatArray
    """Middles of the pieces of the cavity's wall (n, dimension) [mm]."""
    area: FloatArray
    """Of each piece (n,) [mm^2]."""
    land: FloatArray
    """Places of the flash land (m, dimension) [mm]."""
    tolerance: float
    """Gap that counts as filled [mm]."""
    plane: tuple[int, float] | None
    """Axis along which the die closes and the place of a symmetry plane across it [mm], if there is one."""


class DieFill(ABC):
    """Measures the dies of one model."""

    def __init__(self, model: Model, dies: Iterable[Die]) -> None:
        self._model = model
        self._dies = list(dies)

    @property
    def columns(self) -> list[str]:
        """Of history.csv."""
        return [f"{die.name}.{what}" for die in self._dies for what in ("fill", "flash_thickness")]

    def measure(self, mesh: Mesh, position: FloatArray, displacement: Mapping[str, FloatArray]) -> Row:
        """Return the columns. position: of the nodes (n_points, dimension) [mm]; displacement: of the tools [mm]."""
        row: Row = {}
        for die in self._dies:
            gap = self._find_gaps(mesh, position, die.places + displacement[die.name])
            row[f"{die.name}.fill"] = float(die.area[gap <= die.tolerance].sum() / die.area.sum())
            row[f"{die.name}.flash_thickness"] = self._flash_thickness(die, displacement)
        return row

    def summarise(self, mesh: Mesh, position: FloatArray, displacement: Mapping[str, FloatArray]) -> dict[str, Any]:
        """Return what the summary tells of each die on the metal: fill, largest gap with its place, open volume."""
        row, found = self.measure(mesh, position, displacement), {}
        for die in self._dies:
            places = die.places + displacement[die.name]
            gap = self._find_gaps(mesh, position, places)
            if row[f"{die.name}.fill"] == 0.0:  # set aside
                continue
            worst = int(np.argmax(gap))
            found[die.name] = {
                "wall_filled": row[f"{die.name}.fill"],
                "largest_gap_mm": float(gap[worst]),
                "largest_gap_at_mm": [float(x) for x in places[worst]],
                "unfilled_volume_mm3": float((gap * die.area).sum()),
                "flash_thickness_mm": row[f"{die.name}.flash_thickness"],
            }
        return {"die_fill": found} if found else {}

    def _flash_thickness(self, die: Die, displacement: Mapping[str, FloatArray]) -> float:
        """Return how far the land is from what lies opposite [mm]: twice to a symmetry plane, or to other tools."""
        land = die.land + displacement[die.name]
        if die.plane is not None:
            axis, place = die.plane
            return float(2.0 * np.abs(land[:, axis] - place).min())
        others = [tool.name for tool in self._model.tools if tool.name != die.name]
        return min((self._reach(name, land, displacement[name]) for name in others), default=np.nan)

    @abstractmethod
    def _find_gaps(self, mesh: Mesh, position: FloatArray, places: FloatArray) -> FloatArray:
        """Return the distance of places (n, dimension) from the metal (n,) [mm]."""

    @abstractmethod
    def _reach(self, tool: str, land: FloatArray, displacement: FloatArray) -> float:
        """Return how far places of a land are from another tool at least [mm]."""


def find_way_of_die(model: Model, tool: Tool) -> FloatArray | None:
    """Return the direction in which a tool closes as a die (dimension,), None if it does not close or turns."""
    turns = any(tool.name in s.tool_motion and s.tool_motion[tool.name].turn for s in model.stages)
    return None if turns else find_way(model, tool)
