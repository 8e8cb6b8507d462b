# SPDX-License-Identifier: Apache-2.0
"""When and how finely a section of solids in the plane or in axisymmetry is meshed anew in the run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class SizeWindow:
    """A rectangle, fixed in space, in which cells are small."""

    box: tuple[float, float, float, float]
    """Least x, least y, largest x, largest y [mm]."""
    size: float
    """Largest edge length of cells in it [mm]."""


@dataclass(frozen=True)
class Separation:
    """Cracks that are cut into the mesh where the mean damage is critical."""

    size: float | None = None
    """Largest edge of cells where cracks grow [mm]; None: half of the length over which damage is averaged."""


@dataclass(frozen=True)
class Remeshing:
    """Sizes and triggers."""

    size: float
    """Largest edge length of cells [mm]."""
    smallest_size: float
    """[mm]"""
    max_cells: int = 20_000
    """Largest number of cells; where it would be exceeded, all cells become larger."""
    quality: float = 0.2
    """Quality of the worst cell, expected after the next increment, below which a new mesh is made; 1 is a square."""
    every: float = 0.0
    """Fraction of a stage after which it is meshed anew in any case; 0: never."""
    windows: tuple[SizeWindow, ...] = ()
    tool_sizes: tuple[float, ...] = ()
    """Largest edge length of cells on each tool in the plane [mm]; infinite where none is given."""
    error: float = 0.0
    """Part of the stress power that cells may miss, by which their size is chosen; 0: it is not."""
    bodies: Mapping[str, Remeshing] = field(default_factory=dict)
    """Settings of further bodies, by their names; `every` is that of the workpiece for all."""

    def of_body(self, name: str) -> Remeshing:
        """Return the sizes and triggers of a body."""
        return self.bodies.get(name, self)

    keeps_first: bool = False
    """Whether the first mesh of a body stays until an increment fails on it, or a tool cuts deep into its edges."""
    obstacle: str = ""
    """What in the case prevents new meshes, where it has not asked for any; empty if nothing does."""
