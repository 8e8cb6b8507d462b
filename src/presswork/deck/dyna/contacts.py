# SPDX-License-Identifier: Apache-2.0
"""Contacts of LS-DYNA between surfaces: parts, friction, and whether rigid shells touch with their thickness."""

from __future__ import annotations

import re
from dataclasses import dataclass

from presswork.deck.dyna.blocks import Block
from presswork.deck.dyna.cards import leave_fields, leave_rows
from presswork.deck.notes import Notes

_SLIDING = re.compile(
    r"CONTACT_(FORMING_|AUTOMATIC_)?(ONE_WAY_)?(SURFACE|NODES)_TO_SURFACE(_(ID|TITLE|MPP|SMOOTH|MORTAR))*"
)
_FOREVER = 1e19
_REMEDY = "take one of *CONTACT_FORMING"


@dataclass(frozen=True)
class SideCard:
    """A side of a contact: a part (kind 3) or a set of parts (2), and its thickness where the contact gives it."""

    number: int
    kind: int
    thickness: float
    scale: float


@dataclass(frozen=True)
class ContactCard:
    """A contact that slides."""

    block: Block
    sides: tuple[SideCard, SideCard]
    friction: tuple[float, float]
    """Static and dynamic."""
    is_thick: bool
    """Whether rigid shells touch with their thickness."""


def read_contact(block: Block, notes: Notes) -> ContactCard | None:
    """Return a contact; None where it is refused, which is noted. Raises FieldError, IndexError."""
    keyword, options = f"*{block.name}", block.name.split("_")
    if not _SLIDING.fullmatch(block.name):
        tied = {"TIED", "TIEBREAK", "SPOTWELD"} & set(options)
        what = "surfaces that are tied to each other" if tied else "a contact of another kind"
        notes.refuse(block.place, keyword, what, _REMEDY)
        return None
    rows = block.rows()[any(option in options for option in ("ID", "TITLE")) :]
    if "MPP" in options:  # how ranks search: a row, and a second one that begins with &
        rows = rows[2 if rows[1].lstrip().startswith(b"&") else 1 :]
    leave_fields(block, rows[0], "ssid msid sstyp mstyp !sboxid !mboxid -spr -mpr", notes)
    leave_fields(block, rows[1], "fs fd dc -vc -vdc -penchk bt dt", notes)
    is_thick = "AUTOMATIC" in options  # others take the mesh of a rigid tool for its face
    if len(rows) > 2:
        thickness = "sst mst sfst sfmt" if is_thick else "-sst -mst -sfst -sfmt"
        leave_fields(block, rows[2], f"-sfs -sfm {thickness} fsf -vsf", notes)
    leave_rows(block, rows[3:], "an optional card", notes)
    first, second = block.numbers(rows[0]), block.numbers(rows[1])
    third = block.numbers(rows[2]) if len(rows) > 2 else [0.0] * 8
    static, dynamic, decay, _, _, _, birth, death = second
    if birth > 0.0 or 0.0 < death < _FOREVER:
        text = f"a contact for a part of the time (BT = {birth:g}, DT = {death:g})"
        notes.refuse(block.place, keyword, text)
    scale = third[6] or 1.0
    if not 0.0 <= static * scale < 1.0:
        text = f"friction by FS = {static:g}, FSF = {scale:g}"
        notes.refuse(block.place, keyword, text, "give one coefficient FS below 1")
    if decay and dynamic == static:
        notes.leave(block.place, keyword, f"DC = {decay:g}", "FD is FS")
    elif dynamic and dynamic != static and not decay:
        notes.leave(block.place, keyword, f"FD = {dynamic:g}", "without DC friction stays FS")
        dynamic = 0.0
    elif decay or dynamic:
        text = f"one coefficient of friction: FS = {static:g}; FD = {dynamic:g} with DC = {decay:g} is left out"
        notes.change(block.place, keyword, text)
        dynamic = 0.0
    sides = (
        SideCard(int(first[0]), int(first[2]), third[2], third[4] or 1.0),
        SideCard(int(first[1]), int(first[3]), third[3], third[5] or 1.0),
    )
    return ContactCard(block, sides, (static * scale, dynamic * scale), is_thick)
