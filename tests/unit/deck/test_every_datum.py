# SPDX-License-Identifier: Apache-2.0
"""No datum of a deck is lost without a word: changed, it changes the case or the list, or the deck is refused."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from presswork import CaseError
from presswork.deck.abaqus.read import AbaqusDeck
from presswork.deck.dyna.read import DynaDeck
from presswork.deck.notes import Notes
from presswork.deck.rad.read import RadDeck
from presswork.deck.stamping import make_stamping
from presswork.deck.units import SYSTEMS
from tests.problems.plate_decks import write_abaqus, write_dyna, write_rad

_BULK = 2
"""Rows of nodes, shells and labels in a block that are tried: the others are alike."""


@dataclass(frozen=True)
class Program:
    """How a program's decks are read, and what its fields look like."""

    suffix: str
    reader: type[AbaqusDeck | DynaDeck | RadDeck]
    sign: str
    comments: tuple[str, ...]
    text: str


PROGRAMS = {
    "abaqus": Program(".inp", AbaqusDeck, "*", ("**",), write_abaqus()),
    "dyna": Program(".k", DynaDeck, "*", ("$",), write_dyna()),
    "rad": Program(".rad", RadDeck, "/", ("#", "$"), write_rad()),
}


def read(program: Program, folder: Path, lines: list[str]):
    """Return what an import makes of a deck: the case, its meshes, the list, and lines that are dropped as a whole."""
    path = folder / f"deck{program.suffix}"
    path.write_text("\n".join(lines) + "\n")
    notes = Notes(path)
    deck = program.reader(path, notes).read()
    notes.check()
    found = make_stamping(deck, SYSTEMS["mm-t-s"], notes)
    notes.check()
    listed = notes.in_order()
    meshes = {name: (each.points.tolist(), each.cells.tolist()) for name, each in found.meshes.items()}
    kept = {note.place.line for note in listed if note.fate != "dropped"}
    dropped = {note.place.line for note in listed if not note.is_datum} - kept
    return (found.case, meshes, [str(note) for note in listed]), dropped


BLANKS = ("7", "0.007")
"""What blank fields are tried with: a number, or a part of the time; a datum is lost if neither matters."""


def other(text: str) -> str:
    """Return another value of the same kind."""
    if re.fullmatch(r"[+-]?\d+", text):
        return str(int(text) + 1)
    try:
        return f"{float(text) * 1.25 + 0.125:g}"
    except ValueError:
        return f"{text}x"


Changes = Iterator[list[str]]
"""Rows with one datum changed, each in one or two ways."""


def change_commas(line: str) -> Changes:
    """Yield rows of Abaqus in which one field is another one, or one field more."""
    words = [word.strip() for word in line.rstrip(",").split(",")]
    for i, word in enumerate([*words, ""]):
        news = [other(word)] if word else BLANKS
        yield [", ".join([*words[:i], new, *words[i + 1 :]]) for new in news]


def change_fields(line: str, width: int, n: int) -> Changes:
    """Yield rows of fields of one width in which one of the first n is another one."""
    line = line.ljust(width * n)
    for begin in range(0, width * n, width):
        text = line[begin : begin + width].strip()
        news = [other(text)] if text else BLANKS
        yield [line[:begin] + new.rjust(width)[:width] + line[begin + width :] for new in news]


def change_words(line: str) -> Changes:
    """Yield rows in which one word is another one at the same end, or a number stands in a gap."""
    for word in re.finditer(r"\S+", line):
        new = other(word.group())
        yield [line[: max(0, word.end() - len(new))] + new + line[word.end() :]]
    for begin in range(0, 100, 10):
        if not line[begin : begin + 20].strip():
            yield [line.ljust(begin)[:begin] + new.rjust(10) + line[begin + 10 :] for new in BLANKS]


def list_changes(name: str, program: Program) -> Iterator[tuple[int, list[str]]]:
    """Yield the place of a line from 0, and what it is changed to: data, and parameters of keywords.

    Titles and the labels of shells say nothing, and are left.
    """
    keyword, data = "", 0
    for at, line in enumerate(program.text.splitlines()):
        if line.startswith(program.comments) or line.startswith("#"):
            continue
        if line.startswith(program.sign):
            keyword, data = line.upper(), 0
            if name == "abaqus":
                words = line.split(",")
                for i, word in enumerate(words[1:], 1):
                    yield at, [",".join([*words[:i], f"{word}x", *words[i + 1 :]])]
                yield at, [f"{line}, further=1"]
            continue
        data += 1
        is_title = name == "rad" and data == 1 and not keyword.startswith(("/NODE", "/SHELL", "/RUN"))
        if is_title or (data > _BULK and keyword.startswith(("*NODE", "*ELEMENT", "/NODE", "/SHELL"))):
            continue
        if keyword.startswith(("*PART", "*TITLE", "*HEADING")) and not re.match(r"[\d., ]+$", line):
            continue  # titles
        if name == "abaqus":
            changed = change_commas(line)
        elif name == "rad" or keyword.startswith("*NODE"):
            changed = change_words(line)
        else:
            width = 8 if keyword.startswith("*ELEMENT") else 20 if "CURVE" in keyword and data > 1 else 10
            changed = change_fields(line, width, {8: 6, 20: 2, 10: 8}[width])
        skipped = 1 if keyword.startswith(("*ELEMENT", "/SHELL")) else 0
        yield from ((at, each) for each in itertools.islice(changed, skipped, None))


def find_lost(name: str, folder: Path) -> tuple[int, list[str]]:
    """Return how many data were changed, and the changes that made no difference."""
    program = PROGRAMS[name]
    lines = program.text.splitlines()
    base, dropped = read(program, folder, lines)
    lost, count = [], 0
    for at, news in list_changes(name, program):
        news = [new for new in news if new.strip() != lines[at].strip()]
        count += bool(news)
        keyword = max((i for i in range(at + 1) if lines[i].startswith(program.sign)), default=0)
        if news and keyword + 1 not in dropped and not any(matters(program, folder, lines, at, n, base) for n in news):
            lost.append(f"{lines[keyword]} | {lines[at]} -> {news[0]}")
    return count, lost


def matters(program: Program, folder: Path, lines: list[str], at: int, new: str, base: tuple) -> bool:
    """Say whether another line changes what an import makes of a deck, or is refused."""
    try:
        return read(program, folder, [*lines[:at], new, *lines[at + 1 :]])[0] != base
    except CaseError:
        return True


@pytest.mark.parametrize("name", ["abaqus", "dyna"])
def test_no_datum_is_lost_without_a_word(tmp_path, name) -> None:
    count, lost = find_lost(name, tmp_path)
    assert count > 100
    assert not lost, "\n".join(lost)
