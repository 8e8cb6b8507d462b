# SPDX-License-Identifier: Apache-2.0
"""How far dies are filled in the plane and in axisymmetry."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from presswork import _core
from presswork.geometry.cavity_wall import find_cavity_wall
from presswork.geometry.polygon import measure_distance
from presswork.geometry.pose import start_profile
from presswork.model import FloatArray, Mesh, Model, find_cell
from presswork.observe.die_fill.dies import (
    Die,
    DieFill,
    faces_others,
    find_level,
    find_sides,
    hold_places,
    list_closing,
)

TOLERANCE = 0.004
"""Gap that counts as filled, over the length of the cavity's wall."""


class DieFillInPlane(DieFill):
    """The dies whose profile has a cavity and a flash land; none in a model of sheet or of space."""

    def __init__(self, model: Model) -> None:
        super().__init__(model, _find_dies(model))
        self._profiles = {tool.name: start_profile(tool) for tool in model.plane_tools} if self._dies else {}

    def _find_gaps(self, mesh: Mesh, position: FloatArray, places: FloatArray) -> FloatArray:
        edges = mesh.boundary_edges
        gap: FloatArray = np.min(
            [measure_distance(position[edges[:, ends]], places) for ends in find_cell(1, edges).pieces], axis=0
        )
        return gap

    def _measure_distance(self, tool: str, places: FloatArray, displacement: FloatArray) -> FloatArray:
        found = _core.touch_profile(self._profiles[tool], np.ascontiguousarray(places - displacement))[0]
        return np.asarray(found)


def _find_dies(model: Model) -> Iterator[Die]:
    if not model.plane_tools or model.separation is not None:
        return
    middle, sides = model.mesh.points.mean(axis=0), find_sides(model)
    profiles = {tool.name: start_profile(tool) for tool in model.plane_tools}
    rims = {name: segments[:, :4].reshape(-1, 2) for name, segments in profiles.items()}
    for tool, direction, axis in list_closing(model, model.plane_tools):
        side, plane = find_level(sides, 1 - axis), find_level(sides, axis)
        beside = middle.copy()
        if side is not None:
            beside[1 - axis] = side
        wall = find_cavity_wall(profiles[tool.name], direction, middle, None if side is None else beside)
        if wall is None or not (plane is not None or faces_others(model, tool, wall.land, direction, rims)):
            continue
        places = wall.places[hold_places([each for each in sides if each.axis != axis], wall.places)]
        n, ring = len(places), model.analysis == "axisymmetric"
        width = 2.0 * np.pi * np.abs(places[:, 0]) if ring else np.full(n, model.depth)
        across = None if plane is None else (axis, plane)
        yield Die(tool.name, places, width * wall.piece, wall.land, TOLERANCE * wall.piece * n, across)
