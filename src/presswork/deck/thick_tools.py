# SPDX-License-Identifier: Apache-2.0
"""Rigid shells that touch with their thickness: their face lies half of it from their mesh, on the sheet's side."""

from __future__ import annotations

import numpy as np

from presswork.mesh.checks import MeshError
from presswork.mesh.make.surface_offset import move_surface
from presswork.mesh.triangles import double_areas, find_triangle_parts, find_turned, pair_triangles
from presswork.model import FloatArray, IndexArray, Triangulation

_UPRIGHT = 0.02
"""Part of its area by which a surface must look up or down for its side to be known."""


def move_to_face(points: FloatArray, cells: IndexArray, distance: float, upwards: bool) -> FloatArray:
    """Return points (n, 3) [mm] of a mesh of shells moved by a distance [mm] along their normals, up or down.

    cells: (m, 4), triangles with their last node twice; upwards: whether the sheet lies above. Raises MeshError where
    the shells have no such side, or are bent more tightly than that.
    """
    corners = np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    corners = corners[np.linalg.norm(double_areas(points, corners.astype(np.int32)), axis=1) > 0.0].astype(np.int32)
    edges = pair_triangles(corners)
    n_parts, part = find_triangle_parts(len(corners), edges)
    turned, bad = find_turned(len(corners), edges, part)
    if bad.any():
        raise MeshError("its shells have no two sides", "mend the mesh of the tool")
    corners[turned] = corners[turned][:, ::-1]
    areas = double_areas(points, corners)
    up = np.bincount(part, weights=areas[:, 2], minlength=n_parts)
    whole = np.bincount(part, weights=np.linalg.norm(areas, axis=1), minlength=n_parts)
    if (np.abs(up) < _UPRIGHT * whole).any():
        raise MeshError("its shells are closed or upright: their side towards the sheet is not known", "open them")
    wrong = (up > 0.0) != upwards
    corners[wrong[part]] = corners[wrong[part]][:, ::-1]
    return move_surface(Triangulation(points, corners, False), distance).points
