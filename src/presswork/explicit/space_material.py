# SPDX-License-Identifier: Apache-2.0
"""What solids in space are made of, in explicit dynamics."""

from __future__ import annotations

from dataclasses import dataclass

from presswork import _core
from presswork.evolution.damage import DamageLaw


@dataclass(frozen=True)
class SpaceMaterial:
    """What a block of solids in space is made of."""

    law: _core.VonMises | _core.SolidLaw | _core.Umat
    density: float
    """[t/mm3]"""
    elastic: tuple[float, float] = (0.0, 0.0)
    """Young's modulus [MPa] and Poisson's ratio of a UMAT's first tangent."""
    rolling: tuple[float, float, float] = (1.0, 0.0, 0.0)
    """Unit vector along the law's x."""
    porosity: float | None = None
    """Porosity of a metal with pores at the start."""
    damage: tuple[DamageLaw, ...] = ()
    """Criteria whose damage grows."""
    start: float = 20.0
    """Temperature at the start [degrees C]."""
