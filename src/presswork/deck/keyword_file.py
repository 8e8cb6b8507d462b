# SPDX-License-Identifier: Apache-2.0
"""A file of keywords that begin with an asterisk, taken apart: what decks of all programs have in common."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from presswork.case.errors import CaseError, Problem
from presswork.deck.notes import Place
from presswork.text_file import UnreadableError, read_bytes

_LARGEST = 4 << 30
"""Bytes of a deck."""
_DEEPEST = 20
"""Files within files: beyond it they include each other."""
_START = 1 << 16
"""Bytes at the begin of a file that tell whether it is text."""


@dataclass(frozen=True)
class KeywordLine:
    """A line of a keyword, and where its data stand."""

    text: str
    """Without the asterisk."""
    place: Place
    data: bytes
    """The whole file."""
    after: int
    """Where in the file the line of the keyword ends."""
    end: int
    """Where the next keyword begins, or the file ends."""


def read_keyword_lines(path: Path, pattern: re.Pattern[bytes], program: str, depth: int) -> Iterator[KeywordLine]:
    """Yield the keywords of a file that lies `depth` includes below the deck.

    Raises CaseError for a file that cannot be read, that holds no keyword, or that includes itself.
    """
    try:
        data = read_bytes(path, most=_LARGEST)
    except FileNotFoundError as error:
        raise CaseError([Problem("", "no such file", "check the path")], path) from error
    except UnreadableError as error:
        raise CaseError([Problem("", error.fault, error.remedy)], path) from error
    if b"\0" in data[:_START]:
        raise CaseError([Problem("", "a binary file", f"give the deck of {program} as text")], path)
    if depth > _DEEPEST:
        fault = "files that include each other, one within the other without end"
        raise CaseError([Problem("*INCLUDE", fault, "take one of the includes out")], path)
    found = list(pattern.finditer(data))
    if not found:
        remedy = "give a deck whose lines of keywords begin with an asterisk"
        raise CaseError([Problem("", f"no keyword of {program} in it", remedy)], path)
    line, counted = 1, 0
    for number, match in enumerate(found):
        line += data.count(b"\n", counted, match.start())
        counted = match.start()
        end = found[number + 1].start() if number + 1 < len(found) else len(data)
        yield KeywordLine(match.group().decode("latin-1")[1:], Place(path.name, line), data, match.end(), end)
