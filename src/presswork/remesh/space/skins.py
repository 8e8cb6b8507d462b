# SPDX-License-Identifier: Apache-2.0
"""The skin of a body as its neighbours' new meshes meet it: nodes that touch it come to lie on its faces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork import _core
from presswork.geometry.tool_surface import make_surface
from presswork.model import FloatArray, IndexArray, Triangulation
from presswork.remesh.space.body import FLAT, NewBody, OldBody
from presswork.remesh.space.tetrahedra import list_edges
from presswork.remesh.space.tools import Bends, PlacedTool

DEEPEST = 0.5
"""How far something may have come into a skin, over its mean edge."""


@dataclass(frozen=True)
class Skin:
    """Faces of a body where they are."""

    surface: _core.ToolSurface

    def nearest(self, points: FloatArray, reach: float) -> tuple[FloatArray, FloatArray]:
        """Return the gap of points (n, 3) closer than reach [mm], infinite of others, and the normal there (n, 3)."""
        gap, normal, _, _ = self.surface.nearest(np.ascontiguousarray(points), reach)
        return np.asarray(gap), np.asarray(normal)


def draw_skin(points: FloatArray, faces: IndexArray) -> PlacedTool:
    """Return faces (k, 3) of a body over its points [mm] as something that other bodies lie on; no edge of it counts.

    faces: without those in planes of symmetry, where a node that has come in would be nearest to the plane.
    """
    used, number = np.unique(faces, return_inverse=True)
    shape = Triangulation(np.ascontiguousarray(points[used]), number.reshape(-1, 3).astype(np.int32), is_closed=False)
    none = Bends(np.zeros((0, 2, 3)), np.zeros(0), np.zeros(0))
    return PlacedTool(Skin(make_surface(shape, DEEPEST * mean_edge(points, faces))), none)


def mean_edge(points: FloatArray, faces: IndexArray) -> float:
    """Return the mean length of the edges of faces (k, 3) over points [mm]."""
    ends = points[list_edges(faces)]
    return float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).mean())


def find_outer(old: OldBody, new: OldBody | NewBody) -> IndexArray:
    """Return the faces of a body's old or new mesh that lie in no plane of the old one (k, 3)."""
    flat = np.zeros(len(new.faces), dtype=bool)
    scale = float(np.ptp(old.points, axis=0).max())
    for axis, level, _ in old.planes:
        flat |= (np.abs(new.points[new.faces, axis] - level) < FLAT * scale).all(axis=1)
    return new.faces[~flat]
