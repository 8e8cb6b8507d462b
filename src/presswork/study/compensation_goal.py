# SPDX-License-Identifier: Apache-2.0
"""What a compensation corrects, and towards what: the sheet as first formed, and where it should come to rest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.case import CaseError, StampingCase
from presswork.case.errors import Problem
from presswork.geometry.best_fit import nodal_areas
from presswork.geometry.fit_to_surface import SurfaceFit, fit_to_surface
from presswork.geometry.foot_on_triangles import find_feet, split_long
from presswork.geometry.rigid_warp import RigidWarp
from presswork.geometry.smooth_extension import extend_smoothly
from presswork.geometry.tool_surface import make_surface
from presswork.model import BoolArray, FloatArray, IntArray, Triangulation
from presswork.post.released_part import Misfit, ReleasedPart, measure_misfit
from presswork.study.compensated_tools import PressedTool
from presswork.study.curvature_steps import CurvatureSteps, expect_answers

_ON_PART = 0.05
"""Distance of a node of the whole sheet from the trimmed part, over the edge, within which it belongs to the part."""
_UNDER_HOLDER = 0.3
"""Distance of a node from the holder's face beyond half the thickness, over the thickness, within which it is held."""
_BESIDE, _SHARE = 0.05, 0.05
"""Distance beyond which a point of the target lies off the part, over the part's size, and share of such points that
makes it another part."""
_BLEND = 4.0
"""Distance from the binder over the thickness within which the correction fades."""


@dataclass(frozen=True)
class Goal:
    """The sheet before trimming as the tools as drawn have formed it, and the wanted part."""

    points: FloatArray
    """Points in the closed tools (n_points, 3) [mm]."""
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

    def begin_steps(self, thickness: float, strain: FloatArray | None = None) -> CurvatureSteps:
        """Return the search for the correction of what is steered; thickness: of the sheet [mm].

        strain: equivalent plastic strain of the faces at each node (n_points,) [1].
        """
        number = np.cumsum(self.is_steered) - 1
        inside = self.is_steered[self.triangles].all(axis=1)
        weight = self.weight[self.is_steered[self.is_part]]
        cells = number[self.triangles[inside]]
        expected = None if strain is None else expect_answers(strain[self.is_steered])
        return CurvatureSteps(self.points[self.is_steered], cells, weight, self.planes, thickness, expected)

    def advance(self, steps: CurvatureSteps, correction: FloatArray, off: FloatArray) -> FloatArray:
        """Return the next correction (n_points, 3) from one and how far it leaves the part off (n_part, 3) [mm]."""
        part, steered = correction[self.is_part], self.is_steered[self.is_part]
        part[steered] = steps.step(part[steered], off[steered])
        return self.spread(part)

    def make_warp(self, correction: FloatArray) -> RigidWarp:
        """Return the map of space that takes tools along with a correction (n_points, 3) [mm]."""
        return RigidWarp(self.points, self.points + correction, self.planes)


def check_case(case: StampingCase, fix_binder: bool) -> None:
    """Refuse a case without springback, or with more operations than one."""
    problems = []
    if case.operations:
        text = "compensation corrects the tools of one operation"
        problems.append(Problem("operations", text, "give the case of the operation whose tools are to be corrected"))
    elif case.springback is None:
        text = "the case has no springback to correct for"
        problems.append(Problem("springback", text, "add an empty table [springback]"))
    if fix_binder and not any(tool.kind == "holder" for tool in case.tools.values()):
        problems.append(Problem("--fix-binder", "the case has no holder", "leave it out"))
    if problems:
        raise CaseError(problems, case.source)


def set_goal(
    part: ReleasedPart,
    whole: tuple[FloatArray, IntArray],
    holders: tuple[PressedTool, ...],
    thickness: float,
    planes: tuple[bool, bool],
    target: Triangulation | None = None,
) -> Goal:
    """Return the goal of the part as the tools as drawn have formed it.

    whole: points and triangles of the sheet before trimming. holders: whose binder stays as it is. target: a face or
    the middle of the wanted part; None: the part as formed. Raises NotThePartError.
    """
    points, triangles = whole
    edge = float(np.median(np.linalg.norm(points[triangles[:, 0]] - points[triangles[:, 1]], axis=1)))
    feet = find_feet(points, part.formed, part.triangles)
    off = np.linalg.norm(feet.interpolate(part.formed, part.triangles) - points, axis=1)
    is_part = off < _ON_PART * edge
    is_fixed = _find_held(points, holders, thickness)
    weight = np.linalg.norm(nodal_areas(points, [triangles]), axis=1)
    wanted = points
    if target is not None:
        fit = _lay(target, points, triangles, np.where(is_part, weight, 0.0), thickness, planes, edge)
        is_part &= fit.is_over
        wanted = fit.wanted
    is_steered = is_part & ~is_fixed
    if is_fixed.any():
        from scipy.spatial import cKDTree

        away, _ = cKDTree(points[is_fixed]).query(points)
        is_steered &= away > _BLEND * thickness
    return Goal(points, triangles, is_part, is_fixed, is_steered, wanted[is_part], weight[is_part], planes)


class NotThePartError(Exception):
    """The target is not the part that the tools make."""


def _lay(
    target: Triangulation, points: FloatArray, triangles: IntArray, weight: FloatArray, thickness: float,
    planes: tuple[bool, bool], edge: float,
) -> SurfaceFit:  # fmt: skip
    """Lay the target to the part as formed; weight: of nodes (n_points,), 0 of what is trimmed off."""
    surface, cells = split_long(target.points, target.triangles, 2.0 * edge)
    fit = fit_to_surface(points, weight, surface, cells, thickness, planes, _ON_PART * edge)
    folded = fit.surface.copy()
    for axis in (0, 1):
        if planes[axis]:
            side = 1.0 if points[:, axis].mean() > 0 else -1.0
            folded[:, axis] = side * np.abs(folded[:, axis])
    found = find_feet(folded, points, triangles).interpolate(points, triangles)
    far = np.linalg.norm(found - folded, axis=1)
    limit = max(_BESIDE * float(np.linalg.norm(np.ptp(points, axis=0))), 2.0 * thickness)
    if (far > limit).mean() > _SHARE:
        x, y, z = fit.surface[int(np.argmax(far))]
        raise NotThePartError(
            f"{(far > limit).mean():.0%} of the target lie more than {limit:.3g} mm off the part that the tools as "
            f"drawn form, up to {far.max():.3g} mm near ({x:.4g}, {y:.4g}, {z:.4g}): it is another part, or does not "
            "lie as it is pressed, with z up and symmetry planes at x = 0 and y = 0"
        )
    return fit


def _find_held(points: FloatArray, holders: tuple[PressedTool, ...], thickness: float) -> BoolArray:
    """Return which nodes lie under holders, closed."""
    held = np.zeros(len(points), dtype=bool)
    for holder in holders:
        surface = make_surface(holder.shape)
        gap, normal, *_ = surface.nearest(np.ascontiguousarray(points - holder.position - holder.travel), 2 * thickness)
        held |= (gap < (0.5 + _UNDER_HOLDER) * thickness) & (normal[:, 2] < -0.9)
    return held
