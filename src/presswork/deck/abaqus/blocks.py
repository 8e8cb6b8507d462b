# SPDX-License-Identifier: Apache-2.0
"""A deck of Abaqus as a row of blocks: a keyword with its parameters, and the rows of data below it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from presswork.case.errors import CaseError, Problem
from presswork.deck.keyword_file import read_keyword_lines
from presswork.deck.notes import Notes, Place
from presswork.model import FloatArray

_KEYWORD = re.compile(rb"^\*[^*\r\n][^\r\n]*(?:,\s*\r?\n[^*\r\n][^\r\n]*)*", re.MULTILINE)
"""A keyword line, and lines that go on with it after a comma at its end."""


class DataError(ValueError):
    """Data that are no numbers, or too few of them."""


@dataclass(frozen=True)
class Block:
    """A keyword, its parameters, and the data below it."""

    name: str
    """Upper case, with single blanks, without the asterisk."""
    parameters: dict[str, str]
    """By their names in upper case; those without a value have an empty one."""
    place: Place
    data: bytes

    def rows(self) -> list[list[str]]:
        """Return the fields of each row of data."""
        lines = (line.strip() for line in self.data.decode("latin-1").splitlines())
        return [[word.strip() for word in line.split(",")] for line in lines if line and not line.startswith("**")]

    def table(self, width: int) -> FloatArray:
        """Return rows of `width` numbers, missing ones 0 (n, width). Raises DataError."""
        rows = [row for row in self.data.replace(b"\r", b"").split(b"\n") if row.strip() and not row.startswith(b"**")]
        fields = [(row.strip().rstrip(b",").split(b",") + [b"0"] * width)[:width] for row in rows]
        try:
            table = np.array(fields, dtype=object).astype(np.float64).reshape(len(rows), width)
        except ValueError as error:
            raise DataError(str(error)) from None
        if not np.isfinite(table).all():
            raise DataError("a number that is not finite")
        return table

    def labels(self) -> list[str]:
        """Return all fields of all rows, one after the other."""
        return [word for row in self.rows() for word in row if word]

    def name_of(self, parameter: str) -> str:
        """Return a parameter that names something, in upper case; empty without it."""
        return self.parameters.get(parameter, "").upper()


def read_blocks(path: Path, source: Path, notes: Notes, depth: int = 0) -> Iterator[Block]:
    """Yield the blocks of a deck and of the files that it includes. Raises CaseError for files that cannot be read."""
    for line in read_keyword_lines(path, _KEYWORD, "Abaqus", depth):
        words = [word.strip() for word in line.text.split(",")]
        pairs = [word.partition("=") for word in words[1:] if word]
        parameters = {key.strip().upper(): value.strip().strip('"') for key, _, value in pairs}
        block = Block(" ".join(words[0].upper().split()), parameters, line.place, line.data[line.after : line.end])
        if block.name == "INCLUDE":
            notes.see(block.place, "*INCLUDE", "lines of the file are listed by its name")
            yield from read_blocks(path.parent / parameters.get("INPUT", ""), source, notes, depth + 1)
        elif block.name == "PARAMETER":
            fault = "parameters are expressions, which are not evaluated"
            raise CaseError([Problem(f"{block.place} *PARAMETER", fault, "write their values into the deck")], source)
        else:
            yield block
