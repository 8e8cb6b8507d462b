# SPDX-License-Identifier: Apache-2.0
"""What becomes of a sheet that is stamped, beside its forming: it is refined, trimmed, and springs back."""

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
    """From a shell to its neighbour, or of a tool along it, above which it is split [rad]."""


@dataclass(frozen=True)
class TrimLine:
    """A line that the formed part is cut along, seen along z."""

    name: str
    polygon: FloatArray
    """Its corners in turn (m, 2) [mm], closed by itself."""
    keep: Literal["inside", "outside"]


@dataclass(frozen=True)
class Springback:
    """How the implicit procedure lets the formed part go."""

    increments: int = 5
    """In which the forces of the tools are taken away."""
