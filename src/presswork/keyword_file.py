# SPDX-License-Identifier: Apache-2.0
"""A file of keywords that begin with a sign, taken apart: what decks of all programs have in common."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from presswork.text_file import UnreadableError, read_bytes

LARGEST = 4 << 30
"""Bytes of a deck."""
_DEEPEST = 20
"""Files within files: beyond it they include each other."""
_START = 1 << 16
"""Number of bytes at the start of a file that show whether it is text."""
_PIECE = 8 << 20
"""Bytes of rows that are taken apart at once."""


class KeywordFileError(UnreadableError):
    """A file of keywords that cannot be read, perhaps one that another includes."""

    def __init__(self, path: Path, fault: str, remedy: str, key: str = "") -> None:
        self.path = path
        self.key = key
        super().__init__(fault, remedy)


@dataclass(frozen=True, order=True)
class Place:
    """A line of a file, counted from 1."""

    file: str
    line: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}"


@dataclass(frozen=True)
class KeywordLine:
    """A line of a keyword, and where its data stand."""

    text: str
    """Without its first sign."""
    place: Place
    data: bytes
    """The whole file."""
    after: int
    """Where in the file the line of the keyword ends."""
    end: int
    """Where the next keyword begins, or the file ends."""


def read_keyword_lines(
    path: Path, pattern: re.Pattern[bytes], program: str, depth: int, sign: str = "an asterisk"
) -> Iterator[KeywordLine]:
    """Yield the keywords of a file that lies `depth` includes below the deck; sign: what they begin with, in words.

    Raises KeywordFileError for a file that cannot be read, that holds no keyword, or that includes itself.
    """
    try:
        data = read_bytes(path, most=LARGEST)
    except FileNotFoundError as error:
        raise KeywordFileError(path, "no such file", "check the path") from error
    except UnreadableError as error:
        raise KeywordFileError(path, error.fault, error.remedy) from error
    if b"\0" in data[:_START]:
        raise KeywordFileError(path, "a binary file", f"give the deck of {program} as text")
    if depth > _DEEPEST:
        fault = "files that include each other, one within the other without end"
        raise KeywordFileError(path, fault, "take one of the includes out", "include")
    found = list(pattern.finditer(data))
    if not found:
        remedy = f"give a deck whose lines of keywords begin with {sign}"
        raise KeywordFileError(path, f"no keyword of {program} in it", remedy)
    line, counted = 1, 0
    for number, match in enumerate(found):
        line += data.count(b"\n", counted, match.start())
        counted = match.start()
        end = found[number + 1].start() if number + 1 < len(found) else len(data)
        yield KeywordLine(decode(match.group())[1:], Place(path.name, line), data, match.end(), end)


def decode(text: bytes) -> str:
    """Return text in UTF-8, or in Latin-1 where it is not that."""
    try:
        return text.decode("utf-8")
    except UnicodeDecodeError:
        return text.decode("latin-1")


def rows_in_pieces(data: bytes, begin: int, end: int, comments: tuple[bytes, ...]) -> Iterator[list[bytes]]:
    """Yield the rows of a part of a file without comments and blanks, some megabytes at once."""
    while begin < end:
        stop = end
        if end - begin > _PIECE:
            stop = data.rfind(b"\n", begin, begin + _PIECE) + 1 or end
        text = data[begin:stop].replace(b"\r", b"")
        yield [row for row in text.split(b"\n") if row and not row.startswith(comments) and not row.isspace()]
        begin = stop
