# SPDX-License-Identifier: Apache-2.0
"""What became of the lines of a deck: kept, changed, or dropped."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from presswork.case.errors import CaseError, Problem
from presswork.keyword_file import Place

Fate = Literal["kept", "changed", "dropped"]
KEPT: Fate = "kept"
DROPPED: Fate = "dropped"
_RANK: tuple[Fate, ...] = ("dropped", "kept", "changed")
"""Order of notes on a line: the last one of these is what became of the line."""


@dataclass(frozen=True)
class Note:
    """What became of a keyword."""

    place: Place
    fate: Fate
    keyword: str
    text: str
    is_datum: bool = False
    """Whether it is about one datum of a keyword, whose other data have notes of their own."""

    def __str__(self) -> str:
        return f"{self.place}  {self.fate:8}{self.keyword}: {self.text}"


@dataclass
class Notes:
    """All notes on a deck, and the faults that prevent a case."""

    source: Path
    accepted: frozenset[str] = frozenset()
    """Keywords that carry physics and may be dropped nevertheless."""
    notes: list[Note] = field(default_factory=list)
    seen: dict[Place, Note] = field(default_factory=dict)
    """Note on a line that no other note is about."""
    belonging: dict[Place, tuple[str, Place]] = field(default_factory=dict)
    """Keywords whose fate is that of another line."""
    faults: list[Problem] = field(default_factory=list)

    def see(self, place: Place, keyword: str, text: str, fate: Fate = "kept") -> None:
        """Note what becomes of a line unless there is another note on it, so that no line is missing."""
        self.seen[place] = Note(place, fate, keyword, text)

    def belong(self, place: Place, keyword: str, to: Place) -> None:
        """Note that a line is kept, changed or dropped with another one."""
        self.belonging[place] = (keyword, to)

    def keep(self, place: Place, keyword: str, text: str) -> None:
        """Note what was taken over as it is."""
        self.notes.append(Note(place, "kept", keyword, text))

    def change(self, place: Place, keyword: str, text: str) -> None:
        """Note what was taken over in other words."""
        self.notes.append(Note(place, "changed", keyword, text))

    def drop(self, place: Place, keyword: str, text: str) -> None:
        """Note what was left out, and changes nothing that the engineer asks for."""
        self.notes.append(Note(place, "dropped", keyword, text))

    def leave(self, place: Place, keyword: str, datum: str, why: str = "") -> None:
        """Note one datum that is left out of a keyword that is taken over."""
        self.notes.append(Note(place, "dropped", keyword, f"{datum} is left out{why and f': {why}'}", is_datum=True))

    def refuse(self, place: Place, keyword: str, text: str, remedy: str = "") -> None:
        """Note what carries physics and has no counterpart: a fault, unless it may be dropped."""
        if keyword in self.accepted:
            self.drop(place, keyword, f"{text}; left out as asked for")
        else:
            remedy = remedy or f"take it out of the deck, or leave it out by --drop '{keyword}'"
            self.faults.append(Problem(f"{place} {keyword}", text, remedy))

    def fail(self, place: Place | None, text: str, remedy: str) -> CaseError:
        """Return the error of a deck that cannot be read on."""
        return CaseError([*self.faults, Problem(str(place or ""), text, remedy)], self.source)

    def check(self) -> None:
        """Raise CaseError if anything was refused."""
        if self.faults:
            raise CaseError(self.faults, self.source)

    def in_order(self) -> list[Note]:
        """Return what became of every line that was seen, by file and line."""
        noted = {note.place for note in self.notes if not note.is_datum}
        others = (note for place, note in self.seen.items() if place not in noted and place not in self.belonging)
        found = [*dict.fromkeys(self.notes), *others]
        fates: dict[Place, Fate] = {}
        for note in found:
            fates[note.place] = max(fates.get(note.place, note.fate), note.fate, key=_RANK.index)
        for place, (keyword, to) in self.belonging.items():
            if place not in noted:
                found.append(Note(place, fates.get(to, "kept"), keyword, f"with line {to.line} of {to.file}"))
        return sorted(found, key=lambda note: note.place)
