# SPDX-License-Identifier: Apache-2.0
"""What a tool bears: its body, the part that holds its profile and the rings round it, and how its surface wears."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Side = Literal["bottom", "top", "left", "right"]


@dataclass(frozen=True, kw_only=True)
class Fatigue:
    """Strain amplitude against cycles N: (sigma_f / E) (2N)^b + epsilon_f (2N)^c."""

    strength: float
    """sigma_f [MPa]"""
    strength_exponent: float
    """b, negative."""
    ductility: float
    """epsilon_f"""
    ductility_exponent: float
    """c, negative."""


@dataclass(frozen=True, kw_only=True)
class DieSteel:
    """An elastic material of a die, and what it bears."""

    young: float
    """[MPa]"""
    poisson: float
    yield_stress: float | None = None
    """[MPa]; None: safety against yield is not known."""
    tensile_strength: float | None = None
    """Largest principal stress that a brittle material such as carbide bears [MPa]; None: it is not known."""
    fatigue: Fatigue | None = None
    """None: no life is found."""


@dataclass(frozen=True, kw_only=True)
class DiePart:
    """A part of a die: the one that holds the profile, or a ring."""

    steel: DieSteel
    outer: float | None = None
    """x of its outer side [mm]; None: corners are given."""
    bottom: float | None = None
    """y of its lower face [mm]; None: that of the profile's end, of a ring that of the part inside."""
    top: float | None = None
    """y of its upper face [mm]."""
    corners: tuple[tuple[float, float], ...] = ()
    """Instead of outer, bottom and top: the other corners from one end of the profile round [mm]."""
    held: tuple[Side, ...] = ()
    """Sides whose nodes do not move across them."""
    clamped: tuple[Side, ...] = ()
    """Sides whose nodes do not move at all."""
    interference: float = 0.0
    """How far the part inside is larger in radius than this ring's bore before they are joined [mm]."""


@dataclass(frozen=True)
class DieBody:
    """The body of a tool in parts, from the profile outwards."""

    size: float
    """Size of cells at the profile [mm]."""
    parts: tuple[DiePart, ...]
    """The part that holds the profile, then its rings."""


@dataclass(frozen=True, kw_only=True)
class ToolWear:
    """Wear by Archard: depth = coefficient times the integral of pressure^a / hardness^c over the path slid."""

    coefficient: float
    """Pure number for the powers 1 and 1; otherwise in the powers of MPa that make it so."""
    hardness: tuple[tuple[float, float], ...]
    """Rows of temperature [degrees C] and hardness [MPa]; one row: it is the same at all temperatures."""
    pressure_power: float = 1.0
    """a"""
    hardness_power: float = 1.0
    """c"""
    parts: int = 1
    """Number of parts whose wear is reported."""
    limit: float | None = None
    """Depth that the die may lose [mm]."""
