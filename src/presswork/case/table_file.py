# SPDX-License-Identifier: Apache-2.0
"""Tables of measured points in text files: lines with content, cut into cells."""

from __future__ import annotations

import csv
from pathlib import Path

from presswork.case.errors import CaseError, Problem
from presswork.text_file import UnreadableError, read_text


def read_table_lines(path: Path, *, least: int) -> list[tuple[int, list[str]]]:
    """Return the lines that are neither empty nor comments, by their number and cut into cells at commas or semicolons.

    Raises CaseError for a file that cannot be read, or that has fewer than `least` such lines, the head among them.
    """
    try:
        text = read_text(path)
    except FileNotFoundError:
        raise CaseError([Problem("", "no such file", "check the path")], path) from None
    except UnreadableError as error:
        raise CaseError([Problem("", error.fault, "give a CSV file in UTF-8")], path) from None
    numbered = [(i, line) for i, line in enumerate(text.splitlines(), 1) if line.strip() and line.lstrip()[0] != "#"]
    if len(numbered) < least:
        raise CaseError([Problem("", "an empty file", "give a head line and one line for each point")], path)
    separator = ";" if ";" in numbered[0][1] else ","
    try:
        return [(i, next(csv.reader([line], delimiter=separator))) for i, line in numbered]
    except csv.Error as error:  # a NUL, or a cell of a hundred thousand letters
        raise CaseError([Problem("", f"no table of text ({error})", "give a CSV file in UTF-8")], path) from None
