# SPDX-License-Identifier: Apache-2.0
"""Fields of cards of LS-DYNA that are not read: listed as left out, or refused."""

from __future__ import annotations

from collections.abc import Sequence

from presswork.deck.dyna.blocks import Block
from presswork.deck.fields import FieldError, read_fields, to_number
from presswork.deck.notes import Notes

_MOST = 16
"""Fields of a row, more than any card has."""


def leave_fields(block: Block, row: bytes, layout: str, notes: Notes, why: str = "") -> None:
    """Note the fields of a row that are given and not read.

    layout: names of the fields; one that begins with a dash is left out, with ! refused, others are read. Fields beyond
    the layout are left out.
    """
    keyword, names, left = f"*{block.name}", layout.split(), []
    for place, text in enumerate(_given(block, row)):
        name = names[place] if place < len(names) else f"-field {place + 1}"
        if text and name.startswith("!"):
            notes.refuse(block.place, keyword, f"{name[1:].upper()} = {text} has no counterpart here")
        elif text and name.startswith("-"):
            left.append(f"{name[1:].upper()} = {text}")
    if left:
        notes.leave(block.place, keyword, ", ".join(left), why)


def leave_rows(block: Block, rows: Sequence[bytes], what: str, notes: Notes) -> None:
    """Note rows none of whose fields is read."""
    for row in rows:
        given = [text for text in _given(block, row) if text]
        if given:
            notes.leave(block.place, f"*{block.name}", f"{what}: {', '.join(given)}")


def _given(block: Block, row: bytes) -> list[str]:
    """Return the fields of a row as they stand; empty where they are 0."""
    found = []
    for text in read_fields(row, _MOST, 20 if block.is_long else 10):
        try:
            is_zero = to_number(text, block.parameters) == 0.0
        except FieldError:
            is_zero = False
        found.append("" if is_zero else text.strip())
    return found
