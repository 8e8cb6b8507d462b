# SPDX-License-Identifier: Apache-2.0
"""How far dies with a flash land are filled, and how thick the flash is, in the plane and in axisymmetry."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from presswork import _core
from presswork.geometry.cavity_wall import CavityWall, find_cavity_wall
from presswork.geometry.polygon import measure_distance
from presswork.geometry.pose import start_profile
from presswork.model import FloatArray, Mesh, Model, find_held_side
from presswork.process.recording import Row
from presswork.process.tool_quantities import find_way

TOLERANCE = 0.004
"""Gap that counts as filled, over the length of the cavity's wall."""


@dataclass(frozen=True)
class _Die:
    name: str
    wall: CavityWall
    plane: tuple[int, float] | None
    """Axis along which the die closes and the place of a symmetry plane across it [mm], if there is one."""


class DieFill:
    """The dies of one model that have a cavity and a flash land."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self._ring = model.analysis == "axisymmetric"
        self._dies: list[_Die] = []
        middle = model.mesh.points.mean(axis=0) if model.dimension == 2 else np.zeros(2)
        for tool in model.plane_tools:
            way = find_way(model, tool)
            turns = any(tool.name in s.tool_motion and s.tool_motion[tool.name].turn for s in model.stages)
            if way is None or turns:
                continue
            axis = int(np.argmax(np.abs(way)))
            side = _find_plane(model, 1 - axis)
            beside = middle.copy()
            if side is not None:
                beside[1 - axis] = side
            wall = find_cavity_wall(start_profile(tool), way, middle, None if side is None else beside)
            if wall is not None:
                plane = _find_plane(model, axis)
                self._dies.append(_Die(tool.name, wall, None if plane is None else (axis, plane)))

    @property
    def columns(self) -> list[str]:
        """Of history.csv."""
        return [f"{die.name}.{what}" for die in self._dies for what in ("fill", "flash_thickness")]

    def measure(self, mesh: Mesh, position: FloatArray, displacement: Mapping[str, FloatArray]) -> Row:
        """Return the columns. position: of the nodes (n_points, 2) [mm]; displacement: of the tools (2,) [mm]."""
        row: Row = {}
        for die in self._dies:
            gap, weight = self._find_gaps(die, mesh, position, displacement[die.name])
            row[f"{die.name}.fill"] = float(weight[gap <= _tolerance(die)].sum() / weight.sum())
            row[f"{die.name}.flash_thickness"] = self._flash_thickness(die, displacement)
        return row

    def summarise(self, mesh: Mesh, position: FloatArray, displacement: Mapping[str, FloatArray]) -> dict[str, Any]:
        """Return what the summary tells of each die on the metal: fill, largest gap with its place, open volume."""
        row, found = self.measure(mesh, position, displacement), {}
        for die in self._dies:
            gap, weight = self._find_gaps(die, mesh, position, displacement[die.name])
            if row[f"{die.name}.fill"] == 0.0:  # set aside
                continue
            worst = int(np.argmax(gap))
            x, y = die.wall.places[worst] + displacement[die.name]
            found[die.name] = {
                "wall_filled": row[f"{die.name}.fill"],
                "largest_gap_mm": float(gap[worst]),
                "largest_gap_at_mm": [float(x), float(y)],
                "unfilled_volume_mm3": float((gap * weight).sum() * die.wall.piece),
                "flash_thickness_mm": row[f"{die.name}.flash_thickness"],
            }
        return {"die_fill": found} if found else {}

    def _find_gaps(
        self, die: _Die, mesh: Mesh, position: FloatArray, moved: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the distance of the wall's pieces from the metal (n,) [mm], and their areas over their length."""
        places = die.wall.places + moved
        edges = mesh.boundary_edges
        order = [[0, 1]] if edges.shape[1] == 2 else [[0, 2], [2, 1]]
        gap = np.min([measure_distance(position[edges[:, pair]], places) for pair in order], axis=0)
        width = 2.0 * np.pi * np.abs(places[:, 0]) if self._ring else np.full(len(places), self._model.depth)
        return gap, width

    def _flash_thickness(self, die: _Die, displacement: Mapping[str, FloatArray]) -> float:
        """Return how far the land is from what lies opposite [mm]: twice to a symmetry plane, or to other tools."""
        land = die.wall.land + displacement[die.name]
        if die.plane is not None:
            axis, place = die.plane
            return float(2.0 * np.abs(land[:, axis] - place).min())
        gaps = [
            _core.touch_profile(start_profile(tool), np.ascontiguousarray(land - displacement[tool.name]))[0].min()
            for tool in self._model.plane_tools
            if tool.name != die.name
        ]
        return float(min(gaps, default=np.nan))


def _tolerance(die: _Die) -> float:
    return TOLERANCE * die.wall.piece * len(die.wall.places)


def _find_plane(model: Model, axis: int) -> float | None:
    """Return the place of the axis of rotation or of an outermost side that supports hold along an axis [mm]."""
    return 0.0 if model.analysis == "axisymmetric" and axis == 0 else find_held_side(model, axis)
