# SPDX-License-Identifier: Apache-2.0
"""The evolution laws of a material, and every quantity that there is."""

from __future__ import annotations

from presswork.evolution import damage, forming_path, grain, phases
from presswork.evolution.contract import EvolutionLaw, Quantity
from presswork.model import Material

QUANTITIES: tuple[Quantity, ...] = (
    *damage.QUANTITIES.values(),
    *grain.QUANTITIES.values(),
    *forming_path.QUANTITIES.values(),
    *phases.QUANTITIES,
)
"""The quantities of all laws: each is a field."""
BY_NAME = {quantity.name: quantity for quantity in QUANTITIES}


def make_laws(material: Material, *, is_solid: bool) -> tuple[EvolutionLaw, ...]:
    """Return the evolution laws of a material in solids or in a sheet; a sheet's phases are where its temperatures are
    (interaction/heat/heat_of_sheet.py).
    """
    of_damage = damage.make_damage(material.damage, material.umat, is_solid=is_solid)
    return (*of_damage, *make_other_laws(material, is_solid=is_solid))


def make_other_laws(material: Material, *, is_solid: bool) -> tuple[EvolutionLaw, ...]:
    """Return those of the laws that are not damage."""
    laws: tuple[EvolutionLaw, ...] = () if is_solid else forming_path.make_forming_path(material)
    if material.grain is not None:
        laws = (*laws, grain.GrainLaw(material.grain))
    if is_solid and material.transformation is not None:
        laws = (*laws, phases.PhaseLaw(material.transformation))
    return laws
