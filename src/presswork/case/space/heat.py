# SPDX-License-Identifier: Apache-2.0
"""Heat of solids in space as they are formed, and what is checked of it."""

from __future__ import annotations

from collections.abc import Iterator

from presswork import model
from presswork.case.errors import Problem
from presswork.case.heat.forming import FormingHeat
from presswork.case.heat.forming_builder import make_heat
from presswork.case.heat.forming_checks import check_explicit_treatment, check_material, check_steel
from presswork.case.material.umat import UmatMaterial
from presswork.case.space.schema import SpaceCase, SpaceWorkpiece


def build_space_heat(case: SpaceCase, bodies: tuple[model.Body, ...]) -> model.Heat | None:
    """Return the Model's heat; bodies: the Model's."""
    return None if case.heat is None else make_heat(case, case.heat, bodies, {})


def check_space_heat(case: SpaceCase) -> Iterator[Problem]:
    """Yield the problems of heat that show without the mesh."""
    if case.heat is None:
        remedy = "add [heat] with initial_temperature, or remove it"
        for key in (name for name, material in case.materials.items() if material.thermal is not None):
            yield Problem(f"materials.{key}.thermal", "has no meaning without [heat]", remedy)
        steels = [name for name, material in case.materials.items() if getattr(material, "transformation", None)]
        keys = [f"materials.{name}.transformation" for name in steels]
        keys += [f"stages.{index}.convection" for index, stage in enumerate(case.stages) if stage.convection]
        keys += [f"tools.{name}.heat" for name, tool in case.tools.items() if tool.heat is not None]
        keys += [f"contacts.{name}.heat" for name, contact in case.contacts.items() if contact.heat is not None]
        keys += ["workpiece.initial_temperature"] if case.workpiece.initial_temperature is not None else []
        keys += [f"bodies.{n}.initial_temperature" for n, b in case.bodies.items() if b.initial_temperature is not None]
        for key in keys:
            yield Problem(key, "has no meaning without [heat]", remedy)
        return
    parts = {"workpiece": case.workpiece, **{f"bodies.{name}": body for name, body in case.bodies.items()}}
    for key, part in parts.items():
        yield from _check_body(case, case.heat, key, part)
    for name in dict.fromkeys(part.material for part in parts.values()):
        if not isinstance(case.materials.get(name), UmatMaterial):
            yield from check_material(name, case.materials.get(name))
    for key, tool in case.tools.items():
        if tool.heat is not None and tool.heat.mesh is not None:
            fault = "tools have meshes in the plane and in axisymmetry alone"
            yield Problem(f"tools.{key}.heat.mesh", fault, "leave it out; warms_up = true heats the steel behind nodes")
    if case.procedure == "explicit":
        yield from check_explicit_treatment(case)
    if case.solver.displacements == "small":
        yield Problem("heat", "heat in forming is for large displacements", "leave [heat] out")
    for index, stage in enumerate(case.stages):
        if stage.velocity is None and stage.press is None and "duration" not in stage.model_fields_set:
            remedy = "add it, in seconds, or velocity, or press"
            yield Problem(f"stages.{index}.duration", "missing key: heat needs a duration", remedy)
        if stage.press is not None and stage.press.blows > 1 and stage.press.pause is None:
            yield Problem(f"stages.{index}.press.pause", "missing key: heat needs a duration", "add it, in seconds")


def _check_body(case: SpaceCase, heat: FormingHeat, key: str, part: SpaceWorkpiece) -> Iterator[Problem]:
    """Yield what a body lacks to be heated."""
    material = case.materials.get(part.material)
    if isinstance(material, UmatMaterial):
        yield Problem(
            f"materials.{part.material}.umat", "in space heat is not computed with a UMAT", "give a law of presswork"
        )
        return
    if part.element == "tet10":
        fault = "tetrahedra of 10 nodes conduct no heat: their corners would have to store less than nothing"
        yield Problem(f"{key}.element", fault, "take tet4_mini or hex8_fbar", part.element)
    own = part.initial_temperature
    heating, start = (
        material.heating if material is not None else None,
        heat.initial_temperature if own is None else own,
    )
    where = "heat.initial_temperature" if own is None else f"{key}.initial_temperature"
    yield from check_steel(material, part.material, where, start)
    if heating is not None and heating.melting is not None and start >= heating.melting:
        fault = f"not below the melting temperature of {part.material}, {heating.melting:g} degrees C"
        yield Problem(where, fault, "lower it", start)
