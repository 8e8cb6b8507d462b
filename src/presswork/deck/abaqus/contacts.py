# SPDX-License-Identifier: Apache-2.0
"""Contact of Abaqus: pairs and general contact, their properties, and friction in all its forms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from presswork.deck.abaqus.assembly import Assembly
from presswork.deck.abaqus.parameters import leave_columns
from presswork.deck.contents import Contact, Deck
from presswork.deck.notes import Notes
from presswork.mesh.files.abaqus_blocks import Block
from presswork.mesh.files.abaqus_places import to_float
from presswork.model import IndexArray

_KEYWORDS = (
    "SURFACE INTERACTION",
    "FRICTION",
    "SURFACE BEHAVIOR",
    "CONTACT PAIR",
    "CONTACT",
    "CONTACT INCLUSIONS",
    "CONTACT PROPERTY ASSIGNMENT",
)
_COEFFICIENT = "give a constant coefficient: *FRICTION without parameters, mu below 1"
_OWN = ((0.0, 1.0), (0.0, 1.0))
"""Rigid shells touch with the thickness of their section."""
Sides = tuple[tuple[int, ...], tuple[int, ...]]


@dataclass
class Contacts:
    """Gathers what surfaces do to each other."""

    notes: Notes
    _frictions: dict[str, float] = field(default_factory=dict)
    """Coefficients of interactions by name."""
    _now: str = ""
    """The interaction that *FRICTION and *SURFACE BEHAVIOR belong to."""
    _pairs: list[tuple[Block, list[str]]] = field(default_factory=list)
    _general: Block | None = None
    """Its *CONTACT, or the first of its keywords."""
    _included: list[tuple[Block, list[str]]] = field(default_factory=list)
    """Pairs of surfaces of general contact; an empty name is all there is."""
    _assigned: list[tuple[Block, list[str]]] = field(default_factory=list)
    """Two surfaces and an interaction."""

    def take(self, block: Block) -> bool:
        """Take a keyword of contact; return whether it was one. Raises DataError."""
        if block.name not in _KEYWORDS:
            return False
        match block.name:
            case "SURFACE INTERACTION":
                self._now = block.name_of("NAME")
                self._frictions.setdefault(self._now, 0.0)
                leave_columns(block, 0, "the thickness out of the plane", self.notes)
            case "FRICTION":
                self._take_friction(block)
            case "SURFACE BEHAVIOR":
                self.notes.drop(block.place, "*SURFACE BEHAVIOR", "contact is hard here")
            case "CONTACT PAIR":
                if "TIED" in block.parameters:
                    self.notes.refuse(block.place, "*CONTACT PAIR", "surfaces that are tied to each other (TIED)")
                self._pairs += [(block, row) for row in block.rows()]
                leave_columns(block, 2, "directions of slip", self.notes)
            case "CONTACT":
                self._general = block
                self.notes.see(block.place, "*CONTACT", "all surfaces touch, or those of its *CONTACT INCLUSIONS")
            case "CONTACT INCLUSIONS":
                self.notes.see(block.place, "*CONTACT INCLUSIONS", "what touches what")
                rows = [["", ""]] if "ALL EXTERIOR" in block.parameters else block.rows()
                leave_columns(block, 2, "further fields", self.notes)
                self._included += [(block, [*row, ""][:2]) for row in rows]
            case _:
                self._general = self._general or block
                self._assigned += [(block, [*row, "", "", ""][:3]) for row in block.rows()]
                leave_columns(block, 3, "further properties", self.notes)
        return True

    def _take_friction(self, block: Block) -> None:
        """Take the first coefficient; other forms are refused, or listed as changed."""
        place, notes, rows = block.place, self.notes, block.rows()
        for name, what in (
            ("ROUGH", "surfaces that never slip (ROUGH)"),
            ("USER", "friction by a subroutine (USER)"),
            ("ANISOTROPIC", "friction that depends on direction (ANISOTROPIC)"),
            ("TEST DATA", "friction by measured values (TEST DATA)"),
        ):
            if name in block.parameters:
                notes.refuse(place, "*FRICTION", what, _COEFFICIENT)
                return
        mu = to_float(rows[0][0]) if rows else 0.0
        self._frictions[self._now] = mu
        if not 0.0 <= mu < 1.0:
            notes.refuse(place, "*FRICTION", f"a coefficient of {mu:g}", _COEFFICIENT)
        if "EXPONENTIAL DECAY" in block.parameters:
            values = ", ".join(rows[0][1:3]) if rows else ""
            notes.change(place, "*FRICTION", f"mu = {mu:g} at any velocity; kinetic value and decay left out: {values}")
        elif len(rows) > 1 or any(word for word in (rows[0][1:] if rows else [])):
            others = "; ".join(", ".join(row) for row in [rows[0][1:], *rows[1:]])
            text = f"one coefficient of friction, mu = {mu:g}; left out, as it depends on slip or pressure: {others}"
            notes.change(place, "*FRICTION", text)
        if "TAUMAX" in block.parameters:
            text = f"friction without a largest stress; TAUMAX = {block.parameters['TAUMAX']} is left out"
            notes.change(place, "*FRICTION", text)
        if "DEPENDENCIES" in block.parameters:
            notes.refuse(place, "*FRICTION", "a coefficient that depends on fields (DEPENDENCIES)", _COEFFICIENT)

    # --- the whole ---------------------------------------------------------------------------------------------------

    def finish(self, deck: Deck, assembly: Assembly, cells: IndexArray, part: IndexArray, explicit: bool) -> None:
        """Add the contacts to the deck; cells: labels of shells (n,), part: number of each one's part (n,).

        explicit: whether steps are those of Abaqus/Explicit, where pairs touch with the thickness of rigid shells.

        Raises CaseError for surfaces and interactions that the deck does not have.
        """

        def parts_of(block: Block, name: str) -> tuple[int, ...]:
            if not name:
                return tuple(deck.parts)
            try:
                own = np.isin(cells, assembly.cells_of(name.upper()))
            except KeyError as error:
                text = f"*{block.name}: there is no {error.args[0]}"
                raise self.notes.fail(block.place, text, "check its name") from error
            return tuple(int(each) for each in np.unique(part[own]) if each)

        for block, row in self._pairs:
            sides = (parts_of(block, row[0]), parts_of(block, row[1] if len(row) > 1 else ""))
            friction = self._find(block, block.name_of("INTERACTION"))
            is_thick = (explicit or block.name_of("TYPE") == "SURFACE TO SURFACE") and (
                "NO THICKNESS" not in block.parameters
            )
            thickness = _OWN if is_thick else None
            deck.contacts.append(Contact(sides, (friction, 0.0), block.place, "*CONTACT PAIR", thickness))
        self._finish_general(deck, parts_of)

    def _finish_general(self, deck: Deck, parts_of: Callable[[Block, str], tuple[int, ...]]) -> None:
        """Add general contact: what is included, with the last property that is assigned to each pair of parts."""
        assigned = [(b, (parts_of(b, row[0]), parts_of(b, row[1] or row[0])), row[2]) for b, row in self._assigned]
        for block, _, name in assigned:
            self._find(block, name.upper())
        everything = [(self._general, ["", ""])] if self._general else []
        for block, row in self._included or everything:
            first, second = parts_of(block, row[0]), parts_of(block, row[1] or row[0])
            for one in first:
                for other in second:
                    if one == other or (not row[0] and one > other):
                        continue
                    mu, at = 0.0, block
                    for each, sides, name in assigned:
                        if _joins(sides, one, other):
                            mu, at = self._find(each, name.upper()), each
                    contact = Contact(((one,), (other,)), (mu, 0.0), at.place, f"*{at.name}", _OWN)
                    deck.contacts.append(contact)

    def _find(self, block: Block, interaction: str) -> float:
        if interaction not in self._frictions:
            text = f"*{block.name}: there is no interaction {interaction or 'named'}"
            raise self.notes.fail(block.place, text, "give *SURFACE INTERACTION, and name it")
        return self._frictions[interaction]


def _joins(sides: Sides, one: int, other: int) -> bool:
    return (one in sides[0] and other in sides[1]) or (other in sides[0] and one in sides[1])
