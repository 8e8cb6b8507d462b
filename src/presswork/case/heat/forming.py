# SPDX-License-Identifier: Apache-2.0
"""Heat as a body is formed: temperatures, tools that cool it, surroundings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Literal, Self

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from presswork import model
from presswork.case.errors import Problem
from presswork.case.heat.quantities import HeatTransferByPressure, Temperature, to_array
from presswork.case.material.transformation import check_austenite
from presswork.case.material.umat import UmatMaterial
from presswork.case.part import Part
from presswork.case.solid.workpiece import MeshFile
from presswork.case.units import Conductivity, Density, HeatCapacity, HeatTransfer, Length, Number, Point, fault
from presswork.law.elastic_plastic import depends_on_temperature

if TYPE_CHECKING:
    from presswork.case.solid import schema
    from presswork.case.space.schema import SpaceCase


class Surroundings(Part):
    """What takes heat from surfaces that touch no tool and that no boundary entry holds."""

    ambient: Temperature = Field(default=20.0, description="temperature of the surroundings [degrees C]")
    emissivity: Number = Field(default=0.0, ge=0, le=1, description="emissivity of the surface, 0.8 of scale")
    coefficient: HeatTransfer = Field(
        default=0.0, ge=0, description='coefficient of convection [N/(mm s K)], e.g. "10 W/(m^2*K)"'
    )


class ContactHeat(Part):
    """How well heat passes between surfaces in contact, and across a gap."""

    conductance: HeatTransferByPressure = Field(
        description='conductance of the contact [N/(mm s K)], e.g. "10 kW/(m^2*K)", or rows [contact pressure, it]'
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
        default=(), description="instead of depth: the other corners of the block, from one end of the profile round"
    )

    @model_validator(mode="after")
    def _check_one_shape(self) -> Self:
        if self.depth is not None and self.corners:
            raise fault("corners stand beside depth", "give one of them", key="corners")
        return self


class ToolHeat(ContactHeat):
    """The temperature of a tool, and how well heat passes into it."""

    temperature: Temperature = Field(description="temperature of the tool at the start [degrees C]")
    conductivity: Conductivity | None = Field(
        default=None, gt=0, description="of the tool's steel [N/(s K)], by which friction heat is shared"
    )
    specific_heat: HeatCapacity | None = Field(default=None, ge=1e6, description="of the tool's steel")
    density: Density | None = Field(default=None, gt=0, description="of the tool's steel")
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
        given = [key for key in ("conductivity", "specific_heat", "density") if getattr(self, key) is not None]
        if len(given) in (1, 2):
            remedy = "give conductivity, specific_heat and density, or none: friction heat is then halved"
            raise fault("stands without the others", remedy, key=given[0])
        if self.warms_up and not given:
            remedy = "give conductivity, specific_heat and density of its steel"
            raise fault("a tool that warms up needs a steel", remedy, key="warms_up")
        if self.mesh is not None and not given:
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
        description="implicit: largest change of a temperature given to a law in an increment, to which it is cut [K]",
    )


def build_heat(
    case: schema.Case, bodies: tuple[model.Body, ...], dies: Mapping[str, model.DieMesh]
) -> model.Heat | None:
    """Return the Model's heat of a case of forming; bodies: the Model's; dies: meshes of tools by name."""
    if case.heat is None:
        return None
    return make_heat(case, case.heat, bodies, dies)


def make_heat(
    case: schema.Case | SpaceCase, heat: FormingHeat, bodies: tuple[model.Body, ...], dies: Mapping[str, model.DieMesh]
) -> model.Heat:
    """Return the Model's heat in the plane or in space."""
    around, parts = heat.surroundings, [case.workpiece, *case.bodies.values()]
    number = {body.name: i for i, body in enumerate(bodies)}
    initial = [heat.initial_temperature if t is None else t for t in (part.initial_temperature for part in parts)]
    return model.Heat(
        initial=tuple(initial),
        alone=False,
        surroundings=model.Surroundings(around.ambient, around.emissivity, around.coefficient) if around else None,
        tools={
            name: replace(tool.heat.to_model(), die=dies.get(name))
            for name, tool in case.tools.items()
            if tool.heat is not None
        },
        plastic_fraction=heat.plastic_fraction,
        tolerance=heat.tolerance,
        max_change=heat.max_change,
        effusivity=tuple(
            find_effusivity(case.materials[part.material], start) for part, start in zip(parts, initial, strict=True)
        ),
        contacts=tuple(
            model.HeatContact(
                name,
                (number[entry.between[0]], number[entry.between[1]]),
                to_array(entry.heat.conductance) if entry.heat else np.zeros((1, 2)),
                entry.heat.gap if entry.heat else 0.0,
            )
            for name, entry in case.contacts.items()
        ),
    )


def find_effusivity(material: schema.Material | UmatMaterial, temperature: float) -> float:
    """Return the effusivity at a temperature [N/(mm K s^0.5)]."""
    assert material.thermal is not None
    assert material.density is not None
    thermal = material.thermal.to_thermal(material.density)
    at_start = [np.interp(temperature, *table.T) for table in (thermal.conductivity, thermal.specific_heat)]
    return float(np.sqrt(thermal.density * np.prod(at_start)))


def check_heat(case: schema.Case) -> Iterator[Problem]:
    """Yield the problems of heat in forming that show without the mesh."""
    if case.heat is None:
        yield from _check_no_heat(case)
        return
    if case.procedure == "explicit":
        yield from _check_explicit(case)
    if case.solver.displacements == "small":
        yield Problem("heat", "heat in forming is for large displacements", "leave [heat] out")
    parts = {"workpiece": case.workpiece, **{f"bodies.{name}": body for name, body in case.bodies.items()}}
    for name in dict.fromkeys(part.material for part in parts.values()):
        yield from check_material(name, case.materials.get(name))
    for key, part in parts.items():
        start = case.heat.initial_temperature if part.initial_temperature is None else part.initial_temperature
        key = "heat.initial_temperature" if part.initial_temperature is None else f"{key}.initial_temperature"
        material = case.materials.get(part.material)
        heating = material.heating if material is not None and not isinstance(material, UmatMaterial) else None
        melting = heating.melting if heating is not None else None
        if melting is not None and start >= melting:
            fault_text = f"not below the melting temperature of {part.material}, {melting:g} degrees C"
            yield Problem(key, fault_text, "lower it", start)
        steel = getattr(material, "transformation", None)
        if steel is not None:
            yield from check_austenite(steel, key, start)
            if material is not None and material.thermal is not None and material.thermal.latent_heat is not None:
                latent, text = (
                    f"materials.{part.material}.thermal.latent_heat",
                    "the transformation has a latent heat, too",
                )
                yield Problem(latent, text, "remove it, or the transformation")
    for index, stage in enumerate(case.stages):
        if stage.velocity is None and stage.press is None and "duration" not in stage.model_fields_set:
            remedy = "add it, in seconds, or velocity, or press"
            yield Problem(f"stages.{index}.duration", "missing key: heat takes time", remedy)
        if stage.press is not None and stage.press.blows > 1 and stage.press.pause is None:
            yield Problem(f"stages.{index}.press.pause", "missing key: heat takes time", "add it, in seconds")


def _check_explicit(case: schema.Case) -> Iterator[Problem]:
    """Yield what of heat the explicit procedure does not do."""
    fault_text, remedy = "is for the implicit procedure alone, so far", 'leave it out, or set procedure = "implicit"'
    for name, material in case.materials.items():
        if isinstance(material, UmatMaterial):
            umat = "in the explicit procedure a UMAT knows no heat, so far"
            yield Problem(f"materials.{name}.umat", umat, 'give a law of presswork, or set procedure = "implicit"')
    if case.series is not None:
        yield Problem("series", fault_text, remedy)
    if case.heat is not None and "max_change" in case.heat.model_fields_set:
        yield Problem("heat.max_change", "is for the implicit procedure", "take more rows: output.rows")


def _gives_thermal(material: object) -> bool:
    """Say whether the case itself, and not the library, gives thermal properties."""
    return getattr(material, "thermal", None) is not None and getattr(material, "library", None) is None


def _check_no_heat(case: schema.Case) -> Iterator[Problem]:
    """Yield what has a meaning with heat alone."""
    remedy = "add [heat] with initial_temperature, or remove it"
    keys = [f"tools.{name}.heat" for name, tool in case.tools.items() if tool.heat is not None]
    keys += [f"contacts.{name}.heat" for name, contact in case.contacts.items() if contact.heat is not None]
    keys += [f"materials.{name}.thermal" for name, m in case.materials.items() if _gives_thermal(m)]
    keys += [
        f"materials.{name}.transformation" for name, m in case.materials.items() if getattr(m, "transformation", None)
    ]
    keys += ["workpiece.initial_temperature"] if case.workpiece.initial_temperature is not None else []
    keys += [f"bodies.{n}.initial_temperature" for n, b in case.bodies.items() if b.initial_temperature is not None]
    for key in keys:
        yield Problem(key, "has no meaning without [heat]", remedy)


def check_material(name: str, material: schema.Material | UmatMaterial | None) -> Iterator[Problem]:
    """Yield what the material of a body lacks."""
    if material is not None:
        if material.thermal is None:
            remedy = "add it: conductivity and specific_heat of the body"
            yield Problem(f"materials.{name}.thermal", "missing key", remedy)
        if material.density is None:
            yield Problem(f"materials.{name}.density", "missing key", 'add it; steel has "7850 kg/m^3"')
        heating = None if isinstance(material, UmatMaterial) else material.heating
        if heating is not None and heating.heat_capacity is not None:
            fault_text = "plastic work would heat twice: [heat] does so with the specific heat of `thermal`"
            yield Problem(f"materials.{name}.heating.heat_capacity", fault_text, "remove it")
        if heating is not None and heating.start is not None:
            yield Problem(f"materials.{name}.heating.start", "[heat] gives the initial temperature", "remove it")


def start_hot(material: model.Material, heat: FormingHeat | None) -> model.Material:
    """Return a material whose law begins at the initial temperature of the case."""
    if heat is None or not (material.umat is not None or depends_on_temperature(material)):
        return material
    return replace(material, heating=replace(material.heating or model.Heating(), start=heat.initial_temperature))
