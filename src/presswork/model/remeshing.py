# SPDX-License-Identifier: Apache-2.0
"""When and how finely a section of solids in the plane or in axisymmetry is meshed anew in the run."""

from __future__ import annotations

from dataclasses import dataclass


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
