# SPDX-License-Identifier: Apache-2.0
"""What a material conducts and stores."""

from __future__ import annotations

from typing import Self

from pydantic import Field, model_validator

from presswork import model
from presswork.case.heat.quantities import ConductivityTable, SpecificHeatTable, Temperature, to_array
from presswork.case.part import Part
from presswork.case.units import HeatOfMass, fault


class LatentHeat(Part):
    """Heat that a transformation takes up on heating and gives back on cooling, evenly between two temperatures."""

    heat: HeatOfMass = Field(gt=0, description='heat per mass [mm^2/s^2], e.g. "270 kJ/kg"')
    start: Temperature = Field(description="temperature at which it begins on heating [degrees C]")
    end: Temperature = Field(description="temperature at which it is over [degrees C]")

    @model_validator(mode="after")
    def _check_order(self) -> Self:
        if not self.end > self.start:
            raise fault(f"not above start = {self.start:g}", "give the interval of the transformation", key="end")
        return self


class Thermal(Part):
    """Thermal properties; each a value, or rows [temperature, value] between which it is linear."""

    conductivity: ConductivityTable = Field(
        description='thermal conductivity [N/(s K)], which is W/(m K); e.g. 30, or rows [degrees C, "30 W/(m*K)"]'
    )
    specific_heat: SpecificHeatTable = Field(
        description='specific heat capacity [mm^2/(s^2 K)], e.g. "650 J/(kg*K)", or rows [degrees C, value]'
    )
    latent_heat: LatentHeat | None = Field(default=None, description="of a transformation, beside the specific heat")

    def to_thermal(self, density: float) -> model.Thermal:
        """Return the Model's thermal properties. density [t/mm3]."""
        latent = self.latent_heat
        return model.Thermal(
            density=density,
            conductivity=to_array(self.conductivity),
            specific_heat=to_array(self.specific_heat),
            latent_heat=latent.heat if latent else 0.0,
            transformation=(latent.start, latent.end) if latent else (0.0, 1.0),
        )
