# SPDX-License-Identifier: Apache-2.0
"""The wall of a die's cavity in space: the facets that its flash land encloses.

As in the plane (geometry/cavity_wall.py), a flash land is the deepest part of a die along its travel where it lies
across the direction of travel. Without the land's facets the die falls into parts; the cavity is the part in front of
the workpiece.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from presswork.geometry.cavity_wall import ACROSS, LAND
from presswork.mesh.triangles import find_triangle_parts, pair_triangles
from presswork.model import FloatArray, IndexArray, IntArray

PIECES = 60
"""Pieces along a square of the wall's area, at least."""


@dataclass(frozen=True)
class CavityFacets:
    """The wall of a cavity in pieces, where the die is drawn."""

    places: FloatArray
    """Middles of the pieces (n, 3) [mm]."""
    area: FloatArray
    """Area of the pieces (n,) [mm2]."""
    land: FloatArray
    """Middles of the facets of the land (m, 3) [mm]."""


def find_cavity(
    points: FloatArray,
    triangles: IntArray,
    direction: FloatArray,
    middle: FloatArray,
    planes: Sequence[tuple[int, float, float]] = (),
) -> CavityFacets | None:
    """Return the wall of a die's cavity, None where the die has no land, or none that encloses what it presses.

    points (n, 3) [mm], triangles (k, 3): of the die. direction: along which it closes (3,), of length 1. middle:
    of the workpiece (3,) [mm]. planes: symmetry planes, each its axis, its place [mm] and the side of the workpiece,
    1 or -1.
    """
    corners = points[triangles]
    centre = corners.mean(axis=1)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    doubled = np.linalg.norm(normal, axis=1)
    depth = centre @ direction
    across = normal @ direction > np.sqrt(1.0 - ACROSS**2) * doubled
    if not across.any():
        return None
    land = across & (depth > depth[across].max() - LAND * np.ptp(depth))
    rest = np.flatnonzero(~land)
    _, part = find_triangle_parts(len(rest), pair_triangles(triangles[rest]))
    aside = centre[rest] - middle
    aside -= np.outer(aside @ direction, direction)
    own = rest[part == part[np.argmin((aside**2).sum(axis=1))]] if len(rest) else rest
    if not len(own) or _is_open(points, triangles, own, planes):
        return None
    here = np.ones(len(triangles), dtype=bool)
    for axis, level, side in planes:
        here &= side * (centre[:, axis] - level) >= 0.0
    own, lands = own[here[own]], np.flatnonzero(land & here)
    if not len(own) or not len(lands):
        return None
    places, area = _divide(corners[own], np.sqrt(0.5 * doubled[own].sum()) / PIECES)
    return CavityFacets(places, area, centre[lands])


def _is_open(
    points: FloatArray, triangles: IntArray, own: IndexArray, planes: Sequence[tuple[int, float, float]]
) -> bool:
    """Return whether some facets (n,) of a die end at its rim, other than at or beyond symmetry planes."""
    ends = np.sort(np.concatenate([triangles[:, pair] for pair in ([0, 1], [1, 2], [2, 0])]), axis=1)
    edges, first, count = np.unique(ends, axis=0, return_index=True, return_counts=True)
    rim = edges[(count == 1) & np.isin(first % len(triangles), own)]
    tolerance = 1e-6 * float(np.ptp(points, axis=0).max())
    inside = np.ones(len(rim), dtype=bool)
    for axis, level, side in planes:
        inside &= (side * (points[rim, axis] - level) > tolerance).any(axis=1)
    return bool(inside.any())


def _divide(corners: FloatArray, spacing: float) -> tuple[FloatArray, FloatArray]:
    """Return the middles and areas of like triangles with sides below a spacing [mm] that facets (n, 3, 3) hold."""
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    count = np.maximum(np.ceil(sides / spacing).astype(int), 1)
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    whole = 0.5 * np.linalg.norm(np.cross(first, second), axis=1)
    places, areas = [], []
    for n in np.unique(count):
        own = np.flatnonzero(count == n)
        i, j = (grid.ravel() for grid in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
        up, down = i + j < n, i + j < n - 1
        s = np.concatenate([(i[up] + 1 / 3) / n, (i[down] + 2 / 3) / n])
        t = np.concatenate([(j[up] + 1 / 3) / n, (j[down] + 2 / 3) / n])
        at = corners[own, 0, None] + s[:, None] * first[own, None] + t[:, None] * second[own, None]
        places.append(at.reshape(-1, 3))
        areas.append(np.repeat(whole[own] / n**2, n**2))
    return np.concatenate(places), np.concatenate(areas)
