# SPDX-License-Identifier: Apache-2.0
"""The engine's files of OpenRadioss, NAME_0001.rad and those that go on from it: when the run ends."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from presswork.deck.contents import Deck
from presswork.deck.notes import Notes
from presswork.deck.rad.blocks import Block, read_blocks, read_row
from presswork.deck.rad.cards import leave_fields, leave_rows
from presswork.deck.rad.keywords import ENGINE


def read_engine(starter: Path, notes: Notes) -> Iterator[Block]:
    """Yield the keywords of the engine's files beside NAME_0000.rad, as many as there are. Raises CaseError."""
    stem = starter.stem
    if not stem.endswith("_0000"):
        return
    for run in range(1, 10000):
        path = starter.with_name(f"{stem[:-4]}{run:04d}{starter.suffix}")
        if not path.exists():
            return
        yield from read_blocks(path, starter, notes)


def take_engine_block(block: Block, deck: Deck, notes: Notes) -> None:
    """Take a keyword of the engine; notes what became of it. Raises FieldError, IndexError."""
    match block.words:
        case ("RUN", *_):
            rows = block.rows()
            time = read_row(rows[0], 20)[0]
            leave_fields(block, rows[0], "Tstop:20", notes)
            leave_rows(block, rows[1:], "further rows", notes)
            deck.end = max(deck.end or 0.0, time)
            deck.end_place = block.place
            notes.keep(block.place, "/RUN", f"the run ends at {time:g}")
        case ("IMPL", "SPRBACK", *_):
            deck.springs_back = True
            notes.change(block.place, block.keyword, "the part is released in the same run ([springback])")
        case (word, *_) if word in ENGINE:
            notes.drop(block.place, block.keyword, "controls numerics or output: the program's own take its place")
        case _:
            notes.refuse(block.place, block.keyword, "changes the model while it runs, which has no counterpart here")
