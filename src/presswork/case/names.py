# SPDX-License-Identifier: Apache-2.0
"""Names that the user chooses, of tools, stages and bodies: they become names of files, columns and fields."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, Field

from presswork.case.units import fault

FORMAT = 1
"""Format of case files that this program reads; it counts changes that make an earlier file mean something else."""
LONGEST = 80
LONGEST_TITLE = 500
LONGEST_PART = 255
"""Bytes of a name of a file or folder, as file systems have it."""
_RESERVED = '/\\:*?"<>|,;='
"""What some file system takes for more than a letter, and what parts the columns of a table."""


def _check_name(name: str) -> str:
    """Refuse a name that could not be that of a file."""
    remedy = 'take letters, digits, blanks, "_" and "-", for instance punch_2'
    if not name.strip(" ."):
        raise fault("the name is blank" if name else "the name is empty", remedy)
    if name != name.strip() or name.startswith("."):
        raise fault("the name begins with a dot, or begins or ends with a blank", remedy)
    if len(name) > LONGEST:
        raise fault(f"the name has {len(name)} letters, more than {LONGEST}", "shorten it")
    wrong = sorted({letter for letter in name if letter in _RESERVED or not letter.isprintable()})
    if wrong:
        letters = " ".join(letter if letter.isprintable() else f"U+{ord(letter):04X}" for letter in wrong)
        raise fault(f"the name has {letters} in it, which no name of a file may have", remedy)
    return name


def _check_file_name(name: str) -> str:
    """Refuse a path that no file can have."""
    if "\0" in name or any(len(part.encode(errors="replace")) > LONGEST_PART for part in name.split("/")):
        raise fault("no file can have this name", "check it; it is relative to the case file")
    return name


def _check_title(title: str) -> str:
    """Refuse a title that is no line of text."""
    if len(title) > LONGEST_TITLE:
        raise fault(f"the title has {len(title)} letters, more than {LONGEST_TITLE}", "shorten it")
    wrong = sorted({letter for letter in title if not letter.isprintable()})
    if wrong:
        letters = " ".join(f"U+{ord(letter):04X}" for letter in wrong)
        raise fault(f"the title has {letters} in it", "write one line of text")
    return title


def _check_format(number: int) -> int:
    """Refuse a case file of a later program."""
    if number > FORMAT:
        text = f"the file is written for a later presswork; this one reads format {FORMAT}"
        raise fault(text, "install the presswork that it was written for")
    return number


Name = Annotated[str, AfterValidator(_check_name)]
"""Name of a tool, stage, body, contact, material, support or trim line."""
Title = Annotated[str, AfterValidator(_check_title)]
Format = Annotated[int, Field(ge=1, strict=True), AfterValidator(_check_format)]
FileName = Annotated[str, AfterValidator(_check_file_name)]
"""Path of a file that a case names, relative to it."""
