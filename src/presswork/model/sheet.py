# SPDX-License-Identifier: Apache-2.0
"""What happens to a stamped sheet beside its tools: pressure, refinement, trimming, springback."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from presswork.model.arrays import FloatArray

Face = Literal["top", "bottom", "inside", "outside"]


@dataclass(frozen=True)
class Refinement:
    """Where the explicit procedure splits shells of the blank in four as it is formed."""

    levels: int
    """How often a shell may be split."""
    angle: float
    """Turn of the sheet to a neighbour, or of a tool along the shell, above which it is split [rad]."""


@dataclass(frozen=True)
class SheetSelfContact:
    """Contact of a stamped sheet with itself, on both faces and with its thickness."""

    mu: float = 0.0
    """Coulomb's coefficient."""


@dataclass(frozen=True)
class PressedRegion:
    """The part of a sheet on one side of a line, drawn on the undeformed sheet and seen along z."""

    polygon: FloatArray
    """Its corners in order (m, 2) [mm]; the last is joined to the first."""
    keep: Literal["inside", "outside"]


@dataclass(frozen=True)
class EnclosedFluid:
    """A fluid in a closed space that the sheet bounds: p = K ln(V_fluid/V_space), never below zero."""

    stiffness: float
    """K [MPa]."""
    room: float
    """Volume of the space before the sheet has moved, of the whole part [mm3]."""


@dataclass(frozen=True)
class SheetPressure:
    """A pressure that pushes one face of a sheet along its normals as they are now."""

    name: str
    face: Face
    """The upper face of the undeformed sheet is pushed down, the lower one up; the inner one of a tube or a vessel
    outwards, the outer one inwards."""
    region: PressedRegion | None = None
    """None: the whole sheet."""
    fluid: EnclosedFluid | None = None
    """None: the stages give the pressure."""
    is_sealed: bool = False
    """Whether it goes beyond its region, up to the first closed ring of contact that presses as much as it does."""


@dataclass(frozen=True)
class Hem:
    """A folded rim that is measured at the end of an operation."""

    outward: tuple[float, float] | None = None
    """Direction in the plan from the panel over the folded edge; None: away from the axis z."""


@dataclass(frozen=True)
class TrimLine:
    """A line that the formed part is cut along, seen along z."""

    name: str
    polygon: FloatArray
    """Its corners in order (m, 2) [mm]; the last is joined to the first."""
    keep: Literal["inside", "outside"]


@dataclass(frozen=True)
class PartSection:
    """A section of a formed part by an upright plane."""

    name: str
    start: tuple[float, float]
    """Where it begins, in the plan of the part in its tools [mm]."""
    angle: float
    """Angle of its direction from x [rad]."""
    length: float = float("inf")
    """Length from the start on [mm]; infinite: on both sides of the start as far as there is sheet."""


@dataclass(frozen=True)
class Gauge:
    """A gauge with the shape of the part in its tools, in which the released part is clamped and measured."""

    clamps: tuple[tuple[float, float], ...]
    """Places of the part in the plan [mm], three at least."""
    points: tuple[tuple[str, tuple[float, float]], ...] = ()
    """Places that are measured, by name [mm]."""


@dataclass(frozen=True)
class Springback:
    """How the implicit procedure releases the formed part, and what is measured of it."""

    increments: int = 5
    """Number of increments in which the forces of the tools fade to zero."""
    sections: tuple[PartSection, ...] = ()
    """None: through the middle of the part, along x and along y."""
    gauge: Gauge | None = None
    """None: the part is measured after the best fit."""
    tolerance: tuple[float, float] | None = None
    """Least and largest deviation that is allowed [mm]."""
