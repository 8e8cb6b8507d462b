# SPDX-License-Identifier: Apache-2.0
"""Heat as a body is formed: temperatures, tools that cool it, surroundings."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal, Self

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from presswork import model
from presswork.case.heat.quantities import HeatTransferByPressure, Temperature, to_array
from presswork.case.part import Part
from presswork.case.plane.workpiece import MeshFile
from presswork.case.units import Conductivity, Density, HeatCapacity, HeatTransfer, Length, Number, Point, fault

if TYPE_CHECKING:
    pass


class Surroundings(Part):
    """What takes heat from surfaces that touch no tool and that no boundary entry holds."""

    ambient: Temperature = Field(default=20.0, description="temperature of the surroundings [degrees C]")
    emissivity: Number = Field(default=0.0, ge=0, le=1, description="emissivity of the surface, 0 to 1; 0.8 for scale")
    coefficient: HeatTransfer = Field(
        default=0.0, ge=0, description='coefficient of convection [N/(mm s K)], e.g. "10 W/(m^2*K)"'
    )


class ContactHeat(Part):
    """How well heat passes between surfaces in contact, and across a gap."""

    conductance: HeatTransferByPressure = Field(
        description='conductance of the contact [N/(mm s K)], e.g. "10 kW/(m^2*K)", or rows [pressure, conductance]'
    )
    gap: Length = Field(
        default=0.0,
        ge=0,
        description="width of a gap across which no more heat passes [mm]; the conductance at no pressure falls evenly "
        "to there; 0: heat passes in contact alone",
    )


def _choose_kind(mesh: object) -> object:
    """Take a mesh without `kind` for a block, unless it names a file."""
    if isinstance(mesh, dict) and "kind" not in mesh:
        return {"kind": "file" if "path" in mesh else "block", **mesh}
    return mesh


class DieBlock(Part):
    """A block of metal behind the profile, meshed by the program; a closed profile is the block itself."""

    kind: Literal["block"] = Field(default="block", description="a block meshed by the program")
    size: Length = Field(gt=0, description="size of cells at the profile; they grow away from it [mm]")
    depth: Length | None = Field(
        default=None,
        gt=0,
        description="metal behind the deepest point of the profile, up to a flat back along x or y [mm]",
    )
    corners: tuple[Point, ...] = Field(
        default=(),
        description="instead of depth: the other corners of the block, from one end of the profile round [mm]",
    )

    @model_validator(mode="after")
    def _check_one_shape(self) -> Self:
        if self.depth is not None and self.corners:
            raise fault("corners and depth are both given", "give one of them", key="corners")
        return self


class ToolHeat(ContactHeat):
    """The temperature of a tool, and how well heat passes into it."""

    temperature: Temperature = Field(description="temperature of the tool at the start [degrees C]")
    conductivity: Conductivity | None = Field(
        default=None,
        gt=0,
        description="conductivity of the tool's steel [N/(s K)], which is W/(m K); it divides the friction heat",
    )
    specific_heat: HeatCapacity | None = Field(
        default=None,
        ge=1e6,
        description='specific heat capacity of the tool\'s steel [mm^2/(s^2 K)], e.g. "460 J/(kg*K)"',
    )
    density: Density | None = Field(
        default=None, gt=0, description='density of the tool\'s steel [t/mm^3], e.g. "7850 kg/m^3"'
    )
    warms_up: bool = Field(
        default=False,
        description="true: the steel behind each node that touches it takes up heat; false: its temperature stays",
    )

    mesh: Annotated[DieBlock | MeshFile, Field(discriminator="kind"), BeforeValidator(_choose_kind)] | None = Field(
        default=None,
        description="the tool's own mesh, in which heat is conducted: size and depth of a block, or path of a file",
    )
    back_temperature: Temperature | None = Field(
        default=None,
        description="temperature at which the back of the mesh is held, in a file the node set back [degrees C]; "
        "without it the back is insulated",
    )

    @model_validator(mode="after")
    def _check_steel(self) -> Self:
        present = [key for key in ("conductivity", "specific_heat", "density") if getattr(self, key) is not None]
        if len(present) in (1, 2):
            remedy = "give conductivity, specific_heat and density, or none: friction heat is then halved"
            raise fault("is given without the others", remedy, key=present[0])
        if self.warms_up and not present:
            remedy = "give conductivity, specific_heat and density of its steel"
            raise fault("a tool that warms up needs a steel", remedy, key="warms_up")
        if self.mesh is not None and not present:
            remedy = "give conductivity, specific_heat and density of its steel"
            raise fault("a tool that conducts heat needs a steel", remedy, key="mesh")
        if self.mesh is not None and self.warms_up:
            raise fault("a tool with a mesh warms up anyway", "leave one of them out", key="warms_up")
        if self.back_temperature is not None and self.mesh is None:
            raise fault("has no meaning without mesh", "add mesh, or remove it", key="back_temperature")
        return self

    def to_model(self) -> model.ToolHeat:
        """Return the Model's."""
        if self.conductivity is None or self.specific_heat is None or self.density is None:
            return model.ToolHeat(self.temperature, to_array(self.conductance), self.gap)
        capacity = self.specific_heat * self.density
        effusivity = float(np.sqrt(self.conductivity * capacity))
        steel = (self.conductivity, capacity) if self.warms_up else None
        # a mesh is made where the tool's profile is known (case.tools.die_mesh)
        return model.ToolHeat(self.temperature, to_array(self.conductance), self.gap, effusivity, steel)


class FormingHeat(Part):
    """Heat of the workpiece, conducted, and exchanged with tools and surroundings in every increment."""

    initial_temperature: Temperature = Field(description="temperature of the workpiece at the start [degrees C]")
    plastic_fraction: Number = Field(default=0.9, ge=0, le=1, description="part of the plastic work that becomes heat")
    tolerance: Number = Field(
        default=2.0,
        gt=0,
        description="largest error that a time step of heat may add at any node, and by which temperatures given to a "
        "law may be off [K]",
    )
    surroundings: Surroundings | None = Field(
        default=None, description="what free surfaces lose heat to; without it they are insulated"
    )
    max_change: Number = Field(
        default=model.Heat.max_change,
        gt=0,
        description="implicit: largest change of a temperature given to a law in an increment, to which it is cut [K]; "
        "without it 15 where phases have strain",
    )
