# SPDX-License-Identifier: Apache-2.0
"""Text files that test machines write: heads of any length, and blocks of numbers under names and units.

UTF-8, UTF-16 and Latin-1; cells apart by semicolons, tabs, commas or spaces; decimal points or commas, and groups of
thousands. A line is a row of a block if it has at least two numbers and no other text than the column's rows have.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from presswork.case.errors import CaseError, Problem
from presswork.text_file import UnreadableError, read_bytes

SEPARATORS = (";", "\t", ",", " ")
"""Separators in the order in which they are preferred where several read as many numbers."""
GROUPS = {".": "[,'\u00a0\u202f]", ",": "[.'\u00a0\u202f]"}
"""Characters that may stand between groups of thousands, by decimal mark."""
FEWEST = 3
"""Rows of a block, if the file has one so long; shorter ones are lines of a head that hold two numbers."""
ENCODINGS = {b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16"}


@dataclass(frozen=True)
class Line:
    """A line with content."""

    number: int
    cells: tuple[str, ...]
    comment: bool


@dataclass(frozen=True)
class Block:
    """Rows of numbers, and the lines above them from the end of the block before."""

    head: tuple[Line, ...]
    rows: tuple[Line, ...]


@dataclass(frozen=True)
class MeasuredFile:
    """A file in blocks, with the decimal mark of its numbers."""

    path: Path
    decimal: str
    blocks: tuple[Block, ...]
    lines: tuple[Line, ...]

    def number(self, text: str) -> float | None:
        """Return the number that a cell holds; None for what is none."""
        return read_number(text, self.decimal)


def read_measured_file(path: Path) -> MeasuredFile:
    """Read a file into its blocks. Raises CaseError for a file that cannot be read or has nothing in it."""
    text = _decode(path)
    numbered = [(i, line.strip("\ufeff \r")) for i, line in enumerate(text.split("\n"), 1)]
    numbered = [(i, line) for i, line in numbered if line.strip(" \t;,")]
    if not numbered:
        raise CaseError([Problem("", "an empty file", "give a head line and one line for each point")], path)
    lines, decimal = _cut(numbered)
    return MeasuredFile(path, decimal, tuple(_find_blocks(lines, decimal)), lines)


def read_number(text: str, decimal: str) -> float | None:
    """Return the number that a text is with this decimal mark; None for what is none."""
    text = text.strip().replace("\u2212", "-")
    mark, group = re.escape(decimal), GROUPS[decimal]
    ending = r"([eE][+-]?\d+)?"
    if re.fullmatch(rf"[+-]?(\d+({mark}\d*)?|{mark}\d+){ending}", text):
        return float(text.replace(decimal, "."))
    if re.fullmatch(rf"[+-]?[1-9]\d{{0,2}}({group}\d{{3}})+({mark}\d*)?{ending}", text):
        return float(re.sub(group, "", text).replace(decimal, "."))
    return None


def _decode(path: Path) -> str:
    try:
        data = read_bytes(path)
    except FileNotFoundError:
        raise CaseError([Problem("", "no such file", "check the path")], path) from None
    except UnreadableError as error:
        raise CaseError([Problem("", error.fault, "give the text file that the machine exports")], path) from None
    encoding = ENCODINGS.get(data[:2], "utf-8-sig")
    if b"\x00" in data and encoding == "utf-8-sig":
        text = "not a text file: it has bytes that are zero"
        raise CaseError([Problem("", text, "export the test as text or CSV")], path)
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError:
        text = data.decode("cp1252", errors="replace")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _cut(numbered: Sequence[tuple[int, str]]) -> tuple[tuple[Line, ...], str]:
    """Return the lines by the separator and decimal mark that read most rows of numbers.

    Plain numbers count more than those with groups of thousands, which an unlucky mark makes of any.
    """
    found: list[tuple[tuple[int, int], tuple[Line, ...], str]] = []
    for separator in SEPARATORS:
        lines = tuple(Line(i, _split(line.lstrip("# "), separator), line.startswith("#")) for i, line in numbered)
        for decimal in (".", ","):
            found.append((_rate(lines, decimal), lines, decimal))
    best = max(found, key=lambda one: one[0])
    if best[0][0] == 0:  # no row of numbers: the separator that cuts most lines shows what is wrong
        best = max(found, key=lambda one: sum(len(line.cells) > 1 for line in one[1]))
    return best[1], best[2]


def _rate(lines: Sequence[Line], decimal: str) -> tuple[int, int]:
    """Return how many numbers the rows have, less twice the cells cut wrongly, and how many of them are plain."""
    cells = [cell for line in lines if is_row(line, decimal) for cell in line.cells]
    numbers = [cell for cell in cells if read_number(cell, decimal) is not None]
    wrong = sum(re.search(r"\d\s*[;,\t]\s*[-+\d]", cell) is not None for cell in set(cells) - set(numbers))
    wrong += sum(re.match(r"[+-]?0\d", cell) is not None for cell in numbers)
    return len(numbers) - 2 * wrong, sum(not re.search(GROUPS[decimal], cell) for cell in numbers)


def _split(line: str, separator: str) -> tuple[str, ...]:
    if separator == " ":
        return tuple(re.split(r"[ \t]+", line.strip()))
    try:
        cells = next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])
    except csv.Error:
        cells = line.split(separator)
    return tuple(cell.strip() for cell in cells)


def is_row(line: Line, decimal: str) -> bool:
    """Return whether a line holds at least two numbers."""
    return not line.comment and sum(read_number(cell, decimal) is not None for cell in line.cells) >= 2


def _find_blocks(lines: Sequence[Line], decimal: str) -> list[Block]:
    """Return runs of rows with what stands above each; text between two rows of a block is a row with a fault."""
    runs: list[tuple[int, int]] = []
    start = None
    for i, line in enumerate(lines):
        if is_row(line, decimal):
            start = i if start is None else start
        elif start is not None and not (line.comment or _is_fault(lines, i, start, decimal)):
            runs.append((start, i))
            start = None
    if start is not None:
        runs.append((start, len(lines)))
    longest = max((end - first for first, end in runs), default=0)
    runs = [(first, end) for first, end in runs if end - first >= min(FEWEST, longest)]
    before = [0, *(end for _, end in runs)]
    return [
        Block(tuple(lines[above:first]), tuple(line for line in lines[first:end] if not line.comment))
        for above, (first, end) in zip(before, runs, strict=False)
    ]


def _is_fault(lines: Sequence[Line], i: int, start: int, decimal: str) -> bool:
    """Return whether a line inside a run is a row in which a cell is no number, or empty: as wide, and begun alike."""
    cells, first = lines[i].cells, lines[start].cells
    if len(cells) != len(first):
        return False
    numbers = [read_number(cell, decimal) is not None for cell in cells]
    return any(numbers) and (numbers[0] or not cells[0] or read_number(first[0], decimal) is None)
