# SPDX-License-Identifier: Apache-2.0
"""A deck of OpenRadioss as a row of blocks: a line that begins with a slash, and the rows of fixed width below it.

Fields are 10 or 20 characters wide, as in decks of version 51 and later; a blank row is a row of defaults.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from presswork.case.errors import CaseError, Problem
from presswork.deck.fields import to_number
from presswork.deck.notes import Notes
from presswork.keyword_file import KeywordLine, Place, read_keyword_lines, rows_in_pieces

_KEYWORD = re.compile(rb"^(?:/|#include|#enddata)[^\r\n]*", re.MULTILINE | re.IGNORECASE)
_COMMENTS = (b"#", b"$")


@dataclass(frozen=True)
class Block:
    """A keyword and its rows."""

    words: tuple[str, ...]
    """Words of the keyword, in upper case, without the numbers at its end."""
    numbers: tuple[int, ...]
    """Numbers at the end of the keyword: for most, its own and that of its units."""
    place: Place
    data: bytes
    """The whole file."""
    begin: int
    end: int

    @property
    def keyword(self) -> str:
        """Return the keyword as notes name it."""
        return "/" + "/".join(self.words)

    @property
    def number(self) -> int:
        """Its own, 0 without one."""
        return self.numbers[0] if self.numbers else 0

    def rows(self) -> list[bytes]:
        """Return the rows without comments; blank ones count."""
        text = self.data[self.begin : self.end].rstrip()
        return [row for row in text.replace(b"\r", b"").split(b"\n") if not row.startswith(_COMMENTS)] if text else []

    def titled(self) -> tuple[str, list[bytes]]:
        """Return the title, which is the first row, and the others."""
        rows = self.rows()
        return (rows[0].decode("latin-1").strip(), rows[1:]) if rows else ("", [])

    def pieces(self) -> Iterator[list[bytes]]:
        """Yield rows without comments and blanks, some megabytes at once."""
        yield from rows_in_pieces(self.data, self.begin, self.end, _COMMENTS)


def read_row(row: bytes, *widths: int) -> list[float]:
    """Return the numbers in the first fields of a row; empty ones are 0. Raises FieldError."""
    ends = np.cumsum([0, *widths])
    text = row.decode("latin-1")
    return [to_number(text[a:b], {}) for a, b in itertools.pairwise(ends)]


def read_labels(rows: list[bytes]) -> list[int]:
    """Return all labels of rows of ten."""
    return [int(value) for row in rows for value in read_row(row, *[10] * 10) if value]


def read_blocks(path: Path, source: Path, notes: Notes, depth: int = 0) -> Iterator[Block]:
    """Yield the blocks of a file, and of those that it includes, up to /END. Raises CaseError."""
    is_over = False
    for line in read_keyword_lines(path, _KEYWORD, "OpenRadioss", depth, "a slash"):
        words = [word.strip() for word in line.text.strip().split("/")]
        sign = "#" if words[0].lower().startswith(("include", "enddata")) else "/"
        if is_over:
            notes.see(line.place, f"{sign}{words[0]}", "comes after the end", "dropped")
            continue
        if words[0].upper() in ("END", "ENDDATA"):
            is_over = True
            notes.see(line.place, f"{sign}{words[0]}", "the file ends here")
            continue
        if words[0].lower().startswith("include"):
            notes.see(line.place, "#include", "lines of the file are listed by its name")
            yield from _include(line, path, source, notes, depth)
            continue
        numbers: list[int] = []
        while len(words) > 1 and (not words[-1] or words[-1].lstrip("-").isdigit()):
            word = words.pop()
            numbers[:0] = [int(word)] if word else []
        begin = line.data.find(b"\n", line.after) + 1 or len(line.data)
        yield Block(tuple(word.upper() for word in words), tuple(numbers), line.place, line.data, begin, line.end)


def _include(line: KeywordLine, path: Path, source: Path, notes: Notes, depth: int) -> Iterator[Block]:
    rest = line.data[line.after : line.end].split(b"\n")
    if any(row.strip() and not row.startswith(_COMMENTS) for row in rest):
        fault = "rows that go on after an included file"
        problem = Problem(f"{line.place} #include", fault, "write a keyword above them, or the file into the deck")
        raise CaseError([problem], source)
    name = line.text.partition(" ")[2].strip().strip('"')
    yield from read_blocks(path.parent / name, source, notes, depth + 1)
