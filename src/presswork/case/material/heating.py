# SPDX-License-Identifier: Apache-2.0
"""Temperature of a material: what softens it, and how its own plastic work heats it; and its density."""

from __future__ import annotations

from typing import Self

from pydantic import Field, model_validator

from presswork import model
from presswork.case.part import Part
from presswork.case.units import HeatCapacity, Number, fault

HEAVIEST, LIGHTEST = 1e-6, 1e-10
"""Densities [t/mm3] of no metal: 50 times osmium's, and a sixteenth of magnesium's."""


def require_density(density: float | None) -> None:
    """Refuse the density [t/mm3] of no metal."""
    if density is not None and not LIGHTEST < density < HEAVIEST:
        raise fault(
            f"{density:g} t/mm^3 is the density of no metal",
            'plain numbers are t/mm^3; with a unit: "7850 kg/m^3", which is 7.85e-9',
            key="density",
        )


class Heating(Part):
    """Flow stress times 1 - T*^exponent, T* = (T - reference)/(melting - reference), and heating by plastic work.

    Temperatures are degrees Celsius. Without heat_capacity the temperature stays as it starts. A hardening law that
    depends on temperature itself takes no melting, exponent and reference.
    """

    melting: Number | None = Field(default=None, description="temperature at which no flow stress is left [degrees C]")
    exponent: Number | None = Field(default=None, gt=0, description="exponent of softening by temperature")
    heat_capacity: HeatCapacity | None = Field(
        default=None,
        ge=1e6,
        description='specific heat capacity [mm^2/(s^2 K)], e.g. "460 J/(kg*K)", which is 4.6e8, by which plastic work '
        "heats, without conduction; without it: the temperature stays as it starts",
    )
    plastic_fraction: Number = Field(default=0.9, ge=0, le=1, description="part of the plastic work that becomes heat")
    reference: Number = Field(
        default=20.0, description="temperature of the hardening law, below which nothing softens [degrees C]"
    )
    start: Number | None = Field(
        default=None, description="temperature at the start [degrees C]; without it: the reference"
    )

    @model_validator(mode="after")
    def _check_order(self) -> Self:
        if self.melting is not None and not self.melting > self.reference:
            raise fault(f"not above reference = {self.reference:g}", "steel melts at 1500 degrees C", key="melting")
        if self.melting is not None and self.start is not None and not self.reference <= self.start < self.melting:
            raise fault(
                f"not from reference = {self.reference:g} up to melting = {self.melting:g}", "leave it out", key="start"
            )
        if self.heat_capacity is None and "plastic_fraction" in self.model_fields_set:
            raise fault("has no meaning without heat_capacity", "add it, or remove this key", key="plastic_fraction")
        return self

    def to_model(self) -> model.Heating:
        """Return the Model's heating."""
        start = self.reference if self.start is None else self.start
        values = {name: value for name, value in self.model_dump().items() if value is not None}
        return model.Heating(**{**values, "start": start})
