# SPDX-License-Identifier: Apache-2.0
"""How far dies of facets with a flash land are filled, and how thick the flash is, in space."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from presswork import _core
from presswork.geometry.pose import find_space_pose
from presswork.geometry.tool_surface import make_surface
from presswork.mesh.die_cavity import CavityFacets, find_cavity
from presswork.model import FloatArray, IntArray, Mesh, Model, Triangulation, find_held_side
from presswork.process.recording import Row
from presswork.process.tool_quantities import find_way

TOLERANCE = 0.006
"""Gap that counts as filled, over the root of the wall's area."""


@dataclass(frozen=True)
class _Die:
    name: str
    wall: CavityFacets
    plane: tuple[int, float] | None
    """Axis along which the die closes and the place of a symmetry plane across it [mm], if there is one."""

    @property
    def tolerance(self) -> float:
        """Gap that counts as filled [mm]."""
        return TOLERANCE * float(np.sqrt(self.wall.area.sum()))


class DieFillInSpace:
    """The dies of one model that have a cavity and a flash land."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self._dies: list[_Die] = []
        middle = model.mesh.points.mean(axis=0)
        levels = {axis: find_held_side(model, axis) for axis in range(3)}
        planes = [(a, at, float(np.sign(middle[a] - at))) for a, at in levels.items() if at is not None]
        beside = middle.copy()
        for axis, level, _ in planes:
            beside[axis] = level
        for tool in model.space_tools:
            way = find_way(model, tool)
            turns = any(tool.name in s.tool_motion and s.tool_motion[tool.name].turn for s in model.stages)
            if way is None or turns or not isinstance(tool.surface, Triangulation):
                continue
            points = find_space_pose(tool, np.zeros(3)).carry(tool.surface.points)
            cut = [plane for plane in planes if tool.mirrored_across[plane[0]]]
            wall = find_cavity(points, tool.surface.triangles, way, beside, cut)
            if wall is not None:
                axis = int(np.argmax(np.abs(way)))
                across = levels[axis]
                self._dies.append(_Die(tool.name, wall, None if across is None else (axis, across)))
        self._others = {tool.name: make_surface(tool.surface) for tool in model.space_tools} if self._dies else {}

    @property
    def columns(self) -> list[str]:
        """Of history.csv."""
        return [f"{die.name}.{what}" for die in self._dies for what in ("fill", "flash_thickness")]

    def measure(self, mesh: Mesh, position: FloatArray, displacement: Mapping[str, FloatArray]) -> Row:
        """Return the columns. position: of the nodes (n_points, 3) [mm]; displacement: of the tools (3,) [mm]."""
        row: Row = {}
        for die in self._dies:
            gap, area = self._find_gaps(die, mesh, position, displacement[die.name]), die.wall.area
            row[f"{die.name}.fill"] = float(area[gap <= die.tolerance].sum() / area.sum())
            row[f"{die.name}.flash_thickness"] = self._flash_thickness(die, displacement)
        return row

    def summarise(self, mesh: Mesh, position: FloatArray, displacement: Mapping[str, FloatArray]) -> dict[str, Any]:
        """Return what the summary tells of each die on the metal: fill, largest gap with its place, open volume."""
        row, found = self.measure(mesh, position, displacement), {}
        for die in self._dies:
            gap = self._find_gaps(die, mesh, position, displacement[die.name])
            if row[f"{die.name}.fill"] == 0.0:  # set aside
                continue
            worst = int(np.argmax(gap))
            found[die.name] = {
                "wall_filled": row[f"{die.name}.fill"],
                "largest_gap_mm": float(gap[worst]),
                "largest_gap_at_mm": [float(x) for x in die.wall.places[worst] + displacement[die.name]],
                "unfilled_volume_mm3": float((gap * die.wall.area).sum()),
                "flash_thickness_mm": row[f"{die.name}.flash_thickness"],
            }
        return {"die_fill": found} if found else {}

    def _find_gaps(self, die: _Die, mesh: Mesh, position: FloatArray, moved: FloatArray) -> FloatArray:
        """Return the distance of the wall's pieces from the metal (n,) [mm]."""
        skin = _split(mesh.boundary_faces)
        used, number = np.unique(skin, return_inverse=True)
        surface = _core.ToolSurface.triangles(
            np.ascontiguousarray(position[used]), number.reshape(skin.shape).astype(np.int32)
        )
        return np.abs(surface.nearest(die.wall.places + moved)[0])

    def _flash_thickness(self, die: _Die, displacement: Mapping[str, FloatArray]) -> float:
        """Return how far the land is from what lies opposite [mm]: twice to a symmetry plane, or to other tools."""
        land = die.wall.land + displacement[die.name]
        if die.plane is not None:
            axis, place = die.plane
            return float(2.0 * np.abs(land[:, axis] - place).min())
        gaps = []
        for tool in self._model.space_tools:
            if tool.name != die.name:
                seen = find_space_pose(tool, np.asarray(displacement[tool.name])).to_frame(land)
                gaps.append(float(self._others[tool.name].nearest(np.ascontiguousarray(seen))[0].min()))
        return min(gaps, default=np.nan)


def _split(faces: IntArray) -> IntArray:
    """Return triangles (n, 3) of faces of three or four corners."""
    return faces if faces.shape[1] == 3 else np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
