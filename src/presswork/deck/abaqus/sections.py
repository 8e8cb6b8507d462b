# SPDX-License-Identifier: Apache-2.0
"""Sections of shells of Abaqus: thickness, points through it, and where the nodes lie in it."""

from __future__ import annotations

from presswork.deck.abaqus.parameters import leave_columns
from presswork.deck.contents import SectionCard
from presswork.deck.notes import Notes
from presswork.mesh.files.abaqus_blocks import Block, DataError
from presswork.mesh.files.abaqus_places import to_float

_USUAL_POINTS = 5
_OFFSETS = {"": 0.0, "MIDDLE": 0.0, "SPOS": 0.5, "SNEG": -0.5}


def read_section(block: Block, notes: Notes) -> SectionCard:
    """Return the section of a *SHELL SECTION or *SHELL GENERAL SECTION of one layer. Raises DataError, IndexError."""
    rows = block.rows()
    first, others = rows[0], rows[1:]
    thickness = to_float(first[0])
    has_points = block.name == "SHELL SECTION"
    n_points = int(to_float(first[1])) if has_points and len(first) > 1 else 0
    leave_columns(block, 1 + has_points, "fields that are not read", notes)
    if others:
        notes.leave(block.place, f"*{block.name}", f"rows after the first: {'; '.join(', '.join(r) for r in others)}")
    word = block.name_of("OFFSET")
    offset = _OFFSETS[word] if word in _OFFSETS else to_float(word)
    if thickness <= 0.0:
        raise DataError(f"a thickness of {thickness:g}")
    keyword = f"*{block.name}"
    return SectionCard(thickness, n_points or _USUAL_POINTS, False, block.place, keyword, offset=offset)
