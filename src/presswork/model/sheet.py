# SPDX-License-Identifier: Apache-2.0
"""What happens to a stamped sheet beside forming: refinement, trimming, springback."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from presswork.model.arrays import FloatArray


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
class Springback:
    """How the implicit procedure releases the formed part."""

    increments: int = 5
    """Number of increments in which the forces of the tools fade to zero."""
