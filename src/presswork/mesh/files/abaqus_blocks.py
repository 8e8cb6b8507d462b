# SPDX-License-Identifier: Apache-2.0
"""A file of Abaqus or CalculiX as a row of blocks: a keyword with its parameters, and the rows of data below it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from presswork.keyword_file import LARGEST, KeywordFileError, Place, decode, read_keyword_lines
from presswork.model import FloatArray
from presswork.text_file import UnreadableError, read_bytes

_KEYWORD = re.compile(rb"^\*[^*\r\n](?:[^\r\n]*,[ \t]*\r?\n[ \t]*(?=[A-Za-z]))*[^\r\n]*", re.MULTILINE)
"""A keyword line, and lines of further parameters after a comma at its end."""


class DataError(ValueError):
    """Data that are no numbers, or too few of them."""


@dataclass(frozen=True)
class Block:
    """A keyword, its parameters, and the data below it."""

    name: str
    """Upper case, with single blanks, without the asterisk."""
    parameters: dict[str, str]
    """Parameters by their names in upper case; those without a value have an empty one."""
    place: Place
    data: bytes

    def rows(self) -> list[list[str]]:
        """Return the fields of each row of data."""
        lines = (line.strip() for line in decode(self.data).splitlines())
        return [[word.strip() for word in line.split(",")] for line in lines if line and not line.startswith("**")]

    def first_row(self) -> list[str]:
        """Return the fields of the first row of data without blanks at its end; none where there is no row."""
        for line in self.data.split(b"\n", 20)[:20]:
            text = decode(line).strip()
            if text and not text.startswith("**"):
                return [word.strip() for word in text.rstrip(", ").split(",")]
        return []

    def widest(self) -> int:
        """Return how many fields the longest row of data has, without blanks at its end."""
        rows = self.data.replace(b"\r", b"").split(b"\n")
        return max(
            (row.rstrip(b", \t").count(b",") + 1 for row in rows if row and not row.startswith(b"**")), default=0
        )

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


def read_blocks(path: Path, depth: int = 0) -> Iterator[Block]:
    """Yield the blocks of a file, those of a file that it includes after its *INCLUDE. Raises KeywordFileError."""
    for line in read_keyword_lines(path, _KEYWORD, "Abaqus", depth):
        words = [word.strip() for word in line.text.split(",")]
        pairs = [word.partition("=") for word in words[1:] if word]
        parameters = {key.strip().upper(): value.strip().strip('"') for key, _, value in pairs}
        name, data = " ".join(words[0].upper().split()), line.data[line.after : line.end]
        if "INPUT" in parameters and name != "INCLUDE":
            data = _read_rows(path, path.parent / parameters["INPUT"], f"{line.place} *{name}")
        block = Block(name, parameters, line.place, data)
        yield block
        if block.name == "INCLUDE":
            yield from read_blocks(path.parent / parameters.get("INPUT", ""), depth + 1)


def _read_rows(deck: Path, file: Path, key: str) -> bytes:
    """Return the rows of data that a keyword has in a file of their own. Raises KeywordFileError."""
    try:
        return read_bytes(file, most=LARGEST)
    except FileNotFoundError as error:
        raise KeywordFileError(deck, f"INPUT={file.name}: no such file", "check the path", key) from error
    except UnreadableError as error:
        raise KeywordFileError(deck, f"INPUT={file.name}: {error.fault}", error.remedy, key) from error


def read_labels(block: Block, sets: Mapping[str, list[int]]) -> tuple[list[int], list[str]]:
    """Return the labels of a set, and the names in it that are no sets. Raises DataError.

    The data are labels and names of other sets, or with GENERATE rows of first, last and step.
    """
    if "GENERATE" in block.parameters:
        table = block.table(3).astype(int)
        return [label for first, last, step in table for label in range(first, last + 1, max(1, step))], []
    labels: list[int] = []
    unknown: list[str] = []
    for word in block.labels():
        if word.lstrip("-").isdigit():
            labels.append(int(word))
        elif word.upper() in sets:
            labels += sets[word.upper()]
        else:
            unknown.append(word)
    return labels, unknown
