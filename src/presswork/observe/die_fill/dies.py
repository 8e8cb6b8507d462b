# SPDX-License-Identifier: Apache-2.0
"""How far dies with a flash land are filled, and how thick the flash is: what the plane and space have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from presswork.model import FULL_DIE, BoolArray, FloatArray, Mesh, Model, Tool, find_held_side
from presswork.observe.contract import History, Observed, Observer, Row
from presswork.observe.working_direction import find_working_direction


@dataclass(frozen=True)
class Die:
    """A tool that has a cavity and a flash land; places lie where the tool begins."""

    name: str
    places: FloatArray
    """Middles of the pieces of the cavity's wall (n, dimension) [mm]."""
    area: FloatArray
    """Area of each piece (n,) [mm^2]."""
    land: FloatArray
    """Places of the flash land (m, dimension) [mm]."""
    tolerance: float
    """Gap that counts as filled [mm]."""
    plane: tuple[int, float] | None
    """Axis along which the die closes and the place of a symmetry plane across it [mm], if there is one."""


@dataclass(frozen=True)
class Side:
    """The axis of rotation or a symmetry plane, and the side of it where the workpiece is."""

    axis: int
    level: float
    """Its place along the axis [mm]."""
    sign: float
    """1: the workpiece is beyond it, -1: before it."""

    def holds(self, places: FloatArray) -> BoolArray:
        """Return which places (n, dimension) [mm] are on the side of the workpiece."""
        return np.asarray(self.sign * (places[:, self.axis] - self.level) >= 0.0)


class DieFill(Observer, ABC):
    """Measures the dies of one model."""

    def __init__(self, model: Model, dies: Iterable[Die]) -> None:
        self._model = model
        self._dies = list(dies)
        self._sides = find_sides(model) if self._dies else []

    def columns(self, run: Observed) -> list[str]:
        """Return the part of each die's wall that is filled, and the thickness of its flash."""
        return [f"{die.name}.{what}" for die in self._dies for what in ("fill", "flash_thickness")]

    def row(self, run: Observed, *, is_released: bool = False) -> Row:
        """Return fill and flash thickness of each die."""
        return self.measure(*_see(run)) if self._dies else {}

    def summary(self, run: Observed, history: History) -> dict[str, Any]:
        """Return fill, largest gap and open volume of each die on the metal."""
        return self.summarise(*_see(run)) if self._dies else {}

    def hints(self, run: Observed) -> list[str]:
        """Name the dies that are full."""
        return explain_full_dies(self.row(run))

    def measure(self, mesh: Mesh, position: FloatArray, displacement: Mapping[str, FloatArray]) -> Row:
        """Return the columns. position: of the nodes (n_points, dimension) [mm]; displacement: of the tools [mm]."""
        row: Row = {}
        for die in self._dies:
            _, gap, area = self._find_reach(die, mesh, position, displacement)
            row[f"{die.name}.fill"] = float(area[gap <= die.tolerance].sum() / max(area.sum(), 1e-300))
            row[f"{die.name}.flash_thickness"] = self._flash_thickness(die, displacement)
        return row

    def summarise(self, mesh: Mesh, position: FloatArray, displacement: Mapping[str, FloatArray]) -> dict[str, Any]:
        """Return the summary of each die on the metal: fill, largest gap with its place, open volume."""
        row, found = self.measure(mesh, position, displacement), {}
        for die in self._dies:
            if row[f"{die.name}.fill"] == 0.0:  # set aside
                continue
            places, gap, area = self._find_reach(die, mesh, position, displacement)
            worst = int(np.argmax(gap))
            found[die.name] = {
                "wall_filled": row[f"{die.name}.fill"],
                "largest_gap_mm": float(gap[worst]),
                "largest_gap_at_mm": [float(x) for x in places[worst]],
                "unfilled_volume_mm3": float((gap * area).sum()),
                "flash_thickness_mm": row[f"{die.name}.flash_thickness"],
            }
        return {"die_fill": found} if found else {}

    def _find_reach(
        self, die: Die, mesh: Mesh, position: FloatArray, displacement: Mapping[str, FloatArray]
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return what metal can reach of a die's wall: places (n, dimension) and gaps (n,) [mm], areas (n,) [mm2].

        Not what lies beyond the axis or a symmetry plane, nor where another tool lies on the wall.
        """
        places = die.places + displacement[die.name]
        is_open = hold_places(self._sides, places)
        for tool in self._model.tools:
            if tool.name != die.name and is_open.any():
                apart = self._measure_distance(tool.name, places[is_open], displacement[tool.name])
                is_open[is_open] = np.abs(apart) > die.tolerance
        places = places[is_open]
        return places, self._find_gaps(mesh, position, places), die.area[is_open]

    def _flash_thickness(self, die: Die, displacement: Mapping[str, FloatArray]) -> float:
        """Return how far the land is from what lies opposite [mm]: twice to a symmetry plane, or to other tools."""
        land = die.land + displacement[die.name]
        if die.plane is not None:
            axis, place = die.plane
            return float(2.0 * np.abs(land[:, axis] - place).min())
        others = [tool.name for tool in self._model.tools if tool.name != die.name]
        apart = (self._measure_distance(name, land, displacement[name]).min() for name in others)
        return float(min(apart, default=np.nan))

    @abstractmethod
    def _find_gaps(self, mesh: Mesh, position: FloatArray, places: FloatArray) -> FloatArray:
        """Return the distance of places (n, dimension) from the metal (n,) [mm]."""

    @abstractmethod
    def _measure_distance(self, tool: str, places: FloatArray, displacement: FloatArray) -> FloatArray:
        """Return how far places (n, dimension) are from a tool (n,) [mm]."""


def _see(run: Observed) -> tuple[Mesh, FloatArray, dict[str, FloatArray]]:
    """Return the mesh, where its nodes are, and how far the tools have moved."""
    return run.model.mesh, run.positions(), run.tool_displacements()


def find_sides(model: Model) -> list[Side]:
    """Return the axis of rotation and the symmetry planes of a model."""
    points, ring = model.mesh.points, model.analysis == "axisymmetric"
    middle = points.mean(axis=0)
    levels = [(axis, 0.0 if ring and axis == 0 else find_held_side(model, axis)) for axis in range(points.shape[1])]
    return [Side(axis, level, float(np.sign(middle[axis] - level))) for axis, level in levels if level is not None]


def hold_places(sides: Iterable[Side], places: FloatArray) -> BoolArray:
    """Return which places (n, dimension) [mm] are on the workpiece's side of all of these."""
    held = np.ones(len(places), dtype=bool)
    for side in sides:
        held &= side.holds(places)
    return held


def find_level(sides: Iterable[Side], axis: int) -> float | None:
    """Return the place of the axis of rotation or of a symmetry plane across an axis [mm]; None without one."""
    return next((side.level for side in sides if side.axis == axis), None)


def list_closing(model: Model, tools: Iterable[Tool]) -> Iterator[tuple[Tool, FloatArray, int]]:
    """Yield the tools that close as dies, with their directions (dimension,) and the axis that these follow."""
    for tool in tools:
        direction = find_closing_direction(model, tool)
        if direction is not None:
            yield tool, direction, int(np.argmax(np.abs(direction)))


def find_closing_direction(model: Model, tool: Tool) -> FloatArray | None:
    """Return the direction in which a tool closes as a die (dimension,), None if it does not close or turns.

    A die that stands closes against the first tool that moves.
    """
    directions = [(other, find_working_direction(model, other)) for other in model.tools if not _turns(model, other)]
    own = next((direction for other, direction in directions if other is tool), None)
    if own is not None or _turns(model, tool):
        return own
    return next((-direction for other, direction in directions if other is not tool and direction is not None), None)


def faces_others(
    model: Model, tool: Tool, land: FloatArray, direction: FloatArray, rims: Mapping[str, FloatArray]
) -> bool:
    """Return whether a die closes on another tool with its flash land, as a container does not on a punch inside it.

    land: places (m, dimension) [mm]; rims: points of the other tools where they begin, by name (n, dimension) [mm]; of
    a tool that is not there nothing is known. A die that moves does so by its own stroke.
    """
    if find_working_direction(model, tool) is not None:
        return True
    across = np.abs(direction) < np.abs(direction).max()
    for other in model.tools:
        if other.name == tool.name:
            continue
        if other.name not in rims:
            return True
        low, high = rims[other.name][:, across].min(axis=0), rims[other.name][:, across].max(axis=0)
        if ((land[:, across] >= low) & (land[:, across] <= high)).all(axis=1).any():
            return True
    return False


def _turns(model: Model, tool: Tool) -> bool:
    return any(tool.name in s.tool_motion and s.tool_motion[tool.name].turn for s in model.stages)


def explain_full_dies(row: Mapping[str, Any]) -> list[str]:
    """Name which dies are full where a run gives up; row: of the history.

    >>> explain_full_dies({"upper.fill": 0.995, "lower.fill": 0.7})
    ['upper is full (99.5 % of its wall): what is left of the stroke would squeeze out flash']
    """
    fills = {name.removesuffix(".fill"): part for name, part in row.items() if name.endswith(".fill")}
    end = "what is left of the stroke would squeeze out flash"
    return [
        f"{name} is full ({100.0 * part:.3g} % of its wall): {end}" for name, part in fills.items() if part >= FULL_DIE
    ]
