# SPDX-License-Identifier: Apache-2.0
"""Heat of a stamping: what the keys go with, and the Model's heat."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from presswork import model
from presswork.case.errors import Problem
from presswork.case.heat.forming_builder import start_hot
from presswork.case.material.transformation import check_austenite
from presswork.case.material.umat import UmatMaterial

if TYPE_CHECKING:
    from presswork.case.stamping.schema import StampingCase


HOTTEST_TOOL = 700.0
"""Temperature beyond which no die steel works [degrees C]."""


def build_sheet_heat(case: StampingCase) -> model.Heat | None:
    """Return the Model's heat of a stamping."""
    if case.heat is None:
        return None
    heat, material = case.heat, case.materials[case.blank.material]
    assert not isinstance(material, UmatMaterial)
    assert material.thermal is not None
    thermal = material.thermal.to_thermal(material.find_density())
    tables = (thermal.conductivity, thermal.specific_heat)
    at_start = [np.interp(heat.initial_temperature, *table.T) for table in tables]
    around = heat.surroundings
    return model.Heat(
        initial=(heat.initial_temperature,),
        alone=False,
        surroundings=model.Surroundings(around.ambient, around.emissivity, around.coefficient) if around else None,
        tools={name: tool.heat.to_model() for name, tool in case.tools.items() if tool.heat is not None},
        plastic_fraction=heat.plastic_fraction,
        effusivity=(float(np.sqrt(thermal.density * np.prod(at_start))),),
        tolerance=heat.tolerance,
        levels=heat.levels,
        max_change=heat.max_change,
    )


def add_heat(material: model.Material, case: StampingCase) -> model.Material:
    """Return a material of the Model with what it conducts, stores and becomes."""
    entry = case.materials[material.name]
    if case.heat is None or isinstance(entry, UmatMaterial) or entry.thermal is None:
        return material
    return replace(
        start_hot(material, case.heat),
        thermal=entry.thermal.to_thermal(entry.find_density()),
        transformation=entry.transformation.to_model() if entry.transformation else None,
    )


def check_sheet_heat(case: StampingCase) -> list[Problem]:
    """Return the problems of heat that show without the mesh."""
    return [*_check_meaning(case)] if case.heat is None else [*_check_material(case), *_check_process(case)]


def _check_meaning(case: StampingCase) -> Iterator[Problem]:
    """Yield what has no meaning without heat."""
    remedy = "add [heat] with initial_temperature, or remove it"
    for name, tool in case.tools.items():
        if tool.heat is not None:
            yield Problem(f"tools.{name}.heat", "has no meaning without [heat]", remedy)
    for name, material in case.materials.items():
        if isinstance(material, UmatMaterial):
            continue
        for key in ("thermal", "transformation"):
            if getattr(material, key) is not None:
                yield Problem(f"materials.{name}.{key}", "has no meaning without [heat]", remedy)
    for index, stage in enumerate(case.stages):
        if stage.dwell is not None:
            yield Problem(f"stages.{index}.dwell", "has no meaning without [heat]", remedy)


def _check_material(case: StampingCase) -> Iterator[Problem]:
    assert case.heat is not None
    name, start = case.blank.material, case.heat.initial_temperature
    material = case.materials.get(name)
    if isinstance(material, UmatMaterial):
        yield Problem(
            f"materials.{name}.umat", "heat in forming is not computed with a UMAT", "give a law of presswork"
        )
        return
    if material is None:
        return
    if material.thermal is None:
        remedy = "add it: conductivity and specific_heat of the sheet"
        yield Problem(f"materials.{name}.thermal", "missing key", remedy)
    heating = material.heating
    if heating is not None and heating.heat_capacity is not None:
        text = "plastic work would heat twice: [heat] does so with the specific heat of `thermal`"
        yield Problem(f"materials.{name}.heating.heat_capacity", text, "remove it")
    if heating is not None and heating.start is not None:
        yield Problem(f"materials.{name}.heating.start", "[heat] gives the initial temperature", "remove it")
    if heating is not None and heating.melting is not None and start >= heating.melting:
        text = f"not below the melting temperature of {name}, {heating.melting:g} degrees C"
        yield Problem("heat.initial_temperature", text, "lower it", start)
    if material.transformation is None:
        return
    if material.thermal is not None and material.thermal.latent_heat is not None:
        text = "the transformation has a latent heat, too"
        yield Problem(f"materials.{name}.thermal.latent_heat", text, "remove it, or the transformation")
    if material.transformation.phases is not None:
        text = "strain and yield stress by phase are for solids"
        yield Problem(f"materials.{name}.transformation.phases", text, "leave it out")
    yield from check_austenite(material.transformation, "heat.initial_temperature", start)


def _check_process(case: StampingCase) -> Iterator[Problem]:
    assert case.heat is not None
    if case.procedure == "explicit" and "max_change" in case.heat.model_fields_set:
        yield Problem("heat.max_change", "is for the implicit procedure", "leave it out")
    if case.blank.refine is not None:
        yield Problem("blank.refine", "temperatures do not pass to split shells", "leave refine or [heat] out")
    for name, tool in case.tools.items():
        if tool.heat is not None and tool.heat.temperature > HOTTEST_TOOL:
            text = f"no die steel works at {tool.heat.temperature:g} degrees C"
            remedy = 'plain numbers are degrees C; with a unit: "348 K"'
            yield Problem(f"tools.{name}.heat.temperature", text, remedy, tool.heat.temperature)
    for index, stage in enumerate(case.stages):
        if stage.dwell is not None:
            present = [
                key
                for key in ("velocity", "duration", "ramp", "process_time", "press")
                if getattr(stage, key) is not None
            ]
            present += [key for key in ("tools", "displacement") if getattr(stage, key)]
            for key in present:
                yield Problem(f"stages.{index}.{key}", "nothing moves in a dwell", "leave it out, or the dwell")
            if index == 0 and stage.dwell.place == "tools":
                text = "no stage before has closed the tools"
                yield Problem(f"stages.{index}.dwell.place", text, 'take place = "air"', "tools")
        elif stage.process_time is None and stage.duration is None and stage.press is None:
            remedy = "give process_time, how long the stage takes in the press; the computation may be faster"
            yield Problem(f"stages.{index}.process_time", "missing key: heat needs a duration", remedy)
