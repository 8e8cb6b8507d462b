# SPDX-License-Identifier: Apache-2.0
"""Turns the keys of heat in forming into the Model's heat."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from presswork import model
from presswork.case.heat.forming import FormingHeat
from presswork.case.heat.quantities import to_array
from presswork.case.material.umat import UmatMaterial
from presswork.law.elastic_plastic import depends_on_temperature

WITH_PHASES = 15.0
"""Largest change of a temperature in an increment where phases have strain [K]: a sixth of the martensite."""

if TYPE_CHECKING:
    from presswork.case.plane import schema
    from presswork.case.space.schema import SpaceCase


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
        max_change=_find_max_change(case, heat),
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


def _find_max_change(case: schema.Case | SpaceCase, heat: FormingHeat) -> float:
    """Return the largest change of a temperature in an increment [K]: less where phases strain."""
    steels = [getattr(material, "transformation", None) for material in case.materials.values()]
    strained = any(steel is not None and steel.phases is not None for steel in steels)
    return WITH_PHASES if strained and "max_change" not in heat.model_fields_set else heat.max_change


def find_effusivity(material: schema.Material | UmatMaterial, temperature: float) -> float:
    """Return the effusivity at a temperature [N/(mm K s^0.5)]."""
    assert material.thermal is not None
    assert material.density is not None
    thermal = material.thermal.to_thermal(material.density)
    at_start = [np.interp(temperature, *table.T) for table in (thermal.conductivity, thermal.specific_heat)]
    return float(np.sqrt(thermal.density * np.prod(at_start)))


def start_hot(material: model.Material, heat: FormingHeat | None) -> model.Material:
    """Return a material whose law begins at the initial temperature of the case."""
    if heat is None or not (material.umat is not None or depends_on_temperature(material)):
        return material
    return replace(material, heating=replace(material.heating or model.Heating(), start=heat.initial_temperature))
