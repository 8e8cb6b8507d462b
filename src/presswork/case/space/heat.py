# SPDX-License-Identifier: Apache-2.0
"""Heat of a solid in space as it is formed, and what is checked of it."""

from __future__ import annotations

from collections.abc import Iterator

from presswork import model
from presswork.case.errors import Problem
from presswork.case.heat.forming import check_material, find_effusivity
from presswork.case.material.umat import UmatMaterial
from presswork.case.space.schema import SpaceCase


def build_space_heat(case: SpaceCase) -> model.Heat | None:
    """Return the Model's heat."""
    if case.heat is None:
        return None
    heat, around = case.heat, case.heat.surroundings
    return model.Heat(
        initial=(heat.initial_temperature,),
        alone=False,
        tools={name: tool.heat.to_model() for name, tool in case.tools.items() if tool.heat is not None},
        surroundings=model.Surroundings(around.ambient, around.emissivity, around.coefficient) if around else None,
        plastic_fraction=heat.plastic_fraction,
        tolerance=heat.tolerance,
        max_change=heat.max_change,
        effusivity=(find_effusivity(case.materials[case.workpiece.material], heat.initial_temperature),),
    )


def check_space_heat(case: SpaceCase) -> Iterator[Problem]:
    """Yield the problems of heat that show without the mesh."""
    if case.heat is None:
        remedy = "add [heat] with initial_temperature, or remove it"
        for key in (name for name, given in case.materials.items() if given.thermal is not None):
            yield Problem(f"materials.{key}.thermal", "has no meaning without [heat]", remedy)
        for key in (name for name, tool in case.tools.items() if tool.heat is not None):
            yield Problem(f"tools.{key}.heat", "has no meaning without [heat]", remedy)
        return
    name = case.workpiece.material
    material = case.materials.get(name)
    if isinstance(material, UmatMaterial):
        yield Problem(f"materials.{name}.umat", "in space a UMAT knows no heat, so far", "give a law of presswork")
        return
    if case.workpiece.element == "tet10":
        fault = "tetrahedra of 10 nodes conduct no heat: their corners would have to store less than nothing"
        yield Problem("workpiece.element", fault, "take tet4_mini or hex8_fbar", case.workpiece.element)
    yield from check_material(name, material)
    for key, tool in case.tools.items():
        if tool.heat is not None and tool.heat.mesh is not None:
            fault = "tools have meshes in the plane and in axisymmetry alone, so far"
            yield Problem(f"tools.{key}.heat.mesh", fault, "leave it out; warms_up = true heats the steel behind nodes")
    if case.solver.displacements == "small":
        yield Problem("heat", "heat in forming is for large displacements", "leave [heat] out")
    heating, start = material.heating if material is not None else None, case.heat.initial_temperature
    if heating is not None and heating.melting is not None and start >= heating.melting:
        fault = f"not below the melting temperature of {name}, {heating.melting:g} degrees C"
        yield Problem("heat.initial_temperature", fault, "lower it", start)
    for index, stage in enumerate(case.stages):
        if stage.velocity is None and stage.press is None and "duration" not in stage.model_fields_set:
            remedy = "add it, in seconds, or velocity, or press"
            yield Problem(f"stages.{index}.duration", "missing key: heat takes time", remedy)
        if stage.press is not None and stage.press.blows > 1 and stage.press.pause is None:
            yield Problem(f"stages.{index}.press.pause", "missing key: heat takes time", "add it, in seconds")
