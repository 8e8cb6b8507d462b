# SPDX-License-Identifier: Apache-2.0
"""Heat as a body is formed: temperatures, tools that cool it, surroundings."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Self

import numpy as np
from pydantic import Field, model_validator

from presswork import model
from presswork.case.errors import Problem
from presswork.case.heat.quantities import HeatTransferByPressure, Temperature, to_array
from presswork.case.material.umat import UmatMaterial
from presswork.case.part import Part
from presswork.case.units import Conductivity, Density, HeatCapacity, HeatTransfer, Number, fault

if TYPE_CHECKING:
    from presswork.case.solid import schema


class Surroundings(Part):
    """What takes heat from surfaces that touch no tool and that no boundary entry holds."""

    ambient: Temperature = Field(default=20.0, description="temperature of the surroundings [degrees C]")
    emissivity: Number = Field(default=0.0, ge=0, le=1, description="emissivity of the surface, 0.8 of scale")
    coefficient: HeatTransfer = Field(
        default=0.0, ge=0, description='coefficient of convection [N/(mm s K)], e.g. "10 W/(m^2*K)"'
    )


class ToolHeat(Part):
    """The temperature of a tool, and how well heat passes into it."""

    temperature: Temperature = Field(description="temperature of the tool at the start [degrees C]")
    conductance: HeatTransferByPressure = Field(
        description='conductance of the contact [N/(mm s K)], e.g. "10 kW/(m^2*K)", or rows [contact pressure, it]'
    )
    conductivity: Conductivity | None = Field(
        default=None, gt=0, description="of the tool's steel [N/(s K)], by which friction heat is shared"
    )
    specific_heat: HeatCapacity | None = Field(default=None, ge=1e6, description="of the tool's steel")
    density: Density | None = Field(default=None, gt=0, description="of the tool's steel")
    warms_up: bool = Field(
        default=False,
        description="true: the steel behind each node that touches it takes up heat; false: its temperature stays",
    )

    @model_validator(mode="after")
    def _check_steel(self) -> Self:
        given = [key for key in ("conductivity", "specific_heat", "density") if getattr(self, key) is not None]
        if len(given) in (1, 2):
            remedy = "give conductivity, specific_heat and density, or none: friction heat is then halved"
            raise fault("stands without the others", remedy, key=given[0])
        if self.warms_up and not given:
            remedy = "give conductivity, specific_heat and density of its steel"
            raise fault("a tool that warms up needs a steel", remedy, key="warms_up")
        return self

    def to_model(self) -> model.ToolHeat:
        """Return the Model's."""
        if self.conductivity is None or self.specific_heat is None or self.density is None:
            return model.ToolHeat(self.temperature, to_array(self.conductance))
        capacity = self.specific_heat * self.density
        effusivity = float(np.sqrt(self.conductivity * capacity))
        steel = (self.conductivity, capacity) if self.warms_up else None
        return model.ToolHeat(self.temperature, to_array(self.conductance), effusivity, steel)


class FormingHeat(Part):
    """Heat of the workpiece, conducted, and exchanged with tools and surroundings in every increment."""

    initial_temperature: Temperature = Field(description="temperature of the workpiece at the start [degrees C]")
    plastic_fraction: Number = Field(default=0.9, ge=0, le=1, description="part of the plastic work that becomes heat")
    surroundings: Surroundings | None = Field(
        default=None, description="what free surfaces lose heat to; without it they are insulated"
    )


def build_heat(case: schema.Case) -> model.Heat | None:
    """Return the Model's heat of a case of forming."""
    if case.heat is None:
        return None
    heat, material = case.heat, case.materials[case.workpiece.material]
    assert not isinstance(material, UmatMaterial)
    assert material.thermal is not None
    assert material.density is not None
    thermal = material.thermal.to_thermal(material.density)
    tables = (thermal.conductivity, thermal.specific_heat)
    at_start = [np.interp(heat.initial_temperature, *table.T) for table in tables]
    around = heat.surroundings
    return model.Heat(
        initial=(heat.initial_temperature,),
        alone=False,
        surroundings=model.Surroundings(around.ambient, around.emissivity, around.coefficient) if around else None,
        tools={name: tool.heat.to_model() for name, tool in case.tools.items() if tool.heat is not None},
        plastic_fraction=heat.plastic_fraction,
        effusivity=float(np.sqrt(thermal.density * np.prod(at_start))),
    )


def check_heat(case: schema.Case) -> Iterator[Problem]:
    """Yield the problems of heat in forming that show without the mesh."""
    materials = {n: m for n, m in case.materials.items() if not isinstance(m, UmatMaterial)}
    if case.heat is None:
        remedy = "add [heat] with initial_temperature, or remove it"
        for name, tool in case.tools.items():
            if tool.heat is not None:
                yield Problem(f"tools.{name}.heat", "has no meaning without [heat]", remedy)
        for name, material in materials.items():
            if material.thermal is not None:
                yield Problem(f"materials.{name}.thermal", "has no meaning without [heat]", remedy)
        return
    if case.procedure == "explicit":
        yield Problem("heat", "heat is conducted by the implicit procedure alone, so far", "leave [heat] out")
    if case.bodies:
        yield Problem("heat", "heat in forming knows one body, so far", "leave [heat] or [bodies] out")
    if case.solver.displacements == "small":
        yield Problem("heat", "heat in forming is for large displacements", "leave [heat] out")
    name = case.workpiece.material
    piece = case.materials.get(name)
    if isinstance(piece, UmatMaterial):
        yield Problem(f"materials.{name}.umat", "a UMAT knows no heat in forming, so far", "give a law of presswork")
    elif piece is not None:
        if piece.thermal is None:
            remedy = "add it: conductivity and specific_heat of the workpiece"
            yield Problem(f"materials.{name}.thermal", "missing key", remedy)
        if piece.density is None:
            yield Problem(f"materials.{name}.density", "missing key", 'add it; steel has "7850 kg/m^3"')
        heating = piece.heating
        if heating is not None and heating.heat_capacity is not None:
            fault_text = "plastic work would heat twice: [heat] does so with the specific heat of `thermal`"
            yield Problem(f"materials.{name}.heating.heat_capacity", fault_text, "remove it")
        if heating is not None and heating.start is not None:
            yield Problem(f"materials.{name}.heating.start", "[heat] gives the initial temperature", "remove it")
        if heating is not None and case.heat.initial_temperature >= heating.melting:
            fault_text = f"not below the melting temperature of {name}, {heating.melting:g} degrees C"
            yield Problem("heat.initial_temperature", fault_text, "lower it", case.heat.initial_temperature)
    for index, stage in enumerate(case.stages):
        if "duration" not in stage.model_fields_set:
            yield Problem(f"stages.{index}.duration", "missing key: heat takes time", "add it, in seconds")


def start_hot(material: model.Material, heat: FormingHeat | None) -> model.Material:
    """Return a material whose law begins at the initial temperature of the case."""
    if heat is None or material.heating is None:
        return material
    return replace(material, heating=replace(material.heating, start=heat.initial_temperature))
