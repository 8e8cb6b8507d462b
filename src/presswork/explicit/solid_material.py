# SPDX-License-Identifier: Apache-2.0
"""Materials of solids in explicit dynamics: hardening, strain rate, softening by temperature, adiabatic heating."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork import _core
from presswork.explicit.input_checks import HEAVIEST, ExplicitError
from presswork.model import Hardening, Heating, Rate


@dataclass(frozen=True, kw_only=True)
class SolidMaterial:
    """Von Mises plasticity of a solid in explicit dynamics: stress in MPa, density in t/mm3.

    Without hardening it is elastic. rate: factor on the flow stress. With ludwik's hardening, the rate johnson_cook and
    heating it is Johnson and Cook's law.
    """

    young: float
    poisson: float
    density: float
    hardening: Hardening | None = None
    rate: Rate | None = None
    heating: Heating | None = None

    def __post_init__(self) -> None:
        if not self.young > 0:
            raise ExplicitError(f"young = {self.young}: it must be above zero")
        if not -1 < self.poisson < 0.5:
            raise ExplicitError(f"poisson = {self.poisson}: it must lie between -1 and 0.5")
        if not self.density > 0:
            raise ExplicitError(f"density = {self.density:g}: it must be above zero; steel has 7.85e-9 t/mm3")
        if self.density > HEAVIEST:
            raise ExplicitError(
                f"density = {self.density:g} t/mm3 is beyond any metal: steel has 7.85e-9 t/mm3, not 7850"
            )
        if self.heating:
            check_heating(self.heating)

    @property
    def wave_speed(self) -> float:
        """Speed of elastic compression waves [mm/s]."""
        plane = self.young * (1 - self.poisson) / ((1 + self.poisson) * (1 - 2 * self.poisson))
        return float(np.sqrt(plane / self.density))

    @property
    def start(self) -> float:
        """Temperature at the start [degrees C]."""
        return self.heating.start if self.heating else Heating.start

    def make_mises(self) -> _core.VonMises:
        """Return the compiled law at rest, and at the first temperature."""
        if self.hardening is None:
            return _core.VonMises(self.young, self.poisson, _core.HardeningLaw.linear, [1e3 * self.young, 0.0])
        parameters = [float(p) for p in self.hardening.parameters]
        return _core.VonMises(self.young, self.poisson, _core.HardeningLaw[self.hardening.law], parameters)

    def make_law(self) -> _core.AdiabaticMises:
        """Return the compiled law."""
        mises = self.make_mises()
        rate = _core.RateLaw[self.rate.law] if self.rate else _core.RateLaw.none
        rate_parameters = self.rate.parameters if self.rate else (0.0, 1.0)
        if self.heating is None:
            return _core.AdiabaticMises(mises, rate=rate, rate_parameters=rate_parameters)
        h = self.heating
        return _core.AdiabaticMises(
            mises,
            rate=rate,
            rate_parameters=rate_parameters,
            start=h.start,
            reference=h.reference,
            melting=h.melting,
            exponent=h.exponent,
            heating=h.plastic_fraction / (self.density * h.heat_capacity),
        )


def check_heating(heating: Heating) -> None:
    """Raise ExplicitError for values that no run can start from."""
    h = heating
    if not h.melting > h.reference:
        raise ExplicitError(f"melting = {h.melting}: it must be above reference = {h.reference}")
    if not h.reference <= h.start < h.melting:
        raise ExplicitError(f"start = {h.start}: it must lie from reference up to melting")
    if not h.exponent > 0:
        raise ExplicitError(f"exponent = {h.exponent}: it must be above zero")
    if not h.heat_capacity >= 1e6:
        raise ExplicitError(
            f"heat_capacity = {h.heat_capacity:g} mm2/(s2 K) is below that of any metal: steel has 4.6e8, "
            "a million times the figure in J/(kg K)"
        )
    if not 0 <= h.plastic_fraction <= 1:
        raise ExplicitError(f"plastic_fraction = {h.plastic_fraction}: it must lie between 0 and 1")
