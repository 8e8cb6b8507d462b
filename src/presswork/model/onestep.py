# SPDX-License-Identifier: Apache-2.0
"""The model of the one-step solver: a finished part whose blank is sought.

It is no Model: nothing happens in time, so it has neither stages, tools, supports nor elements to choose.

The part stands in the press's axes: the punch moves along -z, the blank lies in x, y.
"""

from __future__ import annotations

from dataclasses import dataclass

from presswork.model.arrays import FloatArray, IntArray
from presswork.model.material import Material


@dataclass(frozen=True)
class PartBead:
    """A line on the part along which a bead holds the sheet back."""

    points: FloatArray
    """Its corners seen from above (n, 2) [mm]."""
    force: float
    """Force per length [N/mm]."""


@dataclass(frozen=True)
class OneStepModel:
    """A part, its sheet, and what holds the sheet back."""

    title: str
    points: FloatArray
    """Points of the part's mid-surface (n_points, 3) [mm]."""
    triangles: IntArray
    """(n, 3)"""
    quadrilaterals: IntArray
    """(m, 4)"""
    rims: tuple[IntArray, ...]
    """Loops of open edges; the first is the outline."""
    material: Material
    thickness: float
    """Thickness of the blank [mm]."""
    rolling_direction: float
    """Angle from x in the blank [rad]."""
    symmetry: tuple[bool, bool]
    """Whether the planes x = 0 | y = 0 mirror the part."""
    holder_force: float
    """Force of the whole holder [N]."""
    mu: float
    """Coefficient of friction."""
    beads: tuple[PartBead, ...] = ()
    layers: int = 3
    """Points through the thickness; 1: no bending."""
    stages: int = 1
    """Shapes through which the part comes from its blank, itself among them; 1: one step."""
    notes: tuple[str, ...] = ()
    """What was changed in the part's mesh."""
    case_text: str = ""
    """The case file as read, kept with the results."""
