# SPDX-License-Identifier: Apache-2.0
"""What a compensation corrects, and towards what: the sheet as first formed, and where it should come to rest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.geometry.best_fit import nodal_areas
from presswork.geometry.foot_on_triangles import find_feet
from presswork.geometry.rigid_warp import RigidWarp
from presswork.geometry.smooth_extension import extend_smoothly
from presswork.geometry.tool_surface import make_surface
from presswork.model import BoolArray, FloatArray, IntArray
from presswork.post.released_part import Misfit, ReleasedPart, measure_misfit
from presswork.study.compensated_tools import PressedTool

_ON_PART = 0.05
"""Of an edge: a node of the whole sheet nearer to the trimmed part belongs to it."""
_UNDER_HOLDER = 0.3
"""Of the thickness: a node this much farther from the holder's face than half of it is held."""
_BLEND = 12.0
"""Times the thickness: within it of the binder the correction fades."""


@dataclass(frozen=True)
class Goal:
    """The sheet before trimming as the tools as drawn have formed it, and the wanted part."""

    points: FloatArray
    """In the closed tools (n_points, 3) [mm]."""
    triangles: IntArray
    """Shape (n, 3)."""
    is_part: BoolArray
    """Which nodes trimming leaves (n_points,)."""
    is_fixed: BoolArray
    """Which lie on a binder that stays as it is (n_points,)."""
    is_steered: BoolArray
    """Which nodes the correction of the part is taken from (n_points,): the others follow smoothly."""
    wanted: FloatArray
    """Where the nodes of the part should come to rest (n_part, 3) [mm]."""
    weight: FloatArray
    """Area of each node of the part (n_part,) [mm2]."""
    planes: tuple[bool, bool]

    def measure(self, part: ReleasedPart, correction: FloatArray, lower: FloatArray) -> Misfit:
        """Return how far a part from tools corrected by (n_points, 3) [mm] lies off the goal.

        lower: by how much all tools close lower than as drawn (3,) [mm].
        """
        place = (self.points + correction + lower)[self.is_part]
        return measure_misfit(part, place, self.wanted, self.weight, self.planes)

    def spread(self, correction: FloatArray) -> FloatArray:
        """Return the correction (n_points, 3) over part, addendum and binder from that of the part (n_part, 3) [mm]."""
        whole = np.zeros_like(self.points)
        whole[self.is_part] = correction
        whole[self.is_fixed] = 0.0
        return extend_smoothly(whole, self.is_steered | self.is_fixed, self.triangles)

    def make_warp(self, correction: FloatArray) -> RigidWarp:
        """Return the map of space that takes tools along with a correction (n_points, 3) [mm]."""
        return RigidWarp(self.points, self.points + correction, self.planes)


def set_goal(
    part: ReleasedPart,
    whole: tuple[FloatArray, IntArray],
    holders: tuple[PressedTool, ...],
    thickness: float,
    planes: tuple[bool, bool],
) -> Goal:
    """Return the goal of the part as drawn.

    whole: points and triangles of the sheet before trimming. holders: whose binder stays as it is.
    """
    points, triangles = whole
    edge = float(np.median(np.linalg.norm(points[triangles[:, 0]] - points[triangles[:, 1]], axis=1)))
    feet = find_feet(points, part.formed, part.triangles)
    off = np.linalg.norm(feet.interpolate(part.formed, part.triangles) - points, axis=1)
    is_part = off < _ON_PART * edge
    is_fixed = _find_held(points, holders, thickness)
    is_steered = is_part & ~is_fixed
    if is_fixed.any():
        from scipy.spatial import cKDTree

        away, _ = cKDTree(points[is_fixed]).query(points)
        is_steered &= away > _BLEND * thickness
    weight = np.linalg.norm(nodal_areas(points, [triangles]), axis=1)[is_part]
    return Goal(points, triangles, is_part, is_fixed, is_steered, points[is_part], weight, planes)


def _find_held(points: FloatArray, holders: tuple[PressedTool, ...], thickness: float) -> BoolArray:
    """Return which nodes lie under holders, closed."""
    held = np.zeros(len(points), dtype=bool)
    for holder in holders:
        surface = make_surface(holder.shape)
        gap, normal, *_ = surface.nearest(np.ascontiguousarray(points - holder.position - holder.travel), 2 * thickness)
        held |= (gap < (0.5 + _UNDER_HOLDER) * thickness) & (normal[:, 2] < -0.9)
    return held
