# SPDX-License-Identifier: Apache-2.0
"""How far dies are filled in the plane and in axisymmetry."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from presswork import _core
from presswork.geometry.cavity_wall import find_cavity_wall
from presswork.geometry.polygon import measure_distance
from presswork.geometry.pose import start_profile
from presswork.model import FloatArray, Mesh, Model, find_held_side
from presswork.process.die_fill.dies import Die, DieFill, find_way_of_die

TOLERANCE = 0.004
"""Gap that counts as filled, over the length of the cavity's wall."""


class DieFillInPlane(DieFill):
    """The dies whose profile has a cavity and a flash land; none in a model of sheet or of space."""

    def __init__(self, model: Model) -> None:
        super().__init__(model, _find_dies(model))
        self._profiles = {tool.name: start_profile(tool) for tool in model.plane_tools} if self._dies else {}

    def _find_gaps(self, mesh: Mesh, position: FloatArray, places: FloatArray) -> FloatArray:
        edges = mesh.boundary_edges
        order = [[0, 1]] if edges.shape[1] == 2 else [[0, 2], [2, 1]]
        gap: FloatArray = np.min([measure_distance(position[edges[:, pair]], places) for pair in order], axis=0)
        return gap

    def _reach(self, tool: str, land: FloatArray, displacement: FloatArray) -> float:
        return float(_core.touch_profile(self._profiles[tool], np.ascontiguousarray(land - displacement))[0].min())


def _find_dies(model: Model) -> Iterator[Die]:
    middle = model.mesh.points.mean(axis=0) if model.dimension == 2 else np.zeros(2)
    for tool in model.plane_tools:
        way = find_way_of_die(model, tool)
        if way is None:
            continue
        axis = int(np.argmax(np.abs(way)))
        side = _find_plane(model, 1 - axis)
        beside = middle.copy()
        if side is not None:
            beside[1 - axis] = side
        wall = find_cavity_wall(start_profile(tool), way, middle, None if side is None else beside)
        if wall is None:
            continue
        n, ring = len(wall.places), model.analysis == "axisymmetric"
        width = 2.0 * np.pi * np.abs(wall.places[:, 0]) if ring else np.full(n, model.depth)
        plane = _find_plane(model, axis)
        across = None if plane is None else (axis, plane)
        yield Die(tool.name, wall.places, width * wall.piece, wall.land, TOLERANCE * wall.piece * n, across)


def _find_plane(model: Model, axis: int) -> float | None:
    """Return the place of the axis of rotation or of an outermost side that supports hold along an axis [mm]."""
    return 0.0 if model.analysis == "axisymmetric" and axis == 0 else find_held_side(model, axis)
