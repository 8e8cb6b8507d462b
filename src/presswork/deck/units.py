# SPDX-License-Identifier: Apache-2.0
"""Units of decks: named in them, or found from density and stiffness of the sheet, or given."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from presswork.deck.contents import MaterialCard

_YOUNG = (40e3, 250e3)
"""Young's modulus of sheet metals, from magnesium to steel [MPa]."""
_DENSITY = (1.5e-9, 9.5e-9)
"""Density of sheet metals, from magnesium to copper [t/mm^3]."""
_PREFIXES = {
    "": 1.0,
    "G": 1e9,
    "M": 1e6,
    "k": 1e3,
    "h": 1e2,
    "da": 1e1,
    "d": 1e-1,
    "c": 1e-2,
    "m": 1e-3,
    "mu": 1e-6,
    "u": 1e-6,
    "n": 1e-9,
    "p": 1e-12,
}


@dataclass(frozen=True)
class Units:
    """What numbers of a deck are multiplied by to be in mm, t and s."""

    name: str
    length: float
    mass: float
    time: float

    @property
    def force(self) -> float:
        """Return the factor to N."""
        return self.mass * self.length / self.time**2

    @property
    def stress(self) -> float:
        """Return the factor to MPa."""
        return self.mass / (self.length * self.time**2)

    @property
    def density(self) -> float:
        """Return the factor to t/mm^3."""
        return self.mass / self.length**3

    def is_as(self, other: Units) -> bool:
        """Return whether numbers mean the same in other units."""
        pairs = ((self.length, other.length), (self.mass, other.mass), (self.time, other.time))
        return all(abs(own - its) <= 1e-9 * own for own, its in pairs)


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


def name_units(mass: str, length: str, time: str) -> Units:
    """Return the units of three names (g, m or s with a prefix) or numbers (in kg, m, s). Raises ValueError."""
    grams, metres, seconds = 1e3 * _in_kg(mass), _to_base(length, "m"), _to_base(time, "s")
    found = Units(f"{mass or 'kg'}-{length or 'm'}-{time or 's'}", 1e3 * metres, 1e-6 * grams, seconds)
    return next((units for units in SYSTEMS.values() if units.is_as(found)), found)


def _in_kg(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return 1e-3 * _to_base(text, "g") if text else 1.0


def _to_base(text: str, base: str) -> float:
    """Return a name of a unit, or a number, in its base; 1 for nothing."""
    if not text:
        return 1.0
    prefix = text.removesuffix(base)
    return _PREFIXES[prefix] if prefix != text and prefix in _PREFIXES else float(text)


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
