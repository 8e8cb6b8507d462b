# SPDX-License-Identifier: Apache-2.0
"""What the head of a test machine's file reports about the specimen: its sizes, and its angle from the rolling
direction."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from presswork.material.measured_file import Line, read_number
from presswork.material.quantities import DIRECTIONS, FACTS, UNITS, find_unit, plain


@dataclass(frozen=True)
class Sizes:
    """Sizes of a specimen [mm, mm^2] and its angle from the rolling direction [degrees]; None: not known."""

    thickness: float | None = None
    width: float | None = None
    diameter: float | None = None
    gauge_length: float | None = None
    extensometer_length: float | None = None
    area: float | None = None
    angle: float | None = None

    def find_area(self) -> float | None:
        """Return the cross section before the test, if it is known."""
        if self.area is not None:
            return self.area
        if self.thickness is not None and self.width is not None:
            return self.thickness * self.width
        return None if self.diameter is None else 0.25 * math.pi * self.diameter**2


def read_facts(head: Sequence[Line], sizes: Sizes, decimal: str) -> Sizes:
    """Return the sizes and the angle in the lines of a head, added to those known before."""
    facts: dict[str, float] = {}
    for key, text, unit in _list_facts(head, decimal):
        name, bracket = key, re.search(r"[\[(]([^\])]*)[\])]\s*$", key)
        if bracket and find_unit(bracket[1]):
            name, unit = key[: bracket.start()], unit or bracket[1]
        known = find_unit(unit) if unit else None
        dimension, factor = UNITS[known] if known else ("", 1.0)
        fact = next((fact for fact, pattern in FACTS if re.search(pattern, plain(name))), None)
        if fact == "thickness" and dimension == "area":
            fact = "area"
        value = read_number(text, decimal)
        if fact == "angle":
            angle = read_angle(text if not unit else f"{text} {unit}", plain(name), decimal)
            if angle is not None:
                facts["angle"] = angle
        elif fact is not None and value is not None and value > 0.0 and dimension in ("", "length", "area"):
            facts.setdefault(fact, factor * value)
    return replace(sizes, **facts)


def _list_facts(head: Sequence[Line], decimal: str) -> Iterator[tuple[str, str, str]]:
    """Yield key, value and unit of the lines of a head: in cells, after a colon or =, or under each other."""
    for line in head:
        cells = [cell for cell in line.cells if cell]
        joined = re.match(r"^([^:=]+?)\s*[:=]\s*(.+)$", cells[0]) if cells else None
        if joined and len(cells) == 1:
            cells = [joined[1], *re.split(r"\s+", joined[2], maxsplit=1)]
        elif len(cells) > 1:
            cells = [cells[0].rstrip(" :="), *cells[1:]]
            parts = re.match(r"^([-+\d.,']*\d)\s*([^-+\d.,'\s].*)$", cells[1])
            if parts and len(cells) == 2 and read_number(parts[1], decimal) is not None:
                cells = [cells[0], parts[1], parts[2]]
        if len(cells) > 1:
            yield cells[0], cells[1], cells[2] if len(cells) > 2 else ""
    for above, below in itertools.pairwise(head):
        if len(above.cells) == len(below.cells) > 2:
            for name, text in zip(above.cells, below.cells, strict=True):
                if read_number(text, decimal) is not None:
                    yield name, text, ""


def read_angle(text: str, key: str, decimal: str) -> float | None:
    """Return the angle that a text states; a bare number counts only under a key that means an angle."""
    degrees = re.search(r"(-?\d+(?:[.,]\d+)?)\s*(\u00b0|deg|grad\b)", text, re.IGNORECASE)
    if degrees:
        return float(degrees[1].replace(",", "."))
    if plain(text) in DIRECTIONS:
        return DIRECTIONS[plain(text)]
    names_angle = re.search(r"angle|winkel|direction|richtung|orientation|lage", key)
    return read_number(text, decimal) if names_angle else None
