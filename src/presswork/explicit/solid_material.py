# SPDX-License-Identifier: Apache-2.0
"""Materials of solids in explicit dynamics: hardening, strain rate, softening by temperature, adiabatic heating."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork import _core
from presswork.explicit.input_checks import HEAVIEST, ExplicitError
from presswork.law.elastic_plastic import find_heating, make_hardening, make_plane_law
from presswork.law.thermoelastic import largest_young_factor
from presswork.law.umat import open_umat
from presswork.model import (
    Damage,
    FloatArray,
    Gtn,
    Hardening,
    Heating,
    Kinematic,
    Material,
    Rate,
    Thermoelastic,
    Umat,
    YieldFunction,
    never_yield,
)


@dataclass(frozen=True, kw_only=True)
class SolidMaterial:
    """The law of a solid in explicit dynamics: stress in MPa, density in t/mm3.

    Without hardening it is elastic, or that of a UMAT, of whose first tangent young and poisson then are. rate: factor
    on the flow stress. With ludwik's hardening, the rate johnson_cook and heating it is Johnson and Cook's law.
    """

    young: float
    poisson: float
    density: float
    hardening: Hardening | None = None
    rate: Rate | None = None
    heating: Heating | None = None
    yield_function: YieldFunction | None = None
    kinematic: Kinematic | None = None
    young_decrease: tuple[float, float] | None = None
    thermoelastic: Thermoelastic | None = None
    umat: Umat | None = None
    gtn: Gtn | None = None
    damage: Damage | None = None
    rolling_direction: tuple[float, float, float] = (1.0, 0.0, 0.0)

    @classmethod
    def from_model(cls, material: Material) -> SolidMaterial:
        """Return that of a Model's material."""
        names = cls.__dataclass_fields__
        return cls(**{name: getattr(material, name) for name in names})

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
        stiffest = self.young * largest_young_factor(self.thermoelastic)
        plane = stiffest * (1 - self.poisson) / ((1 + self.poisson) * (1 - 2 * self.poisson))
        return float(np.sqrt(plane / self.density))

    @property
    def start(self) -> float:
        """Temperature at the start [degrees C]."""
        return self.heating.start if self.heating else Heating.start

    def make_mises(self) -> _core.VonMises:
        """Return von Mises's law with this hardening, at rest and where nothing softens."""
        return _core.VonMises(self.young, self.poisson, *make_hardening(self._hardening()))

    def make_law(self) -> _core.AdiabaticMises | _core.PlaneLaw | _core.Umat:
        """Return the compiled law: in closed form where there is one, or open the library that has it."""
        if self.umat is not None:
            return open_umat(self.umat)
        general = (self.yield_function, self.kinematic, self.young_decrease, self.thermoelastic)
        if any(general) or self._hardening().is_hot:
            return make_plane_law(self._to_model())
        rate = _core.RateLaw[self.rate.law if self.rate else "none"]
        parameters = self.rate.parameters if self.rate else {}
        h, given = self.heating, {}
        if h is not None:
            melting = h.reference if h.melting is None else h.melting
            given = {"start": h.start, "reference": h.reference, "melting": melting, "exponent": h.exponent}
            given["heating"] = find_heating(self._to_model())
        return _core.AdiabaticMises(self.make_mises(), rate=rate, rate_parameters=parameters, **given)

    def flow_stress(self, eqps: FloatArray, temperature: FloatArray) -> FloatArray:
        """Return the flow stress (n,) [MPa] at rest where nothing softens; of a hot law at temperatures [degrees C]."""
        eqps = np.ascontiguousarray(eqps)
        if self._hardening().is_hot:
            return make_plane_law(self._to_model()).flow_stress(eqps, None, np.ascontiguousarray(temperature))[0]
        return self.make_mises().flow_stress(eqps)[0]

    def _hardening(self) -> Hardening:
        return self.hardening or never_yield(self.young)

    def _to_model(self) -> Material:
        return Material(
            "solid",
            self.young,
            self.poisson,
            self._hardening(),
            yield_function=self.yield_function,
            kinematic=self.kinematic,
            rate=self.rate,
            young_decrease=self.young_decrease,
            thermoelastic=self.thermoelastic,
            density=self.density,
            heating=self.heating,
        )


def check_heating(heating: Heating) -> None:
    """Raise ExplicitError for values that no run can start from."""
    h = heating
    if h.melting is not None and not h.melting > h.reference:
        raise ExplicitError(f"melting = {h.melting}: it must be above reference = {h.reference}")
    if h.melting is not None and not h.reference <= h.start < h.melting:
        raise ExplicitError(f"start = {h.start}: it must lie from reference up to melting")
    if not h.exponent > 0:
        raise ExplicitError(f"exponent = {h.exponent}: it must be above zero")
    if h.heat_capacity is not None and not h.heat_capacity >= 1e6:
        raise ExplicitError(
            f"heat_capacity = {h.heat_capacity:g} mm2/(s2 K) is below that of any metal: steel has 4.6e8, "
            "a million times the figure in J/(kg K)"
        )
    if not 0 <= h.plastic_fraction <= 1:
        raise ExplicitError(f"plastic_fraction = {h.plastic_fraction}: it must lie between 0 and 1")
