# SPDX-License-Identifier: Apache-2.0
"""Which evolution laws a material has, and every quantity that there is."""

from __future__ import annotations

from presswork.evolution import damage, grain
from presswork.evolution.contract import EvolutionLaw, Quantity
from presswork.model import Material

QUANTITIES: tuple[Quantity, ...] = (*damage.QUANTITIES.values(), *grain.QUANTITIES.values())
"""The quantities of all laws: each is a field."""
BY_NAME = {quantity.name: quantity for quantity in QUANTITIES}


def make_laws(material: Material, *, is_solid: bool) -> tuple[EvolutionLaw, ...]:
    """Return the evolution laws of a material in solids or in a sheet."""
    laws: tuple[EvolutionLaw, ...] = damage.make_damage(material.damage, material.umat, is_solid=is_solid)
    return laws if material.grain is None else (*laws, grain.GrainLaw(material.grain))
