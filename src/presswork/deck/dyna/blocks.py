# SPDX-License-Identifier: Apache-2.0
"""A deck of LS-DYNA as a row of blocks: a keyword and the rows below it, included files in their place."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from presswork.case.errors import CaseError, Problem
from presswork.deck.fields import Parameters, read_fields, to_number
from presswork.deck.keyword_file import explain_unreadable
from presswork.deck.notes import Notes
from presswork.keyword_file import KeywordLine, Place, read_keyword_lines, rows_in_pieces

_KEYWORD = re.compile(rb"^\*[^\r\n]*", re.MULTILINE)


@dataclass(frozen=True)
class Block:
    """A keyword and its rows."""

    name: str
    """Upper case, without asterisk and sign."""
    place: Place
    data: bytes
    """The whole file."""
    begin: int
    end: int
    is_long: bool
    """Whether fields are twenty characters wide."""
    has_wide_labels: bool
    """Whether labels of nodes and elements are ten characters wide."""
    parameters: Parameters

    def rows(self) -> list[bytes]:
        """Return the rows without comments; blank ones count, for they are rows of defaults."""
        text = self.data[self.begin : self.end].rstrip()
        return [row for row in text.replace(b"\r", b"").split(b"\n") if not row.startswith(b"$")] if text else []

    def pieces(self) -> Iterator[list[bytes]]:
        """Yield rows without comments and blanks, some megabytes at once."""
        yield from rows_in_pieces(self.data, self.begin, self.end, (b"$",))

    def numbers(self, row: bytes, n: int = 8) -> list[float]:
        """Return the first n fields of a row of numbers; empty ones are 0."""
        return [to_number(text, self.parameters) for text in read_fields(row, n, 20 if self.is_long else 10)]


class BlocksOfDeck:
    """Reads a deck and what it includes."""

    def __init__(self, path: Path, notes: Notes) -> None:
        self._source = path
        self._notes = notes
        self._parameters: Parameters = {}
        self._is_long = self._has_wide_labels = False

    def read(self) -> Iterator[Block]:
        """Yield the blocks up to *END. Raises CaseError for files that cannot be read."""
        with explain_unreadable():
            yield from self._read(self._source, 0)

    def _read(self, path: Path, depth: int) -> Iterator[Block]:
        is_over = False
        for line in read_keyword_lines(path, _KEYWORD, "LS-DYNA", depth):
            block = self._make(line)
            keyword = f"*{block.name}"
            if is_over:
                self._notes.see(block.place, keyword, "comes after *END", "dropped")
            elif block.name == "END":
                is_over = True
                self._notes.see(block.place, keyword, "the file ends here")
            elif block.name.startswith("INCLUDE"):
                self._notes.see(block.place, keyword, "lines of the files are listed by their names")
                yield from self._include(block, path, depth)
            elif block.name.startswith("PARAMETER"):
                self._notes.see(block.place, keyword, "values take the place of their names")
                self._define(block)
            else:
                yield block

    def _make(self, line: KeywordLine) -> Block:
        text = line.text.strip().upper()
        name, _, rest = text.partition(" ")
        if name == "KEYWORD":
            self._is_long = "LONG=Y" in rest.replace(" ", "") or "LONG=K" in rest.replace(" ", "")
            self._has_wide_labels = "I10=Y" in rest.replace(" ", "")
        sign = (name[-1:] if name[-1:] in "+-%" else "") or (rest.strip() if rest.strip() in ("+", "-", "%") else "")
        is_long = sign == "+" or (self._is_long and sign != "-")
        wide = sign == "%" or (self._has_wide_labels and sign != "-")
        begin = line.data.find(b"\n", line.after) + 1 or len(line.data)
        return Block(name.rstrip("+-%"), line.place, line.data, begin, line.end, is_long, wide, self._parameters)

    def _include(self, block: Block, path: Path, depth: int) -> Iterator[Block]:
        if block.name != "INCLUDE":
            remedy = "include the file as it is, by *INCLUDE, or write its content into the deck"
            fault = "files are included as they are: paths, offsets and turns of included files are not followed"
            raise CaseError([Problem(f"{block.place} *{block.name}", fault, remedy)], self._source)
        text = ""
        for row in block.rows():
            part = row.decode("utf-8", "replace").strip()
            if part.endswith(" +"):
                text += part[:-2].rstrip()
                continue
            yield from self._read(path.parent / (text + part), depth + 1)
            text = ""

    def _define(self, block: Block) -> None:
        """Keep the values of parameters, which later rows name by &."""
        if "EXPRESSION" in block.name:
            fault = "expressions of parameters are not evaluated"
            problem = Problem(f"{block.place} *{block.name}", fault, "give them by *PARAMETER, as numbers")
            raise CaseError([problem], self._source)
        for row in block.rows():
            fields = read_fields(row, 8, 20 if block.is_long else 10)
            for name, value in zip(fields[::2], fields[1::2], strict=True):
                if len(name.strip()) > 1:
                    self._parameters[name.strip()[1:].strip().lower()] = value.strip()
