# SPDX-License-Identifier: Apache-2.0
"""How far opposite walls of a tool lie apart: across its ridges, and across the slots that metal flows into.

The width at a place of the tool is the diameter of the largest ball that touches it there and does not cross the tool's
surface (medial axis; Ma, Bae & Choi 2012, The Visual Computer 28: "3D medial axis point approximation using nearest
neighbors and the normal field"), on the one side of the surface or on the other. It counts where the ball touches the
surface a second time at a wall with the opposite normal: balls beside an edge touch the next face instead.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from presswork import _core
from presswork.geometry.pose import SpacePose
from presswork.geometry.tool_surface import make_surface
from presswork.model import BoolArray, FloatArray, Triangulation

MOST_PLACES = 20_000
"""Largest number of places at which widths are measured; on larger tools these lie farther apart than requested."""
OPPOSITE = 0.75
"""Least cosine between the normals of opposite walls, one of them reversed: drafts of up to 20 degrees."""
_STEPS = (0.7548776662466927, 0.5698402909980532)
_HALVINGS, _EXACT, _BEYOND = 8, 1e-3, 0.02


@dataclass(frozen=True)
class Widths:
    """Widths of a tool where they are small."""

    place: FloatArray
    """Places on both walls (n, 3) [mm]."""
    width: FloatArray
    """(n,) [mm]."""
    is_ridge: BoolArray
    """Whether the tool lies between the walls, or free space (n,)."""

    def carry(self, pose: SpacePose) -> Widths:
        """Return the widths where the tool stands."""
        return replace(self, place=pose.carry(self.place))


NO_WIDTHS = Widths(np.zeros((0, 3)), np.zeros(0), np.zeros(0, dtype=bool))


def find_widths(shape: Triangulation, widest: float, spacing: float) -> Widths:
    """Return the widths below the widest one [mm] of a tool, at places a spacing [mm] apart, in its own frame."""
    place, normal = spread_places(shape, spacing)
    surface = make_surface(shape)
    found: list[tuple[FloatArray, FloatArray, BoolArray]] = []
    for side in (-1.0, 1.0):
        radius, meets = _grow_balls(surface, place, side * normal, 0.5 * widest)
        facing = meets & (
            np.einsum("ni,ni->n", _look_beyond(surface, place, side * normal, radius), normal) < -OPPOSITE
        )
        found.append((place[facing], 2.0 * radius[facing], np.full(int(facing.sum()), side < 0.0)))
    places, widths, ridges = zip(*found, strict=True)
    return Widths(np.concatenate(places), np.concatenate(widths), np.concatenate(ridges))


def spread_places(shape: Triangulation, spacing: float) -> tuple[FloatArray, FloatArray]:
    """Return places about a spacing [mm] apart on triangles, and the normals there, each (n, 3).

    In a triangle they follow the additive sequence R2 (Roberts 2018), the first in its middle. Small triangles with
    about the same normal share one place.
    """
    corners = shape.points[shape.triangles]
    doubled = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = 0.5 * np.linalg.norm(doubled, axis=1)
    spacing = max(spacing, float(np.sqrt(area.sum() / MOST_PLACES)))
    count = np.ceil(area / spacing**2).astype(int)
    owner = np.repeat(np.arange(len(area)), count)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
    b, c = ((1.0 / 3.0 + number * step) % 1.0 for step in _STEPS)
    outside = b + c > 1.0
    b, c = np.where(outside, 1.0 - b, b), np.where(outside, 1.0 - c, c)
    place = np.einsum("ns,nsi->ni", np.stack([1.0 - b - c, b, c], axis=1), corners[owner])
    normal = doubled[owner] / (2.0 * area[owner, None])
    key = np.concatenate([np.floor(place / spacing), np.round(normal)], axis=1).astype(np.int64)
    first = np.sort(np.unique(key, axis=0, return_index=True)[1])
    return np.ascontiguousarray(place[first]), np.ascontiguousarray(normal[first])


def _grow_balls(
    surface: _core.ToolSurface, place: FloatArray, direction: FloatArray, largest: float
) -> tuple[FloatArray, BoolArray]:
    """Return the radii (n,) [mm] of the largest balls that touch places from the side of a direction (n, 3), and which
    of them meet the surface before they have the largest radius (n,)."""
    low, high = np.zeros(len(place)), np.full(len(place), largest)
    fits = _fits(surface, place, direction, high)
    meets = ~fits
    for _ in range(_HALVINGS):
        middle = 0.5 * (low[meets] + high[meets])
        fits = _fits(surface, place[meets], direction[meets], middle)
        low[meets], high[meets] = np.where(fits, middle, low[meets]), np.where(fits, high[meets], middle)
    return 0.5 * (low + high), meets


def _fits(surface: _core.ToolSurface, place: FloatArray, direction: FloatArray, radius: FloatArray) -> BoolArray:
    """Return whether balls do not cross the surface."""
    gap, *_ = surface.nearest(np.ascontiguousarray(place + radius[:, None] * direction), np.inf)
    return np.abs(gap) > (1.0 - _EXACT) * radius


def _look_beyond(
    surface: _core.ToolSurface, place: FloatArray, direction: FloatArray, radius: FloatArray
) -> FloatArray:
    """Return the normals (n, 3) where balls a little larger than these touch the surface: on the other side."""
    _, normal, *_ = surface.nearest(np.ascontiguousarray(place + (1.0 + _BEYOND) * radius[:, None] * direction), np.inf)
    return np.asarray(normal)
