# SPDX-License-Identifier: Apache-2.0
"""Units of decks, which name none: found from density and stiffness of the sheet, or given."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from presswork.deck.contents import MaterialCard

_YOUNG = (40e3, 250e3)
"""Of sheet metals, from magnesium to steel [MPa]."""
_DENSITY = (1.5e-9, 9.5e-9)
"""From magnesium to copper [t/mm^3]."""


@dataclass(frozen=True)
class Units:
    """What numbers of a deck are multiplied by to be in mm, t and s."""

    name: str
    length: float
    mass: float
    time: float

    @property
    def force(self) -> float:
        """To N."""
        return self.mass * self.length / self.time**2

    @property
    def stress(self) -> float:
        """To MPa."""
        return self.mass / (self.length * self.time**2)

    @property
    def density(self) -> float:
        """To t/mm^3."""
        return self.mass / self.length**3


SYSTEMS = {
    units.name: units
    for units in (
        Units("mm-t-s", 1.0, 1.0, 1.0),
        Units("mm-kg-ms", 1.0, 1e-3, 1e-3),
        Units("mm-g-ms", 1.0, 1e-6, 1e-3),
        Units("m-kg-s", 1e3, 1e-3, 1.0),
        Units("cm-g-us", 10.0, 1e-6, 1e-6),
        Units("in-lbf-s", 25.4, 0.1751268, 1.0),
    )
}


def find_units(materials: Iterable[MaterialCard]) -> Units | None:
    """Return the units in which all materials are metals; None where there are none, or several."""
    cards = list(materials)
    found = [
        units
        for units in SYSTEMS.values()
        if all(
            _YOUNG[0] <= card.young * units.stress <= _YOUNG[1]
            and (not card.density or _DENSITY[0] <= card.density * units.density <= _DENSITY[1])
            for card in cards
        )
    ]
    return found[0] if len(found) == 1 and cards else None
