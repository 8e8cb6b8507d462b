# SPDX-License-Identifier: Apache-2.0
"""Springback of a section: angles of the wall with bottom and flange, and the radius of its curl."""

from __future__ import annotations

from dataclasses import dataclass

from presswork.geometry.sprung.wall_shape import WallShape, measure_walls
from presswork.post.section import SheetSection, cut_sheet
from presswork.results import Result, ResultError


@dataclass(frozen=True)
class SectionSpringback:
    """A section before and after springback."""

    formed: SheetSection
    free: SheetSection
    walls: tuple[tuple[WallShape, WallShape], ...]
    """Each wall from the beginning of the section outwards, as formed and after springback."""


def find_formed_step(result: Result, step: int = -1) -> int:
    """Return the last step before springback that has the mesh of `step`. Raises ResultError without one."""
    last = step % len(result.times)
    mesh = result.mesh_at(last)
    if "springback" in result.field_names and result.field("springback", last).any():
        for before in range(last - 1, -1, -1):
            if result.mesh_at(before) is not mesh:
                break
            if not result.field("springback", before).any():
                return before
    raise ResultError(f"{result.folder} has no step before and after springback on one mesh")


def measure_springback(
    result: Result, angle: float = 0.0, step: int = -1, *, start: tuple[float, float] = (0.0, 0.0)
) -> SectionSpringback:
    """Measure the walls of the section from `start` (x, y) [mm] at an angle from x [rad], formed and at `step`.

    A wall is a run of pieces of the sheet steeper than 60 degrees as formed, without the radii at its ends. Angles and
    curl radius are those of the draw-bending benchmark (NUMISHEET '93): theta_1, theta_2 and rho. Raises ResultError if
    nothing has sprung back.
    """
    formed = cut_sheet(result, angle, find_formed_step(result, step), start=start)
    free = cut_sheet(result, angle, step, start=start)
    if len(formed.distance) != len(free.distance):
        raise ResultError(f"{result.folder}: the section does not cut the same sheet before and after springback")
    return SectionSpringback(formed, free, measure_walls(formed.line, free.line))
