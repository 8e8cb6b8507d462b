# SPDX-License-Identifier: Apache-2.0
"""How far dies of facets are filled in space."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from presswork import _core
from presswork.geometry.pose import find_space_pose
from presswork.geometry.tool_surface import make_surface
from presswork.mesh.die_cavity import find_cavity
from presswork.model import FloatArray, IntArray, Mesh, Model, Triangulation, find_held_side
from presswork.process.die_fill.dies import Die, DieFill, find_way_of_die

TOLERANCE = 0.006
"""Gap that counts as filled, over the root of the wall's area."""


class DieFillInSpace(DieFill):
    """The dies whose facets have a cavity and a flash land."""

    def __init__(self, model: Model) -> None:
        super().__init__(model, _find_dies(model))
        self._tools = {tool.name: tool for tool in model.space_tools}
        self._surfaces = {tool.name: make_surface(tool.surface) for tool in model.space_tools} if self._dies else {}

    def _find_gaps(self, mesh: Mesh, position: FloatArray, places: FloatArray) -> FloatArray:
        skin = _split(mesh.boundary_faces)
        used, number = np.unique(skin, return_inverse=True)
        surface = _core.ToolSurface.triangles(
            np.ascontiguousarray(position[used]), number.reshape(skin.shape).astype(np.int32)
        )
        gap: FloatArray = surface.nearest(places)[0]
        return np.maximum(gap, 0.0)  # a die that cuts an edge of cells is reached there

    def _reach(self, tool: str, land: FloatArray, displacement: FloatArray) -> float:
        seen = find_space_pose(self._tools[tool], np.asarray(displacement)).to_frame(land)
        return float(self._surfaces[tool].nearest(np.ascontiguousarray(seen))[0].min())


def _find_dies(model: Model) -> Iterator[Die]:
    middle = model.mesh.points.mean(axis=0)
    levels = {axis: find_held_side(model, axis) for axis in range(3)}
    planes = [(a, at, float(np.sign(middle[a] - at))) for a, at in levels.items() if at is not None]
    beside = middle.copy()
    for axis, level, _ in planes:
        beside[axis] = level
    for tool in model.space_tools:
        way = find_way_of_die(model, tool)
        if way is None or not isinstance(tool.surface, Triangulation):
            continue
        points = find_space_pose(tool, np.zeros(3)).carry(tool.surface.points)
        cut = [plane for plane in planes if tool.mirrored_across[plane[0]]]
        wall = find_cavity(points, tool.surface.triangles, way, beside, cut)
        if wall is not None:
            axis = int(np.argmax(np.abs(way)))
            across = levels[axis]
            gap = TOLERANCE * float(np.sqrt(wall.area.sum()))
            yield Die(tool.name, wall.places, wall.area, wall.land, gap, None if across is None else (axis, across))


def _split(faces: IntArray) -> IntArray:
    """Return triangles (n, 3) of faces of three or four corners."""
    return faces if faces.shape[1] == 3 else np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
