# SPDX-License-Identifier: Apache-2.0
"""The contract of an evolution law: what becomes of a material point by its stress, strain, rate and temperature.

A law is computed once an increment, after equilibrium is found, on arrays of points. It declares its quantities, each
of which becomes an array of the State and a field of the results. A new law is one file that overrides EvolutionLaw,
and a line in of_material.py.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from presswork.model import FloatArray


@dataclass(frozen=True)
class Quantity:
    """A number that a law keeps at every point."""

    name: str
    """Name of its field, the same for every material."""
    unit: str
    """"1" for a pure number."""
    start: float = 0.0
    """Value at the start of a run; a law may choose another by its parameters."""
    lowest: float = -np.inf
    highest: float = np.inf
    """Bounds, to which values are clipped where a mesh is made anew."""
    label: str = ""
    """Words for pictures; empty: those of the name."""
    shown: bool = True
    """Whether it is a field of the results."""
    peak_counts: bool = False
    """Whether its largest value decides, so that no new mesh may flatten it."""
    all_layers: bool = False
    """Whether a sheet is as bad as its best layer, and all layers of a place have the value of the best."""


@dataclass(frozen=True)
class PointChange:
    """One increment of n points."""

    stress_n: FloatArray
    """Cauchy stress at its start: xx, yy, zz, xy (n, 4), in space also yz, zx (n, 6), in a sheet xx, yy, xy (n, 3)
    [MPa]."""
    stress: FloatArray
    """Stress at its end."""
    eqps_n: FloatArray
    """Equivalent plastic strain at its start (n,)."""
    eqps: FloatArray
    """Equivalent plastic strain at its end."""
    dt: float
    """Time that it takes [s]."""
    temperature_n: FloatArray | None = None
    """Temperature at its start (n,) [degrees C]; None: the model does not know temperatures."""
    temperature: FloatArray | None = None
    """Temperature at its end."""
    back_stress: FloatArray | None = None
    """Back stress at the end in a sheet with kinematic hardening, components as the stress [MPa]; None without."""
    layers: int = 1
    """Points through the thickness of a sheet, one after the other."""
    parts: int = 1
    """Equal parts in which the whole increment is taken; this is one of them."""

    @cached_property
    def strain(self) -> FloatArray:
        """Increment of equivalent plastic strain (n,)."""
        return self.eqps - self.eqps_n

    @cached_property
    def rate(self) -> FloatArray:
        """Equivalent plastic strain rate (n,) [1/s]."""
        return self.strain / self.dt if self.dt > 0.0 else np.zeros_like(self.strain)


class EvolutionLaw:
    """A law of one material."""

    quantities: tuple[Quantity, ...] = ()
    critical: Mapping[str, float] = {}
    """Values of quantities that must not be exceeded, by name: beyond is a crack."""

    follows_time: bool = False
    """Whether the law is a rate equation of time and temperature, so that long increments are taken in parts."""
    softens: bool = False
    """Whether the strain that hardens is `hardening_strain`, which the laws of the stress then go on from."""

    def at_rest(self) -> dict[str, float]:
        """Return the values at the start of a run by name."""
        return {quantity.name: quantity.start for quantity in self.quantities}

    def advance(self, values: Mapping[str, FloatArray], change: PointChange) -> dict[str, FloatArray]:
        """Return the values at the end of an increment (n,) by name; those of its start are not written to."""
        raise NotImplementedError

    def hardening_strain(self, values: Mapping[str, FloatArray]) -> FloatArray:
        """Return the equivalent plastic strain by which a law that softens hardens (n,)."""
        raise NotImplementedError
