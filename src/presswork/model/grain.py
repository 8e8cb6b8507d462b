# SPDX-License-Identifier: Apache-2.0
"""Grain size of a material in hot forming: parameters of its laws (docs/theory/microstructure.md)."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class PowerLaw:
    """A d0^grain strain^strain rate^rate exp(energy/(R T)): d0 [um], rate [1/s], energy [J/mol], T in kelvin."""

    A: float
    grain: float = 0.0
    strain: float = 0.0
    rate: float = 0.0
    energy: float = 0.0


@dataclass(frozen=True, kw_only=True)
class DynamicRecrystallisation:
    """Recrystallisation during deformation."""

    critical_strain: PowerLaw
    half_strain: PowerLaw
    """Strain beyond the critical one in which the first half recrystallises."""
    size: PowerLaw
    """Size of the new grains [um]."""
    exponent: float = 2.0


@dataclass(frozen=True, kw_only=True)
class Recrystallisation:
    """Recrystallisation after deformation."""

    half_time: PowerLaw
    """Time in which the first half recrystallises [s]."""
    size: PowerLaw
    """Size of the new grains [um]."""
    exponent: float = 1.0


@dataclass(frozen=True, kw_only=True)
class GrainGrowth:
    """d^exponent grows by A exp(-energy/(R T)) a second: d [um], A [um^exponent/s], energy [J/mol]."""

    A: float
    exponent: float
    energy: float


@dataclass(frozen=True, kw_only=True)
class Grain:
    """Laws of the grain size; those that are None do not act."""

    initial: float
    """Mean grain size at the start [um]."""
    dynamic: DynamicRecrystallisation | None = None
    metadynamic: Recrystallisation | None = None
    static: Recrystallisation | None = None
    growth: GrainGrowth | None = None
    temperature: float | None = None
    """Temperature where the model has none [degrees C]."""
    softens: bool = False
    """Whether what is recrystallised no longer hardens."""
