# SPDX-License-Identifier: Apache-2.0
"""Whether coefficients of heat transfer look like W/(m^2 K); plain numbers are N/(mm s K), a thousand times as much."""

from __future__ import annotations

from collections.abc import Iterator

from presswork.model import FloatArray, Model

MOST_OF_AIR = 0.5
"""Twice the most of a gas that is blown, 25 to 250 W/(m^2 K) (Incropera, table 1.1) [N/(mm s K)]."""
MOST_OF_WATER = 200.0
"""Twice the most of a liquid that boils, 2.5 to 100 kW/(m^2 K) (Incropera, table 1.1) [N/(mm s K)]."""
MOST_OF_CONTACTS = 500.0
"""Far above metals pressed on each other, 1 to 100 kW/(m^2 K) [N/(mm s K)]."""


def warn_of_heat_transfer(model: Model) -> Iterator[str]:
    """Yield the coefficients that are too large in the program's unit; as W/(m^2 K) they would fit."""
    heat = model.heat
    if heat is None:
        return
    if heat.surroundings is not None:
        yield from _compare("heat.surroundings.coefficient", heat.surroundings.coefficient, MOST_OF_AIR, "air")
    for index, stage in enumerate(model.stages):
        for row, convection in enumerate(stage.heat.convections if stage.heat else ()):
            key = f"stages.{index}.convection.{row}.coefficient"
            yield from _compare(key, _largest(convection.coefficient), MOST_OF_WATER, "water that boils")
    contacts = {f"tools.{name}.heat": tool.conductance for name, tool in heat.tools.items()}
    within = "" if heat.alone else ".heat"
    contacts |= {f"contacts.{contact.name}{within}": contact.conductance for contact in heat.contacts}
    for key, conductance in contacts.items():
        yield from _compare(f"{key}.conductance", _largest(conductance), MOST_OF_CONTACTS, "contact of metals")


def _compare(key: str, value: float, most: float, of_what: str) -> Iterator[str]:
    """Yield a warning where a coefficient is more than the most [N/(mm s K)]."""
    if value > most:
        yield (
            f"{key}: {value:g} N/(mm s K) is {value:g} kW/(m^2 K), more than {of_what} transfers; plain numbers are "
            f'N/(mm s K), so give the unit if W/(m^2 K) are meant: "{value:g} W/(m^2*K)"'
        )


def _largest(rows: FloatArray) -> float:
    """Return the largest coefficient of rows of an argument and a coefficient (n, 2)."""
    return float(rows[:, 1].max())
