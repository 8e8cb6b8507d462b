# SPDX-License-Identifier: Apache-2.0
"""Groups of nodes (/GRNOD), shells (/GRSHEL, /GRSH3N) and surfaces (/SURF) of OpenRadioss, by their members."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from presswork.deck.contents import Shells
from presswork.deck.fields import FieldError
from presswork.deck.notes import Notes
from presswork.deck.rad.blocks import Block, read_labels, read_row
from presswork.model import IndexArray

_ROOMS = ("GRNOD", "GRSHEL", "GRSH3N", "SURF")
_KINDS = {
    "NODE": "nodes",
    "NODENS": "nodes",
    "GENE": "ranges",
    "PART": "parts",
    "SEG": "segments",
    "GRNOD": "GRNOD",
    "GRSHEL": "GRSHEL",
    "GRSH3N": "GRSH3N",
    "SURF": "SURF",
}


@dataclass(frozen=True)
class _Group:
    kind: str
    """Kind of its members: nodes, ranges of nodes, parts, segments, or groups of another kind."""
    members: list[int]
    """Their numbers; negative ones are taken away."""
    block: Block


@dataclass
class Groups:
    """All groups of a deck, by room and number."""

    _groups: dict[tuple[str, int], _Group] = field(default_factory=dict)
    _used: set[tuple[str, int]] = field(default_factory=set)

    def take(self, block: Block) -> bool:
        """Take a group whose members are known; return whether it was one. Raises FieldError."""
        room, *kinds = block.words
        if room not in _ROOMS or not kinds or kinds[0] not in _KINDS:
            return False
        kind = _KINDS[kinds[0]]
        if (room, block.number) in self._groups:
            raise FieldError(f"a second group {block.number} of {room}")
        rows = block.titled()[1]
        if kind == "segments":
            members = [int(value) for row in rows for value in read_row(row, *[10] * 5)[1:] if value]
        else:
            members = read_labels(rows)
        self._groups[room, block.number] = _Group("nodes" if kind == "segments" else kind, members, block)
        return True

    def nodes(self, room: str, number: int, shells: Shells) -> IndexArray:
        """Return the labels of the nodes of a group, in order (n,). Raises KeyError for one that is not known."""
        group = self._groups[room, number]
        self._used.add((room, number))
        if group.kind == "ranges":
            pairs = zip(group.members[::2], group.members[1::2], strict=False)
            return np.unique([n for first, last in pairs for n in range(first, last + 1)]).astype(np.intp)
        if group.kind == "nodes":
            members = np.array(group.members, dtype=np.intp)
            return np.setdiff1d(members[members > 0], -members[members < 0])
        found = np.empty(0, dtype=np.intp)
        for member in group.members:
            if group.kind == "parts":
                own = np.unique(shells.nodes[shells.part == abs(member)])
            else:
                own = self.nodes(group.kind, abs(member), shells)
            found = np.union1d(found, own) if member > 0 else np.setdiff1d(found, own)
        return found

    def note_unused(self, nodes: IndexArray, parts: IndexArray, notes: Notes) -> None:
        """Note groups that nothing names, and members that are not there; nodes, parts: numbers of all that are."""
        for key, group in self._groups.items():
            block = group.block
            if key not in self._used:
                notes.see(block.place, block.keyword, "a group that nothing names", "dropped")
            known = nodes if group.kind == "nodes" else parts
            if group.kind in ("nodes", "parts"):
                missing = [each for each in group.members if not np.isin(abs(each), known)]
                if missing:
                    text = f"members that are not there: {', '.join(map(str, missing[:5]))}"
                    notes.leave(block.place, block.keyword, text)

    def parts(self, room: str, number: int, shells: Shells) -> tuple[int, ...]:
        """Return the parts with a shell all of whose nodes are in a group. Raises KeyError."""
        own = np.asarray(np.isin(shells.nodes, self.nodes(room, number, shells)).all(axis=1))
        return tuple(np.unique(shells.part[own]).tolist())
