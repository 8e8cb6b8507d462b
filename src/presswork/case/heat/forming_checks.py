# SPDX-License-Identifier: Apache-2.0
"""What is checked of heat in forming before there is a mesh."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from presswork.case.errors import Problem
from presswork.case.material.transformation import check_austenite
from presswork.case.material.umat import UmatMaterial

if TYPE_CHECKING:
    from presswork.case.plane import schema
    from presswork.case.space.schema import SpaceCase, SpaceStage


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
        yield from check_steel(material, part.material, key, start)
    for index, stage in enumerate(case.stages):
        if stage.velocity is None and stage.press is None and "duration" not in stage.model_fields_set:
            remedy = "add it, in seconds, or velocity, or press"
            yield Problem(f"stages.{index}.duration", "missing key: heat needs a duration", remedy)
        if stage.press is not None and stage.press.blows > 1 and stage.press.pause is None:
            yield Problem(f"stages.{index}.press.pause", "missing key: heat needs a duration", "add it, in seconds")


def _check_explicit(case: schema.Case) -> Iterator[Problem]:
    """Yield what of heat the explicit procedure does not do."""
    fault_text, remedy = "is for the implicit procedure alone", 'leave it out, or set procedure = "implicit"'
    for name, material in case.materials.items():
        if isinstance(material, UmatMaterial):
            umat = "the explicit procedure computes no heat with a UMAT"
            yield Problem(f"materials.{name}.umat", umat, 'give a law of presswork, or set procedure = "implicit"')
    if case.series is not None:
        yield Problem("series", fault_text, remedy)
    yield from check_explicit_treatment(case)
    if case.heat is not None and "max_change" in case.heat.model_fields_set:
        yield Problem("heat.max_change", "is for the implicit procedure", "take more rows: output.rows")


def check_explicit_treatment(case: schema.Case | SpaceCase) -> Iterator[Problem]:
    """Yield what of heat treatment the explicit procedure does not do."""
    fault_text, remedy = "is for the implicit procedure alone", 'leave it out, or set procedure = "implicit"'
    for name, material in case.materials.items():
        steel = getattr(material, "transformation", None)
        if steel is not None and steel.phases is not None:
            yield Problem(f"materials.{name}.transformation.phases", fault_text, remedy)
    stages: Sequence[schema.Stage | SpaceStage] = case.stages
    for index, stage in enumerate(stages):
        if stage.convection:
            yield Problem(f"stages.{index}.convection", fault_text, remedy)


def check_steel(material: object, name: str, key: str, start: float) -> Iterator[Problem]:
    """Yield the problems of a body's transformation; key: of the temperature at its start [degrees C]."""
    steel, thermal = getattr(material, "transformation", None), getattr(material, "thermal", None)
    if steel is None:
        return
    yield from check_austenite(steel, key, start)
    if thermal is not None and thermal.latent_heat is not None:
        latent = f"materials.{name}.thermal.latent_heat"
        yield Problem(latent, "the transformation has a latent heat, too", "remove it, or the transformation")


def _has_thermal(material: object) -> bool:
    """Return whether the case itself gives thermal properties; those of the library do not count."""
    return getattr(material, "thermal", None) is not None and getattr(material, "library", None) is None


def _check_no_heat(case: schema.Case) -> Iterator[Problem]:
    """Yield what has a meaning with heat alone."""
    remedy = "add [heat] with initial_temperature, or remove it"
    keys = [f"tools.{name}.heat" for name, tool in case.tools.items() if tool.heat is not None]
    keys += [f"contacts.{name}.heat" for name, contact in case.contacts.items() if contact.heat is not None]
    keys += [f"materials.{name}.thermal" for name, m in case.materials.items() if _has_thermal(m)]
    keys += [
        f"materials.{name}.transformation" for name, m in case.materials.items() if getattr(m, "transformation", None)
    ]
    keys += [f"stages.{index}.convection" for index, stage in enumerate(case.stages) if stage.convection]
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
