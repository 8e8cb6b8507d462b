# SPDX-License-Identifier: Apache-2.0
"""The case of heating and cooling without forming: furnace, transfer, dwell, quench."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from presswork import model
from presswork.case.case_file import CaseFile
from presswork.case.heat.films import Convection, Flux, PrescribedTemperature, Radiation
from presswork.case.heat.quantities import Temperature
from presswork.case.heat.thermal import Thermal
from presswork.case.material.heating import require_density
from presswork.case.names import Name, Title
from presswork.case.part import Part
from presswork.case.plane.workpiece import MeshFile, Rectangle
from presswork.case.settings import Output
from presswork.case.space.mesh import MadeMesh
from presswork.case.units import Density, HeatTransfer, Length, Number, Time

_HEAT = model.Heat(initial=())
Geometry = Literal["plane", "axisymmetric", "solid"]


class HeatMaterial(Thermal):
    """A material of a case of heat alone."""

    density: Density = Field(gt=0, description='density at the start [t/mm^3], e.g. "7850 kg/m^3"')

    @model_validator(mode="after")
    def _check_density(self) -> Self:
        require_density(self.density)
        return self

    def to_model(self, name: str) -> model.Material:
        """Return the Model's material, which has no strength."""
        return model.Material(name, 0.0, 0.0, None, density=self.density, thermal=self.to_thermal(self.density))


def choose_kind(mesh: object) -> object:
    """Take a mesh without `kind` for a file if it has a path, for a box if its size has three values."""
    if not isinstance(mesh, dict) or "kind" in mesh:
        return mesh
    size = mesh.get("size")
    kind = "box" if isinstance(size, list | tuple) and len(size) == 3 else "rectangle"
    return {"kind": "file" if "path" in mesh else kind, **mesh}


class HeatBody(Part):
    """A body that conducts heat."""

    material: str = Field(description="name of one of the [materials]")
    element: model.HeatElement | None = Field(
        default=None, description="element, of which the cell counts; without it quad4, in space hex8"
    )
    mesh: Annotated[Rectangle | MadeMesh | MeshFile, Field(discriminator="kind"), BeforeValidator(choose_kind)] = Field(
        description="the mesh of the body"
    )
    initial_temperature: Temperature | None = Field(
        default=None, description="temperature at the start [degrees C]; without it that of the case"
    )


class HeatContact(Part):
    """Heat that flows between two bodies where their boundaries lie on each other."""

    between: tuple[str, str] = Field(description="names of the two bodies; the body of the case is called workpiece")
    conductance: HeatTransfer = Field(gt=0, description='conductance [N/(mm s K)], e.g. "10 kW/(m^2*K)"')


class HeatStage(Part):
    """A part of the process; surfaces that no entry names are insulated."""

    name: Name = Field(description="name of the stage")
    duration: Time = Field(gt=0, description="duration [s]")
    temperature: tuple[PrescribedTemperature, ...] = Field(default=(), description="prescribed temperatures")
    flux: tuple[Flux, ...] = Field(default=(), description="surfaces with a given flux of heat")
    convection: tuple[Convection, ...] = Field(default=(), description="surfaces that lose heat by convection")
    radiation: tuple[Radiation, ...] = Field(default=(), description="surfaces that lose heat by radiation")


class HeatSolver(Part):
    """How time steps are chosen."""

    tolerance: Number = Field(
        default=_HEAT.tolerance, gt=0, description="largest error that a time step may add at any node [K]"
    )
    initial_step: Number = Field(
        default=_HEAT.initial_step, gt=0, le=1, description="first step of each stage, over its duration"
    )
    max_step: Number = Field(default=_HEAT.max_step, gt=0, le=1, description="largest step, over the duration")
    fixed_step: Number | None = Field(
        default=None, gt=0, le=1, description="all steps, over the duration, instead of steps by their error"
    )


class HeatCase(CaseFile):
    """A complete case of heat alone. Raises CaseError, with every problem found, when it is not valid."""

    title: Title = Field(description="what the case shows, in one line; it is the title of pictures")
    analysis: Literal["heat"] = Field(description="heat")
    geometry: Geometry = Field(description="plane; axisymmetric, x the radius and y the axis; or solid, in x, y and z")
    depth: Length = Field(default=1.0, gt=0, description="plane: extent normal to the plane [mm]")
    initial_temperature: Temperature = Field(description="temperature of all bodies at the start [degrees C]")
    workpiece: HeatBody = Field(description="the body that is heated or cooled")
    bodies: dict[Name, HeatBody] = Field(default={}, description="further bodies by name")
    contacts: dict[Name, HeatContact] = Field(default={}, description="contacts between bodies by name")
    materials: dict[Name, HeatMaterial] = Field(min_length=1, description="materials by name")
    stages: tuple[HeatStage, ...] = Field(min_length=1, description="the process, stage by stage")
    solver: HeatSolver = Field(default=HeatSolver(), description="how time steps are chosen")
    output: Output = Field(default=Output(), description="what is saved, and when")
