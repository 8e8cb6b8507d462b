# SPDX-License-Identifier: Apache-2.0
"""Which evolution laws a material has, and every quantity that there is."""

from __future__ import annotations

from typing import Final

from presswork.evolution import damage
from presswork.evolution.contract import EvolutionLaw, Quantity
from presswork.model import Damage, Material

QUANTITIES: tuple[Quantity, ...] = (*damage.QUANTITIES.values(),)
"""The quantities of all laws: each is a field."""
BY_NAME = {quantity.name: quantity for quantity in QUANTITIES}
DEFAULT_DAMAGE: Final = "cockcroft_latham"
"""Criterion that solids have without being asked."""


def make_laws(material: Material, *, is_solid: bool) -> tuple[EvolutionLaw, ...]:
    """Return the evolution laws of a material in solids or in a sheet."""
    laws: list[EvolutionLaw] = []
    flows = material.umat is None or material.umat.plastic_strain > 0
    chosen = material.damage
    if is_solid and flows and (chosen is None or chosen.criterion != DEFAULT_DAMAGE):
        laws.append(damage.DamageLaw(Damage(DEFAULT_DAMAGE)))
    if chosen is not None:
        laws.append(damage.DamageLaw(chosen))
    return tuple(laws)
