# SPDX-License-Identifier: Apache-2.0
"""What heats and cools a surface. Values by time count from the beginning of the stage."""

from __future__ import annotations

from collections.abc import Sequence

from pydantic import Field

from presswork import model
from presswork.case.heat.quantities import HeatFluxByTime, HeatTransferTable, Temperature, TemperatureByTime, to_array
from presswork.case.part import Part
from presswork.case.units import Number


class PrescribedTemperature(Part):
    """Temperature of a node set."""

    set: str = Field(description="name of a node set")
    value: TemperatureByTime = Field(description="temperature [degrees C], or rows [time, temperature]")

    def to_model(self) -> model.PrescribedTemperature:
        """Return the Model's."""
        return model.PrescribedTemperature(self.set, to_array(self.value))


class Flux(Part):
    """A given flux of heat into a surface."""

    set: str = Field(description="name of a set of edges, in space of faces")
    value: HeatFluxByTime = Field(
        description="heat flux [N/(mm s)], which is kW/m^2, positive into the body, or rows [time, flux]"
    )

    def to_model(self) -> model.HeatFlux:
        """Return the Model's."""
        return model.HeatFlux(self.set, to_array(self.value))


class Convection(Part):
    """Heat given to surroundings, in proportion to the difference of temperature."""

    set: str = Field(description="name of a set of edges, in space of faces")
    coefficient: HeatTransferTable = Field(
        description='coefficient of heat transfer [N/(mm s K)], e.g. "2000 W/(m^2*K)", or rows '
        "[temperature of the surface, coefficient]"
    )
    ambient: TemperatureByTime = Field(
        description="temperature of the surroundings [degrees C], or rows [time, temperature]"
    )

    def to_model(self) -> model.Convection:
        """Return the Model's."""
        return model.Convection(self.set, to_array(self.coefficient), to_array(self.ambient))


class FormingConvection(Part):
    """What a zone of a body's surface is cooled by in a stage of forming, in place of [heat.surroundings]."""

    set: str = Field(description="name of a set of edges, in space of faces; boundary is the whole surface")
    coefficient: HeatTransferTable = Field(
        description='coefficient of heat transfer [N/(mm s K)], e.g. "2000 W/(m^2*K)", or rows '
        "[temperature of the surface, coefficient]"
    )
    ambient: Temperature = Field(description="temperature of the medium [degrees C]")

    def to_model(self) -> model.Convection:
        """Return the Model's."""
        ambient = to_array(((0.0, self.ambient),))
        return model.Convection(self.set, to_array(self.coefficient), ambient)


def build_zones(zones: Sequence[FormingConvection]) -> model.HeatStage | None:
    """Return what cools zones in a stage of forming, or None."""
    return model.HeatStage(convections=tuple(zone.to_model() for zone in zones)) if zones else None


class Radiation(Part):
    """Heat radiated to large surroundings."""

    set: str = Field(description="name of a set of edges, in space of faces")
    emissivity: Number = Field(gt=0, le=1, description="emissivity of the surface, 0 to 1; 0.8 for scale")
    ambient: TemperatureByTime = Field(
        description="temperature of the surroundings [degrees C], or rows [time, temperature]"
    )

    def to_model(self) -> model.Radiation:
        """Return the Model's."""
        return model.Radiation(self.set, self.emissivity, to_array(self.ambient))
