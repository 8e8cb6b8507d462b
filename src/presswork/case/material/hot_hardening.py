# SPDX-License-Identifier: Apache-2.0
"""Flow stress of strain, strain rate and temperature together: its laws in a case, and the window they are fitted in.

Formulas: docs/theory/material.md.
"""

from __future__ import annotations

import itertools
from typing import Any, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from presswork import _core, model
from presswork.case.heat.quantities import Temperature
from presswork.case.part import Part
from presswork.case.units import ActivationEnergy, Number, Stress, fault
from presswork.law.elastic_plastic import make_sheet_law
from presswork.model import FloatArray

NONE = 0.01
"""Part of the flow stress that is next to none."""
POINTS = 5
"""Strains and rates at each of which a law is tried over its window."""
TEMPERATURES = 33
"""Temperatures at which it is tried there: between them a flow stress may turn."""


class HotLaw(Part):
    """A flow stress of strain, rate and temperature."""

    law: str

    def parameters(self) -> list[float]:
        """Return the parameters in the order of the compiled law."""
        raise NotImplementedError

    def to_model(self) -> model.Hardening:
        """Return the Model's hardening law."""
        return model.Hardening(law=self.law, parameters=np.array(self.parameters()))

    def window(self) -> FloatArray:
        """Return lowest and highest strain, rate [1/s] and temperature [degrees C] (3, 2)."""
        window = self.to_model().window
        assert window is not None
        return window


class FittedLaw(HotLaw):
    """A formula, and the window of the tests that it was fitted to, beyond which it stays as at the end.

    Keys that are no window are the names of the compiled law's parameters.
    """

    strain_window: tuple[Number, Number] = Field(
        description="smallest and largest equivalent plastic strain of the tests"
    )
    rate_window: tuple[Number, Number] = Field(
        description="lowest and highest equivalent plastic strain rate of the tests [1/s]"
    )
    temperature_window: tuple[Temperature, Temperature] = Field(
        description="lowest and highest temperature of the tests [degrees C]"
    )

    def parameters(self) -> list[float]:
        """Return the parameters in the order of the compiled law."""
        ends = {
            f"{name}_{end}": value
            for name in ("strain", "rate", "temperature")
            for end, value in zip(("min", "max"), getattr(self, f"{name}_window"), strict=True)
        }
        names = _core.parameter_names(_core.HardeningLaw[self.law])
        return [float(ends[name] if name in ends else getattr(self, name)) for name in names]

    @model_validator(mode="after")
    def _check_windows(self) -> Self:
        for key in ("strain_window", "rate_window", "temperature_window"):
            low, high = getattr(self, key)
            if not low < high:
                raise fault(f"{low:g} is not below {high:g}", "give the smaller value first", key=key)
        if self.strain_window[0] < 0.0:
            raise fault(
                "a plastic strain is not negative", "give the smallest strain of the tests", key="strain_window"
            )
        if not self.rate_window[0] > 0.0:
            remedy = "give the rate of the slowest test; at rest the law is taken at this rate"
            raise fault("the lowest rate is not above zero", remedy, key="rate_window")
        self._check_window_of_law()
        self._check_stress()
        return self

    def _check_window_of_law(self) -> None:
        """Refuse a window in which the law has no value."""

    def _check_stress(self) -> None:
        """Refuse a law that is no number or not positive, falls with the rate, or rises with temperature, anywhere in
        its window.
        """
        law = make_sheet_law(model.Material("hot", 1e5, 0.3, self.to_model()))
        strains = np.linspace(*self.strain_window, POINTS)
        rates = np.geomspace(*self.rate_window, POINTS)
        degrees = np.linspace(*self.temperature_window, TEMPERATURES)
        grid = np.array(list(itertools.product(strains, degrees, rates)))
        e, t, r = (np.ascontiguousarray(column) for column in grid.T)
        with np.errstate(all="ignore"):
            stress = law.flow_stress(e, r, t)[0].reshape(-1, POINTS)
        e, t, r = (column.reshape(-1, POINTS) for column in (e, t, r))
        bad = ~np.isfinite(stress) | (stress <= 0.0)
        if bad.any():
            i = tuple(np.argwhere(bad)[0])
            place = f"strain {e[i]:g}, {r[i]:g} 1/s and {t[i]:g} degrees C"
            remedy = "check the parameters, their units and the windows"
            raise fault(f"the flow stress is {stress[i]:.4g} MPa at {place}, not > 0", remedy)
        by_strain = stress.reshape(POINTS, -1)
        least, most = float(by_strain[0].min()), float(by_strain[:, by_strain[0].argmin()].max())
        if least < NONE * most:
            text = (
                f"at its smallest strain the flow stress is {least:.2g} MPa, next to nothing of the {most:.4g} later on"
            )
            raise fault(
                text, "raise the smallest strain: with m4 < 0 the flow stress vanishes there", key="strain_window"
            )
        falls = np.diff(stress, axis=1) < -1e-12 * stress[:, :-1]
        if falls.any():
            row, column = np.argwhere(falls)[0]
            first, second = stress[row, column], stress[row, column + 1]
            place = f"strain {e[row, 0]:g} and {t[row, 0]:g} degrees C"
            raise fault(
                f"the flow stress falls from {first:.4g} to {second:.4g} MPa as the rate rises from "
                f"{r[row, column]:.3g} to {r[row, column + 1]:.3g} 1/s, at {place}",
                "check the signs of the terms with the rate; the flow stress must rise with the rate",
            )
        self._check_isotherms(strains, rates, degrees, stress.reshape(POINTS, TEMPERATURES, POINTS))

    def _check_isotherms(self, strains: FloatArray, rates: FloatArray, degrees: FloatArray, stress: FloatArray) -> None:
        """Refuse a flow stress (strains, temperatures, rates) that rises with temperature: isotherms that cross."""
        rises = np.argwhere(np.diff(stress, axis=1) > 1e-12 * stress[:, :-1])
        if not len(rises):
            return
        e, t, r = rises[0]
        raise fault(
            f"the flow stress rises from {stress[e, t, r]:.4g} to {stress[e, t + 1, r]:.4g} MPa as the temperature "
            f"rises from {degrees[t]:.4g} to {degrees[t + 1]:.4g} degrees C, at strain {strains[e]:g} and "
            f"{rates[r]:.3g} 1/s: its isotherms cross",
            "check the signs of the terms with the temperature, or narrow the windows to where it falls",
            key="temperature_window",
        )


class HenselSpittel(FittedLaw):
    """A exp(m1 T) T^m9 e^m2 exp(m4/e) (1 + e)^(m5 T) exp(m7 e) rate^(m3 + m8 T), T in degrees C."""

    law: Literal["hensel_spittel"] = Field(
        default="hensel_spittel", description="hensel_spittel: Hensel and Spittel's law of hot metal"
    )
    A: Stress = Field(gt=0, description="factor of the flow stress [MPa s^m3]")
    m1: Number = Field(description="coefficient of the temperature [1/degree C], about -0.003")
    m2: Number = Field(description="exponent of the strain, for hardening")
    m3: Number = Field(description="exponent of the strain rate, about 0.1")
    m4: Number = Field(description="coefficient of 1/strain, for softening")
    m5: Number = Field(
        default=0.0, description="coefficient of temperature in the exponent of (1 + strain) [1/degree C]"
    )
    m7: Number = Field(default=0.0, description="coefficient of the strain, for softening")
    m8: Number = Field(
        default=0.0, description="coefficient of temperature in the exponent of the strain rate [1/degree C]"
    )
    m9: Number = Field(default=0.0, description="exponent of the temperature; 0 in most fits")

    def _check_window_of_law(self) -> None:
        if (self.m2 != 0.0 or self.m4 != 0.0) and not self.strain_window[0] > 0.0:
            remedy = "give a smallest strain such as 0.01: below it the flow stress is taken as at it"
            raise fault("the law has no value at a strain of zero", remedy, key="strain_window")
        if self.m9 != 0.0 and not self.temperature_window[0] > 0.0:
            raise fault(
                "T^m9 has no value at 0 degrees C and below", "raise the lowest temperature", key="temperature_window"
            )


class NortonHoff(FittedLaw):
    """K (e0 + e)^n rate^m exp(beta/T), T in K."""

    law: Literal["norton_hoff"] = Field(
        default="norton_hoff", description="norton_hoff: Norton and Hoff's law of hot metal"
    )
    K: Stress = Field(gt=0, description="consistency [MPa s^m]")
    e0: Number = Field(default=0.0, ge=0, description="strain before the test begins, e.g. 0.007")
    n: Number = Field(default=0.0, ge=0, le=1, description="hardening exponent, 0 to 1")
    m: Number = Field(gt=0, le=1, description="sensitivity to strain rate")
    beta: Number = Field(default=0.0, ge=0, description="coefficient of 1/temperature [K]")

    def _check_window_of_law(self) -> None:
        if self.n > 0.0 and not self.e0 + self.strain_window[0] > 0.0:
            remedy = "give e0 above zero, or a smallest strain such as 0.01"
            raise fault("the law is zero at a strain of zero", remedy, key="strain_window")


class SinhArrhenius(FittedLaw):
    """asinh((Z/A)^(1/n))/alpha, Z = rate exp(Q/(R T)), T in K: the flow stress at steady state."""

    law: Literal["sinh_arrhenius"] = Field(
        default="sinh_arrhenius", description="sinh_arrhenius: the hyperbolic sine law of hot working"
    )
    A: Number = Field(gt=0, description="factor [1/s]")
    alpha: Number = Field(gt=0, lt=10, description="coefficient of the stress [1/MPa], about 0.01")
    n: Number = Field(gt=0, description="exponent of the sinh, about 5")
    Q: ActivationEnergy = Field(
        ge=1e4, le=2e6, description='activation energy of hot working [J/mol], e.g. "312 kJ/mol"'
    )
    strain_window: tuple[Number, Number] = Field(
        default=(0.0, 10.0), description="smallest and largest strain of the tests; the law does not depend on it"
    )


class JohnsonCookHardening(FittedLaw):
    """(A + B e^n) (1 + C ln(rate/reference_rate)) (1 - T*^m), T* = (T - reference)/(melting - reference)."""

    law: Literal["johnson_cook"] = Field(default="johnson_cook", description="johnson_cook: Johnson and Cook's law")
    A: Stress = Field(gt=0, description="flow stress before hardening [MPa]")
    B: Stress = Field(ge=0, description="hardening coefficient [MPa]")
    n: Number = Field(gt=0, le=1, description="hardening exponent, 0 to 1")
    C: Number = Field(ge=0, description="sensitivity to strain rate")
    reference_rate: Number = Field(gt=0, description="strain rate of A, B and n [1/s]")
    m: Number = Field(gt=0, description="exponent of softening by temperature")
    reference: Temperature = Field(default=20.0, description="temperature of A, B and n [degrees C]")
    melting: Temperature = Field(description="temperature at which no flow stress is left [degrees C]")

    def _check_window_of_law(self) -> None:
        if not self.melting > self.reference:
            raise fault(f"not above reference = {self.reference:g}", "steel melts at 1500 degrees C", key="melting")
        if not self.temperature_window[1] < self.melting:
            remedy = "end the window below it: nothing is left to flow there"
            raise fault(f"it reaches the melting temperature, {self.melting:g}", remedy, key="temperature_window")


def check_heating(data: Any, hardening: object, *, softens: bool) -> None:
    """Refuse keys of heating that the hardening law replaces, or that are missing.

    softens: nothing else depends on temperature.
    """
    if data is None:
        return
    hot = isinstance(hardening, HotLaw)
    for key in ("melting", "exponent"):
        if not hot and getattr(data, key) is None and (softens or data.model_fields_set & {"melting", "exponent"}):
            raise fault("missing key", "steel melts at 1500 degrees C; the exponent is about 1", key=f"heating.{key}")
    for key in ("melting", "exponent", "reference"):
        if hot and key in data.model_fields_set:
            remedy = f"remove it: {getattr(hardening, 'law', '')} softens with temperature by itself"
            raise fault("the flow stress would soften twice", remedy, key=f"heating.{key}")
