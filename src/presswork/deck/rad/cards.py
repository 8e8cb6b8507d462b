# SPDX-License-Identifier: Apache-2.0
"""Fields of rows of OpenRadioss that are not read: listed as left out, or refused."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from presswork.deck.fields import FieldError, to_number
from presswork.deck.notes import Notes
from presswork.deck.rad.blocks import Block

_WIDTH = 10


def leave_fields(block: Block, row: bytes, layout: str, notes: Notes) -> None:
    """Note the fields of a row that are given and not read.

    layout: names of the fields, with their width behind a colon where it is not 10; one that begins with a dash is left
    out, with ! refused, others are read. What stands behind the last one is left out.
    """
    begin, left = 0, []
    for each in [*layout.split(), "-rest:200"]:
        name, _, width = each.partition(":")
        text = row[begin : begin + int(width or _WIDTH)].decode("latin-1").strip()
        begin += int(width or _WIDTH)
        if _is_zero(text) or name[0] not in "-!":
            continue
        if name.startswith("!"):
            notes.refuse(block.place, block.keyword, f"{name[1:]} = {text} has no counterpart here")
        else:
            left.append(f"{name[1:]} = {text}")
    if left:
        notes.leave(block.place, block.keyword, ", ".join(left))


def leave_behind(block: Block, rows: Sequence[bytes], width: int, notes: Notes) -> None:
    """Note what stands in rows of a table behind its fields."""
    more = next((text for row in rows if (text := row[width:].strip())), b"")
    if more:
        notes.leave(block.place, block.keyword, f"what stands behind the fields: {more.decode('latin-1')}")


def leave_rows(block: Block, rows: Sequence[bytes], what: str, notes: Notes) -> None:
    """Note rows none of whose fields is read."""
    for row in rows:
        given = row.decode("latin-1").split()
        if not all(_is_zero(text) for text in given):
            notes.leave(block.place, block.keyword, f"{what}: {' '.join(given)}")


def refuse_second(block: Block, what: str, known: Mapping[int, object], notes: Notes) -> None:
    """Refuse a keyword whose number has been given to another one of its kind."""
    if block.number in known:
        remedy = "give each its own number, or take one out"
        notes.refuse(block.place, block.keyword, f"a second {what} {block.number}", remedy)


def _is_zero(text: str) -> bool:
    try:
        return not text or to_number(text, {}) == 0.0
    except FieldError:
        return False
