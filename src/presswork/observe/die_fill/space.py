# SPDX-License-Identifier: Apache-2.0
"""How far dies of facets are filled in space."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from presswork import _core
from presswork.geometry.pose import find_space_pose
from presswork.geometry.tool_surface import make_surface
from presswork.mesh.faces import split_faces
from presswork.mesh.make.die_cavity import find_cavity
from presswork.model import BoolArray, FloatArray, Mesh, Model, Triangulation
from presswork.observe.die_fill.dies import (
    Die,
    DieFill,
    faces_others,
    find_level,
    find_sides,
    hold_places,
    list_closing,
)

TOLERANCE = 0.006
"""Gap that counts as filled, over the root of the wall's area."""


class DieFillInSpace(DieFill):
    """The dies whose facets have a cavity and a flash land."""

    def __init__(self, model: Model) -> None:
        super().__init__(model, _find_dies(model))
        self._tools = {tool.name: tool for tool in model.space_tools}
        self._surfaces = {tool.name: make_surface(tool.surface) for tool in model.space_tools} if self._dies else {}

    def _find_gaps(self, mesh: Mesh, position: FloatArray, places: FloatArray) -> FloatArray:
        skin = split_faces(mesh.boundary_faces)
        used, number = np.unique(skin, return_inverse=True)
        surface = _core.ToolSurface.triangles(
            np.ascontiguousarray(position[used]), number.reshape(skin.shape).astype(np.int32)
        )
        gap: FloatArray = surface.nearest(places)[0]
        return np.maximum(gap, 0.0)  # a die that cuts an edge of cells is reached there

    def _measure_distance(self, tool: str, places: FloatArray, displacement: FloatArray) -> FloatArray:
        seen = find_space_pose(self._tools[tool], np.asarray(displacement)).to_frame(places)
        return np.asarray(self._surfaces[tool].nearest(np.ascontiguousarray(seen))[0])


def _find_dies(model: Model) -> Iterator[Die]:
    middle, sides = model.mesh.points.mean(axis=0), find_sides(model)
    beside = middle.copy()
    for side in sides:
        beside[side.axis] = side.level
    rims = {
        tool.name: find_space_pose(tool, np.zeros(3)).carry(tool.surface.points)
        for tool in model.space_tools
        if isinstance(tool.surface, Triangulation)
    }
    for tool, direction, axis in list_closing(model, model.space_tools):
        if not isinstance(tool.surface, Triangulation):
            continue
        cut = [(side.axis, side.level, side.sign) for side in sides if tool.mirrored_across[side.axis]]
        wall = find_cavity(rims[tool.name], tool.surface.triangles, direction, beside, cut)
        if wall is None:
            continue
        across = find_level(sides, axis)
        if across is None and not faces_others(model, tool, wall.land, direction, rims):
            continue
        here = hold_places([side for side in sides if side.axis != axis], wall.places)
        here &= _in_sector(model, wall.places)
        gap = TOLERANCE * float(np.sqrt(wall.area[here].sum()))
        yield Die(
            tool.name, wall.places[here], wall.area[here], wall.land, gap, None if across is None else (axis, across)
        )


def _in_sector(model: Model, places: FloatArray) -> BoolArray:
    """Return which places (n, 3) [mm] lie between the faces of a sector of cyclic symmetry; all without one."""
    if model.cyclic is None:
        return np.ones(len(places), dtype=bool)
    x, y = model.mesh.points[model.mesh.node_sets[model.cyclic.first], :2].mean(axis=0)
    angle = np.arctan2(places[:, 1], places[:, 0]) - np.arctan2(y, x)
    return np.asarray(angle % (2.0 * np.pi) <= 2.0 * np.pi / model.cyclic.sectors)
