# SPDX-License-Identifier: Apache-2.0
"""A metal with pores that grow and soften it (docs/theory/damage.md)."""

from __future__ import annotations

from dataclasses import dataclass

GTN = "presswork: gtn"
"""Library of the Umat that a material with pores has: the routine is presswork's own."""


@dataclass(frozen=True, kw_only=True)
class Gtn:
    """Parameters of Gurson, Tvergaard and Needleman's law beside those of the matrix."""

    initial: float
    """Porosity at the start."""
    length: float
    """Radius over which the growth of pores is averaged [mm]."""
    q1: float = 1.5
    q2: float = 1.0
    q3: float = 2.25
    coalescence: float = 1.0
    """Porosity at which pores begin to coalesce; 1: they do not."""
    failure: float = 2.0
    """Porosity at which nothing is left."""
    nucleation_strain: float = 0.0
    """Mean strain at which pores nucleate."""
    nucleation_deviation: float = 0.0
    """Standard deviation of that strain; 0: none nucleate."""
    nucleated: float = 0.0
    """Volume of all pores that may nucleate."""
